//! Where in the text of a document a key stands.

use crate::identifier;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The line, from one, of a key path such as `fluid.wall[0].points[1]` or `fmu.0.name`; where the key has its default,
/// that of the table it belongs to. None where nothing of the path is in the text.
pub fn line_of(text: &str, key: &str) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let mut names = names(key).into_iter();
    let (first, value) = root.get_ref().get_key_value(names.next()?)?;
    let (mut start, mut value): (usize, &Spanned<DeValue>) = (first.span().start, value);
    for name in names {
        let next = match value.get_ref() {
            DeValue::Table(table) => table.get_key_value(name).map(|(key, value)| (key.span().start, value)),
            DeValue::Array(items) => {
                let own = |item: &Spanned<DeValue>| {
                    item.get_ref().get("name").and_then(|name| Some(name.get_ref().as_str()?.to_string()))
                };
                let item = entry(name, items.iter().map(own)).and_then(|index| items.get(index));
                item.map(|item| (item.span().start, item))
            }
            _ => None,
        };
        let Some(next) = next else { break };
        (start, value) = next;
    }
    Some(line_at(text, start))
}

/// The line, from one, of a byte.
pub fn line_at(text: &str, byte: usize) -> usize {
    text.bytes().take(byte).filter(|byte| *byte == b'\n').count() + 1
}

/// Index of the entry of a list that a key path means: by its index, or by its name.
pub fn entry(key: &str, names: impl ExactSizeIterator<Item = Option<String>>) -> Option<usize> {
    match key.parse::<usize>() {
        Ok(index) => Some(index).filter(|index| *index < names.len()),
        Err(_) => names.into_iter().position(|name| name.is_some_and(|name| name == key || identifier(&name) == key)),
    }
}

/// Whether two key paths name the same value, or one something within the other. An entry of a list may go by its index in
/// one and by its name in the other: any name may be that of an index.
pub fn same_branch(a: &str, b: &str) -> bool {
    let is_index = |name: &str| name.parse::<usize>().is_ok();
    names(a).into_iter().zip(names(b)).all(|(a, b)| a == b || is_index(a) != is_index(b))
}

/// The names and indices of the first key path in a text such as `length of body[0].member[1].damping`.
fn names(key: &str) -> Vec<&str> {
    let path = key.strip_prefix("length of ").unwrap_or(key);
    let path = path.split([',', ':', ' ']).next().unwrap_or_default();
    path.split(['.', '[', ']']).filter(|name| !name.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "title = 'tank'\n[run]\nend = 1.0\n[fluid]\nwall = [\n  { points = [[0, 0], [1, 0]] },\n\
        { points = [\n[0, 0],\n[1, 1]] }]\n[[check]]\nname = 'a'\n[[check]]\nname = 'b'\nlimit = -1\n";

    #[test]
    fn keys_are_found_with_the_line_of_what_is_nearest_to_them() {
        let cases = [
            ("run.end", Some(3)),
            ("fluid.wall[1].points[1]", Some(9)),
            ("fluid.wall[0].points", Some(6)),
            ("fluid.spacing", Some(4)),
            ("check[1].limit", Some(14)),
            ("check.0.name", Some(11)),
            ("length of fluid.wall", Some(5)),
            ("fluid.probe, fluid.region", Some(4)),
            ("check.b.limit", Some(14)),
            ("body", None),
        ];
        for (key, line) in cases {
            assert_eq!(line_of(TEXT, key), line, "{key}");
        }
        assert!(
            same_branch("fluid.wall[0].points", "fluid.wall.0") && !same_branch("run.end", "run.communication_step")
        );
        assert!(same_branch("check.b.limit", "check[1].limit") && !same_branch("check.b.limit", "check[1].name"));
    }
}
