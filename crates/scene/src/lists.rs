//! Lists of a fixed length: reading one takes as many entries as it needs, and says nothing of those left over.

use serde::Serialize;
use std::ops::Range;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Value};

/// A key or an index of a path into a document.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// A key of a table.
    Key(String),
    /// An index of a list.
    Index(usize),
}

/// A list with entries that nobody reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Surplus {
    /// Where it stands.
    pub path: Vec<Step>,
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
            Some(Surplus { path: path.clone(), got: given.len(), expected: read.len() })
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
pub fn shown(path: &[Step]) -> String {
    path.iter().fold(String::new(), |text, step| match step {
        Step::Key(key) if text.is_empty() => key.clone(),
        Step::Key(key) => format!("{text}.{key}"),
        Step::Index(index) => format!("{text}[{index}]"),
    })
}

/// Where in a text a value stands.
pub fn place(text: &str, path: &[Step]) -> Option<Range<usize>> {
    let document = DeTable::parse(text).ok()?;
    let Some((Step::Key(first), rest)) = path.split_first() else { return None };
    let (_, value) = document.get_ref().iter().find(|(key, _)| key.get_ref() == first)?;
    let found = rest.iter().try_fold(value, |value, step| match (value.get_ref(), step) {
        (DeValue::Table(table), Step::Key(name)) => {
            table.iter().find(|(key, _)| key.get_ref() == name).map(|(_, value)| value)
        }
        (DeValue::Array(items), Step::Index(index)) => items.get(*index),
        _ => None,
    })?;
    Some(found.span())
}

/// Path of the smallest value of a text that holds a place of it; empty where none does.
pub fn path_at(text: &str, place: &Range<usize>) -> Vec<Step> {
    let Ok(document) = DeTable::parse(text) else { return Vec::new() };
    let mut search = Search { place, smallest: usize::MAX, found: Vec::new(), path: Vec::new() };
    search.table(document.get_ref());
    search.found
}

/// A walk through a document. All of it: the place of a table is that of its header.
struct Search<'a> {
    place: &'a Range<usize>,
    smallest: usize,
    found: Vec<Step>,
    path: Vec<Step>,
}

impl Search<'_> {
    fn table(&mut self, table: &DeTable) {
        table.iter().for_each(|(key, value)| self.value(Step::Key(key.get_ref().to_string()), value));
    }

    fn value(&mut self, step: Step, value: &Spanned<DeValue>) {
        self.path.push(step);
        let span = value.span();
        let holds = span.start <= self.place.start && self.place.end <= span.end;
        if holds && span.len() < self.smallest {
            self.smallest = span.len();
            self.found.clone_from(&self.path);
        }
        match value.get_ref() {
            DeValue::Array(items) => {
                items.iter().enumerate().for_each(|(index, item)| self.value(Step::Index(index), item));
            }
            DeValue::Table(table) => self.table(table),
            _ => {}
        }
        self.path.pop();
    }
}
