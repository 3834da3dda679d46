//! From TOML text to typed data: overrides by dotted path, errors with the line and the nearest key.

use crate::lists::{self, Surplus};
use crate::place::{entry, line_at, line_of, same_branch};
use crate::{Error, words};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::ErrorKind;
use std::path::Path;
use toml::{Table, Value};

/// Reads a text file; the error names the path.
pub fn read_text(path: &Path) -> Result<String, Error> {
    let refuse = |reason: String| Error::Read { path: path.display().to_string(), reason };
    if path.extension().is_some_and(|extension| extension == "ssp" || extension == "fmu") {
        let what = "an archive and no scene or case: a case file names FMUs and connects them";
        return Err(refuse(format!("{what} (`plimsoll schema case` says how); packages are for other masters")));
    }
    let content = read_file(path)?;
    String::from_utf8(content)
        .map_err(|error| refuse(format!("it is no text in UTF-8 from byte {} on", error.utf8_error().valid_up_to())))
}

/// Reads a file. What is no file, and might give bytes without end or none for ever, is refused: a named pipe, a device.
pub fn read_file(path: &Path) -> Result<Vec<u8>, Error> {
    check_file(path)
        .and_then(|()| std::fs::read(path).map_err(|error| reason(&error)))
        .map_err(|reason| Error::Read { path: path.display().to_string(), reason })
}

/// Whether a path is that of a file, or of a link to one; the error says what else it is.
pub fn check_file(path: &Path) -> Result<(), String> {
    let kind = std::fs::metadata(path).map_err(|error| reason(&error))?.file_type();
    if kind.is_file() {
        return Ok(());
    }
    let found = if kind.is_dir() { "a directory" } else { special(kind) };
    Err(format!("is {found}, expected a file"))
}

fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_string(),
        _ => error.to_string(),
    }
}

#[cfg(unix)]
fn special(kind: std::fs::FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    match () {
        () if kind.is_fifo() => "a named pipe",
        () if kind.is_char_device() || kind.is_block_device() => "a device",
        () if kind.is_socket() => "a socket",
        () => "no file",
    }
}

#[cfg(not(unix))]
fn special(_kind: std::fs::FileType) -> &'static str {
    "no file"
}

/// The name of a file in messages.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Name of a scene file without folder and extension.
pub fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Parses the text of a document called `name`, with overrides (key path, TOML value). In a key path numbers or
/// names tell the entries of a list and missing tables are made; below `parameters` the rest of the path is one name, for names of variables
/// contain dots. A value that is no TOML counts as a string. Lists with entries that nothing reads are refused.
pub fn from_toml<T: DeserializeOwned + Serialize>(
    text: &str,
    name: &str,
    overrides: &[(String, String)],
) -> Result<T, Error> {
    // The text alone comes first: only its own errors have a line.
    let document: T = read(text).map_err(|(path, error)| parse_error(name, text, &path, &error))?;
    let table: Table = text.parse().map_err(|error| parse_error(name, text, "", &error))?;
    let mut root = Value::Table(table);
    if let Some(list) = lists::surplus(&root, &document) {
        let line = line_of(text, &list.path).unwrap_or(1);
        return Err(Error::Parse { name: name.to_string(), line, message: too_long(&list), hint: String::new() });
    }
    if overrides.is_empty() {
        return Ok(document);
    }
    for (key, value) in overrides {
        let slot = keys(key)
            .and_then(|keys| keys.into_iter().try_fold(&mut root, child))
            .map_err(|reason| Error::Override { text: shortened(format!("{key}={value}")), reason })?;
        *slot = parse_value(value);
    }
    let refuse = |path: &str, reason: String| {
        let guilty = overrides.iter().filter(|(key, _)| same_branch(key, path));
        let guilty: Vec<String> = guilty.map(|(key, value)| format!("{key}={value}")).collect();
        Error::Override { text: shortened(guilty.join("; ")), reason }
    };
    // As text again: what is read from a text takes lists as the file's own are taken.
    let text = toml::to_string(&root).map_err(|error| refuse("", error.to_string()))?;
    let document: T =
        read(&text).map_err(|(path, error)| refuse(&path, said(&path, &error) + &hint(error.message())))?;
    match lists::surplus(&root, &document) {
        Some(list) => Err(refuse(&list.path, too_long(&list))),
        None => Ok(document),
    }
}

/// Reads a text; the error comes with the key path that it is about.
fn read<T: DeserializeOwned>(text: &str) -> Result<T, (String, toml::de::Error)> {
    let parser = toml::Deserializer::parse(text).map_err(|error| (String::new(), error))?;
    serde_path_to_error::deserialize(parser).map_err(|error| (error.path().to_string(), error.into_inner()))
}

fn too_long(list: &Surplus) -> String {
    format!("{} has {} entries, expected {}", list.path, list.got, list.expected)
}

impl Error {
    /// The same error with the line of its key in the text of the document, unless one of the `overrides` set it.
    #[must_use]
    pub fn located(self, text: &str, overrides: &[(String, String)]) -> Self {
        match self {
            Self::Range { name, key, got, expected } => {
                let line = line_unless_set(text, &key, overrides);
                Self::Range {
                    name: line.map_or_else(|| name.clone(), |line| format!("{name}, line {line}")),
                    key,
                    got,
                    expected,
                }
            }
            other => other,
        }
    }
}

