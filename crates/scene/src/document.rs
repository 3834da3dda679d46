//! From TOML text to typed data: overrides by dotted path, errors with the line and the nearest key.

use crate::Error;
use serde::de::DeserializeOwned;
use std::path::Path;
use toml::{Table, Value};

/// Reads a text file; the error names the path.
pub fn read_text(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path)
        .map_err(|error| Error::Read { path: path.display().to_string(), reason: error.to_string() })
}

/// The name of a file in messages.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Parses the text of a document called `name`, with overrides (key path, TOML value). In a key path numbers index
/// arrays and missing tables are made; below `parameters` the rest of the path is one name, for names of variables
/// contain dots. A value that is no TOML counts as a string.
pub fn from_toml<T: DeserializeOwned>(text: &str, name: &str, overrides: &[(String, String)]) -> Result<T, Error> {
    // The text alone comes first: only its own errors have a line.
    let document = toml::from_str(text).map_err(|error| parse_error(name, text, &error))?;
    if overrides.is_empty() {
        return Ok(document);
    }
    let table: Table = text.parse().map_err(|error| parse_error(name, text, &error))?;
    let mut root = Value::Table(table);
    for (key, value) in overrides {
        let slot = keys(key)
            .into_iter()
            .try_fold(&mut root, child)
            .map_err(|reason| Error::Override { text: format!("{key}={value}"), reason })?;
        *slot = parse_value(value);
    }
    root.try_into().map_err(|error: toml::de::Error| {
        let all: Vec<String> = overrides.iter().map(|(key, value)| format!("{key}={value}")).collect();
        Error::Override { text: all.join("; "), reason: format!("{}{}", error.message(), hint(error.message())) }
    })
}

fn parse_error(name: &str, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map_or(0, |span| text[..span.start].matches('\n').count() + 1);
    let message = error.message().to_string();
    Error::Parse { name: name.to_string(), line, hint: hint(&message), message }
}

/// The known key nearest to an unknown one, from an error text that lists the known ones in backquotes.
fn hint(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let Some(unknown) = quoted.next().filter(|_| message.contains("unknown")) else { return String::new() };
    let score = |known: &str| (strsim::jaro_winkler(unknown, known) * 1e6) as i64;
    let nearest = quoted.max_by_key(|known| score(known));
    nearest.map_or_else(String::new, |key| format!("; did you mean `{key}`?"))
}

fn parse_value(text: &str) -> Value {
    let wrapper = format!("value = {text}").parse::<Table>().ok();
    wrapper.and_then(|mut wrapper| wrapper.remove("value")).unwrap_or_else(|| Value::String(text.to_string()))
}

/// The keys of a dotted path.
fn keys(path: &str) -> Vec<&str> {
    match path.split_once('.') {
        None => vec![path],
        Some(("parameters", name)) => vec!["parameters", name],
        Some((head, rest)) => std::iter::once(head).chain(keys(rest)).collect(),
    }
}

fn child<'a>(value: &'a mut Value, key: &str) -> Result<&'a mut Value, String> {
    match value {
        _ if key.is_empty() => Err("a key is empty, expected key.path=value".to_string()),
        Value::Table(table) => Ok(table.entry(key).or_insert_with(|| Value::Table(Table::new()))),
        Value::Array(items) => {
            let count = items.len();
            let item = key.parse::<usize>().ok().and_then(|index| items.get_mut(index));
            item.ok_or_else(|| format!("`{key}`: expected an index below {count}"))
        }
        _ => Err(format!("`{key}` lies below a value that is no table")),
    }
}
