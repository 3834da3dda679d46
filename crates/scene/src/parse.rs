//! From text to a scene, with overrides.

use crate::{Error, Scene};
use std::path::Path;

/// Parses `key.path=value; key.path=value` into pairs.
pub fn parse_overrides(text: &str) -> Result<Vec<(String, String)>, Error> {
    text.split(';').map(str::trim).filter(|part| !part.is_empty()).map(parse_override).collect()
}

fn parse_override(text: &str) -> Result<(String, String), Error> {
    let (key, value) = text.split_once('=').ok_or_else(|| Error::Override {
        text: text.to_string(),
        reason: "expected key.path=value, for example fluid.spacing=0.002".to_string(),
    })?;
    Ok((key.trim().to_string(), value.trim().to_string()))
}

/// The known key nearest to an unknown one, from an error text that lists the known ones in backquotes.
pub fn nearest_key(message: &str) -> Option<String> {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let unknown = quoted.next()?;
    let score = |known: &str| (strsim::jaro_winkler(unknown, known) * 1e6) as i64;
    quoted.max_by_key(|known| score(known)).map(str::to_string)
}

impl Scene {
    /// Reads and validates a scene file.
    pub fn from_file(path: &Path) -> Result<Self, Error> {
        let text = read(path)?;
        Self::with_overrides(&text, &name_of(path), &[])
    }

    /// Reads a scene file, applies overrides (key path, TOML value) and validates.
    pub fn from_file_with(path: &Path, overrides: &[(String, String)]) -> Result<Self, Error> {
        let text = read(path)?;
        Self::with_overrides(&text, &name_of(path), overrides)
    }

    /// Parses and validates the text of a scene called `name`.
    #[allow(clippy::should_implement_trait, reason = "takes a name for its messages")]
    pub fn from_str(text: &str, name: &str) -> Result<Self, Error> {
        Self::with_overrides(text, name, &[])
    }

    /// Parses the text, applies overrides (key path, TOML value), validates.
    pub fn with_overrides(text: &str, name: &str, overrides: &[(String, String)]) -> Result<Self, Error> {
        let mut scene: Scene = toml::from_str(text).map_err(|error| parse_error(name, text, &error))?;
        if !overrides.is_empty() {
            scene = apply(text, name, overrides)?;
        }
        scene.validate(name)?;
        Ok(scene)
    }
}

fn read(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path)
        .map_err(|error| Error::Read { path: path.display().to_string(), reason: error.to_string() })
}

fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

fn parse_error(name: &str, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map_or(0, |span| text[..span.start].matches('\n').count() + 1);
    let message = error.message().to_string();
    let hint = match nearest_key(&message) {
        Some(key) if message.contains("unknown") => format!("; did you mean `{key}`?"),
        _ => String::new(),
    };
    Error::Parse { name: name.to_string(), line, message, hint }
}

fn apply(text: &str, name: &str, overrides: &[(String, String)]) -> Result<Scene, Error> {
    let mut table: toml::Table = text.parse().map_err(|error| parse_error(name, text, &error))?;
    for (key, value) in overrides {
        set(&mut table, key, value)?;
    }
    let all = overrides.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join("; ");
    table.try_into().map_err(|error: toml::de::Error| {
        let message = error.message().to_string();
        let hint = nearest_key(&message)
            .filter(|_| message.contains("unknown"))
            .map_or_else(String::new, |key| format!("; did you mean `{key}`?"));
        Error::Override { text: all.clone(), reason: format!("{message}{hint}") }
    })
}

/// Sets one value; a word that is no TOML value counts as a string, numbers in the path index arrays.
fn set(table: &mut toml::Table, key: &str, value: &str) -> Result<(), Error> {
    let refuse = |reason: &str| Error::Override { text: format!("{key}={value}"), reason: reason.to_string() };
    let parsed = format!("value = {value}")
        .parse::<toml::Table>()
        .ok()
        .and_then(|mut wrapper| wrapper.remove("value"))
        .unwrap_or_else(|| toml::Value::String(value.to_string()));
    let parts: Vec<&str> = key.split('.').collect();
    let (last, path) = parts.split_last().ok_or_else(|| refuse("the key is empty"))?;
    if last.is_empty() {
        return Err(refuse("the key is empty"));
    }
    let mut place = table;
    let mut index = 0;
    while index < path.len() {
        let next = place.entry(path[index]).or_insert_with(|| toml::Value::Table(toml::Table::new()));
        index += 1;
        place = match next {
            toml::Value::Table(inner) => inner,
            toml::Value::Array(items) => {
                let count = items.len();
                let number = path.get(index).and_then(|text| text.parse::<usize>().ok());
                index += 1;
                match number.and_then(|number| items.get_mut(number)) {
                    Some(toml::Value::Table(inner)) => inner,
                    _ => return Err(refuse(&format!("expected an index from 0 to {}", count.max(1) - 1))),
                }
            }
            _ => return Err(refuse(&format!("`{}` is a value, not a table", path[index - 1]))),
        };
    }
    place.insert((*last).to_string(), parsed);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "title = 'tank'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = 0.01\n\
        water = [{ polygon = [[0,0],[1,0],[1,0.5],[0,0.5]] }]\n";

    #[test]
    fn unknown_key_names_line_and_nearest() {
        let text = SCENE.replace("spacing = 0.01", "spacing = 0.01\ndensty = 3.0");
        let message = Scene::from_str(&text, "tank.toml").unwrap_err().to_string();
        assert!(message.contains("line 7") && message.contains("`density`"), "{message}");
    }

    #[test]
    fn overrides_reach_nested_and_indexed_keys() {
        let overrides = parse_overrides("fluid.spacing=0.02; fluid.paper.alpha = 0.05; title=other").unwrap();
        let scene = Scene::with_overrides(SCENE, "tank.toml", &overrides).unwrap();
        let fluid = scene.fluid.unwrap();
        assert_eq!((fluid.spacing, fluid.paper.alpha, scene.title.as_str()), (0.02, 0.05, "other"));
        let bad = Scene::with_overrides(SCENE, "t", &[("fluid.spacin".into(), "1".into())]).unwrap_err();
        assert!(bad.to_string().contains("`spacing`"), "{bad}");
    }

    #[test]
    fn out_of_range_says_what_is_expected() {
        let error = Scene::with_overrides(SCENE, "t", &[("fluid.spacing".into(), "-1".into())]).unwrap_err();
        assert!(error.to_string().contains("fluid.spacing = -1"), "{error}");
    }
}
