//! Lists of a fixed length: reading one takes as many entries as it needs, and says nothing of those left over.

use serde::Serialize;
use toml::Value;

/// A key or an index of a path into a document.
enum Step {
    Key(String),
    Index(usize),
}

/// A list with entries that nobody reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Surplus {
    /// Where it stands.
    pub path: String,
    /// Entries in the text.
    pub got: usize,
    /// Entries that are read.
    pub expected: usize,
}

/// The first list of a document with more entries than what was read of it.
pub fn surplus(given: &Value, read: &impl Serialize) -> Option<Surplus> {
    // What is read can be written: it came from the same format.
    let read = Value::try_from(read).ok()?;
    longer(given, &read, &mut Vec::new())
}

fn longer(given: &Value, read: &Value, path: &mut Vec<Step>) -> Option<Surplus> {
    match (given, read) {
        (Value::Array(given), Value::Array(read)) if given.len() > read.len() => {
            Some(Surplus { path: shown(path), got: given.len(), expected: read.len() })
        }
        (Value::Array(given), Value::Array(read)) => {
            let mut pairs = given.iter().zip(read).enumerate();
            pairs.find_map(|(index, (given, read))| below(Step::Index(index), given, read, path))
        }
        (Value::Table(given), Value::Table(read)) => given
            .iter()
            .filter_map(|(key, given)| Some((key, given, read.get(key)?)))
            .find_map(|(key, given, read)| below(Step::Key(key.clone()), given, read, path)),
        _ => None,
    }
}

fn below(step: Step, given: &Value, read: &Value, path: &mut Vec<Step>) -> Option<Surplus> {
    path.push(step);
    let found = longer(given, read, path);
    path.pop();
    found
}

/// A path as messages write it: `fluid.water[0].polygon`.
fn shown(path: &[Step]) -> String {
    path.iter().fold(String::new(), |text, step| match step {
        Step::Key(key) if text.is_empty() => key.clone(),
        Step::Key(key) => format!("{text}.{key}"),
        Step::Index(index) => format!("{text}[{index}]"),
    })
}