/// The line of a key path in the text of a document, from one, unless one of the `overrides` set it.
pub fn line_unless_set(text: &str, key: &str, overrides: &[(String, String)]) -> Option<usize> {
    let set = overrides.iter().any(|(changed, _)| same_branch(changed, key));
    if set { None } else { line_of(text, key) }
}

/// A key path before what is said about it; nothing for the document as a whole.
fn before(path: &str) -> String {
    if path.is_empty() || path == "." { String::new() } else { format!("{path}: ") }
}

/// The beginning of a text that is too long for a message.
fn shortened(text: String) -> String {
    match text.char_indices().nth(200) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text,
    }
}

fn parse_error(name: &str, text: &str, path: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map(|span| line_at(text, span.start)).or_else(|| line_of(text, path)).unwrap_or(1);
    Error::Parse { name: name.to_string(), line, hint: hint(error.message()), message: said(path, error) }
}

/// What the parser said, after the key path that it said it of.
fn said(path: &str, error: &toml::de::Error) -> String {
    let message = words::plain(error.message());
    let is_list = message.contains("expected a list");
    let remedy = match path.rsplit('.').next() {
        Some("on_body") => "; name the body: on_body = \"NAME\"",
        Some("body") if is_list => "; a body is written [[body]], for there may be several",
        Some("member") if is_list => "; a member is written [[body.member]], for there may be several",
        _ => "",
    };
    format!("{}{message}{remedy}", before(path))
}

const OF_ALL_BODIES: &str = "the integrator is that of all bodies and stands in [integrator]";

/// Keys and words that were others once, and what to write now; each where one of the known ones is what is now.
const RENAMED: &[(&str, &str, &str)] = &[
    ("accurate", "voronoi", "`accurate` is called `voronoi` now"),
    ("paper", "mps", "`paper` is called `mps` now"),
    ("beam", "member", "a beam is a [[body.member]] with a `name` now"),
    ("integrator", "constant_load", OF_ALL_BODIES),
    ("rho_infinity", "constant_load", OF_ALL_BODIES),
    ("beta", "constant_load", OF_ALL_BODIES),
    ("gamma", "constant_load", OF_ALL_BODIES),
];

/// What an unknown key is called now, or the known key nearest to it, from an error text that lists the known ones in
/// backquotes.
fn hint(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let Some(unknown) = quoted.next().filter(|_| message.contains("unknown")) else { return String::new() };
    let renamed = RENAMED.iter().find(|(old, new, _)| *old == unknown && quoted.clone().any(|known| known == *new));
    if let Some((_, _, now)) = renamed {
        return format!("; {now}");
    }
    let score = |known: &str| (strsim::jaro_winkler(unknown, known) * 1e6) as i64;
    let nearest = quoted.max_by_key(|known| score(known));
    nearest.map_or_else(String::new, |key| format!("; did you mean `{key}`?"))
}

fn parse_value(text: &str) -> Value {
    let wrapper = format!("value = {text}").parse::<Table>().ok();
    wrapper.and_then(|mut wrapper| wrapper.remove("value")).unwrap_or_else(|| Value::String(text.to_string()))
}

/// Keys of a path, one below the other: no document is as deep, and tables are made, read and dropped by recursion,
/// which would end the process on a path of some ten thousand.
const MOST_KEYS: usize = 32;

/// The keys of a dotted path.
fn keys(path: &str) -> Result<Vec<&str>, String> {
    let mut keys = Vec::new();
    let mut rest = Some(path);
    while let Some(path) = rest {
        if keys.len() == MOST_KEYS {
            return Err(format!("more than {MOST_KEYS} keys one below the other, expected key.path=value"));
        }
        let (head, tail) = path.split_once('.').map_or((path, None), |(head, tail)| (head, Some(tail)));
        // Names of variables contain dots: they are one key.
        let whole = keys.last() == Some(&"parameters");
        // As messages write it: `body[0]` is `body.0`.
        if let Some((list, index)) = head.strip_suffix(']').and_then(|head| head.split_once('[')).filter(|_| !whole) {
            keys.extend([list, index]);
            rest = tail;
            continue;
        }
        keys.push(if whole { path } else { head });
        rest = if whole { None } else { tail };
    }
    Ok(keys)
}

fn child<'a>(value: &'a mut Value, key: &str) -> Result<&'a mut Value, String> {
    match value {
        _ if key.is_empty() => Err("a key is empty, expected key.path=value".to_string()),
        Value::Table(table) => Ok(table.entry(key).or_insert_with(|| Value::Table(Table::new()))),
        Value::Array(items) => {
            let count = items.len();
            let own = |item: &Value| Some(item.get("name")?.as_str()?.to_string());
            let names: Vec<String> = items.iter().filter_map(own).collect();
            let item = entry(key, items.iter().map(own)).and_then(|index| items.get_mut(index));
            let or = if names.is_empty() { String::new() } else { format!(" or a name: {}", names.join(", ")) };
            item.ok_or_else(|| format!("`{key}`: expected an index below {count}{or}"))
        }
        _ => Err(format!("`{key}` lies below a value that is no table")),
    }
}
