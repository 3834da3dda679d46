//! Scene files and overrides that nobody would write: every one is either a scene or an error with a message.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use proptest::sample::Index;
use scene::{Error, Scene, parse_overrides};
use std::path::Path;
use std::sync::OnceLock;
use toml::Value;

/// The texts of all scenes of the repository.
fn scenes() -> &'static [String] {
    static SCENES: OnceLock<Vec<String>> = OnceLock::new();
    SCENES.get_or_init(|| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
        paths.sort();
        assert!(paths.len() > 20, "{paths:?}");
        paths.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect()
    })
}

/// Values that stand where a number should.
const VALUES: &[&str] = &[
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "-0.0",
    "1",
    "1e308",
    "-1e308",
    "1e309",
    "5e-324",
    "1e-9",
    "1e9",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775808",
    "18446744073709551616",
    "1_0",
    "0x7f",
    "1e",
    "1..2",
    "''",
    "'text'",
    "\"\\u0000\"",
    "\"\\ud800\"",
    "[]",
    "[[]]",
    "[[],[]]",
    "[0]",
    "[0,0]",
    "[0,0,0]",
    "[[0,0],[1,0],[1,1]]",
    "[[0,0],[1e300,0],[1,1e300]]",
    "[nan,0]",
    "{}",
    "{ x = 1 }",
    "[{}]",
    "true",
    "1979-05-27",
    "",
    "=",
    "#",
    "]",
    "}",
];

/// Pieces of text that mean something to a parser.
const PIECES: &[&str] = &[
    "\n",
    "\r\n",
    "\t",
    "\0",
    "\u{feff}",
    "=",
    ".",
    ",",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "\"",
    "'",
    "\"\"\"",
    "'''",
    "#",
    "\\",
    "[fluid]\n",
    "[[fluid]]\n",
    "[[body]]\n",
    "[[check]]\n",
    "[run]\n",
    "spacing = 0.1\n",
    "title = 1\n",
    "fluid.x = 1\n",
    "points = [[0.0, 0.0]]\n",
    "kind = \"nothing\"\n",
    "unknown = 1\n",
    "é",
    "\u{202e}",
    "💧",
];

/// One change of a text: what kind, where, where else, and how much.
type Change = (u8, Index, Index, u8);

fn changes(most: usize) -> impl Strategy<Value = Vec<Change>> {
    prop::collection::vec((0..10u8, any::<Index>(), any::<Index>(), any::<u8>()), 1..most)
}

fn apply(bytes: &mut Vec<u8>, (kind, place, other, amount): &Change) {
    if bytes.is_empty() {
        return;
    }
    let at = place.index(bytes.len());
    let end = (at + usize::from(*amount)).min(bytes.len());
    let piece = PIECES[other.index(PIECES.len())].as_bytes();
    match kind {
        0 => drop(bytes.drain(at..end)),
        1 => drop(bytes.splice(at..at, piece.iter().copied())),
        2 => drop(bytes.splice(at..(at + 1), piece.iter().copied())),
        3 => bytes.extend_from_within(at..end),
        4 => bytes[at] = *amount,
        5 => drop(bytes.splice(at..at, "[".repeat(40 * usize::from(*amount)).into_bytes())),
        6..=7 => swap_value(bytes, place, VALUES[other.index(VALUES.len())]),
        _ => change_lines(bytes, place, other, *amount),
    }
}

/// Puts another value behind one of the equals signs, up to the end of the line or a comma.
fn swap_value(bytes: &mut Vec<u8>, place: &Index, value: &str) {
    let signs: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at] == b'=').collect();
    if signs.is_empty() {
        return;
    }
    let from = signs[place.index(signs.len())] + 1;
    let length = bytes[from..].iter().position(|byte| b"\n,}".contains(byte)).unwrap_or(0);
    bytes.splice(from..from + length, value.bytes());
}

/// Deletes, doubles or exchanges lines: doubled keys and tables, keys in foreign tables.
fn change_lines(bytes: &mut Vec<u8>, place: &Index, other: &Index, amount: u8) {
    let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
    let (at, to) = (place.index(lines.len()), other.index(lines.len()));
    match amount % 3 {
        0 => drop(lines.remove(at)),
        1 => lines.insert(to, lines[at].clone()),
        _ => lines.swap(at, to),
    }
    *bytes = lines.concat();
}

/// What every text must do: fail with a message, or give a scene that is sound and comes back from its own text.
fn holds(result: Result<Scene, Error>) -> Result<bool, TestCaseError> {
    let scene = match result {
        Err(error) => {
            let message = error.to_string();
            prop_assert!(message.len() > 10 && message.contains(':'), "no message: {message}");
            return Ok(false);
        }
        Ok(scene) => scene,
    };
    prop_assert!(scene.validate("again").is_ok());
    let text = toml::to_string(&scene).map_err(|error| TestCaseError::fail(format!("cannot be written: {error}")))?;
    let back = Scene::from_str(&text, "back.toml").map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
    prop_assert_eq!(back, scene);
    Ok(true)
}

/// Key paths of everything in a scene that was read.
fn paths(value: &Value, path: &str, found: &mut Vec<String>) {
    let below = |part: &str| if path.is_empty() { part.to_string() } else { format!("{path}.{part}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| paths(value, &below(key), found)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| paths(item, &below(&i.to_string()), found))
        }
        _ => {}
    }
    found.push(path.to_string());
}

/// A part of a key path that may or may not be there.
const PARTS: &[&str] =
    &["fluid", "body", "member", "0", "1", "-1", "99999999999999999999", "", " ", "parameters", "é", "'a'"];

proptest! {
    #![proptest_config(fuzzing::config(6000))]

    #[test]
    fn changed_scenes(which in any::<Index>(), changes in changes(6)) {
        let mut bytes = scenes()[which.index(scenes().len())].clone().into_bytes();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        holds(Scene::from_str(&String::from_utf8_lossy(&bytes), "changed.toml"))?;
    }

    #[test]
    fn changed_values(which in any::<Index>(), places in prop::collection::vec((any::<Index>(), any::<Index>()), 1..4)) {
        let mut bytes = scenes()[which.index(scenes().len())].clone().into_bytes();
        places.iter().for_each(|(place, value)| swap_value(&mut bytes, place, VALUES[value.index(VALUES.len())]));
        holds(Scene::from_str(&String::from_utf8_lossy(&bytes), "changed.toml"))?;
    }

    #[test]
    fn overrides_of_keys_that_exist(
        which in any::<Index>(),
        places in prop::collection::vec((any::<Index>(), any::<Index>(), -1e3..1e3f64, any::<bool>()), 1..4),
    ) {
        let text = &scenes()[which.index(scenes().len())];
        let mut keys = Vec::new();
        paths(&Value::try_from(Scene::from_str(text, "s").unwrap()).unwrap(), "", &mut keys);
        let overrides: Vec<String> = places.iter().map(|(key, value, number, given)| {
            let key = &keys[key.index(keys.len())];
            if *given { format!("{key}={number}") } else { format!("{key}={}", VALUES[value.index(VALUES.len())]) }
        }).collect();
        match parse_overrides(&overrides.join(";")) {
            Err(error) => prop_assert!(!error.to_string().is_empty()),
            Ok(overrides) => drop(holds(Scene::with_overrides(text, "overridden.toml", &overrides))?),
        }
    }

    #[test]
    fn overrides_of_any_key(
        which in any::<Index>(),
        parts in prop::collection::vec(any::<Index>(), 1..8),
        value in prop_oneof![any::<Index>().prop_map(|value| VALUES[value.index(VALUES.len())].to_string()), ".{0,20}"],
    ) {
        let text = &scenes()[which.index(scenes().len())];
        let key: Vec<&str> = parts.iter().map(|part| PARTS[part.index(PARTS.len())]).collect();
        holds(Scene::with_overrides(text, "overridden.toml", &[(key.join("."), value)]))?;
    }

    #[test]
    fn any_text(text in ".{0,200}", bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        holds(Scene::from_str(&text, "any.toml"))?;
        holds(Scene::from_str(&String::from_utf8_lossy(&bytes), "any.toml"))?;
        if let Err(error) = parse_overrides(&text) {
            prop_assert!(error.to_string().contains("key.path=value"), "{error}");
        }
    }
}

/// The changes above leave enough scenes sound for the round trip to mean something, and break enough of them.
#[test]
fn both_ends_are_reached() {
    let mut runner = proptest::test_runner::TestRunner::new(fuzzing::config(600));
    let counts = [std::cell::Cell::new(0), std::cell::Cell::new(0)];
    let strategy = (any::<Index>(), changes(3));
    let outcome = runner.run(&strategy, |(which, changes)| {
        let mut bytes = scenes()[which.index(scenes().len())].clone().into_bytes();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        let count = &counts[usize::from(holds(Scene::from_str(&String::from_utf8_lossy(&bytes), "c.toml"))?)];
        count.set(count.get() + 1);
        Ok(())
    });
    assert!(outcome.is_ok(), "{outcome:?}");
    let [refused, accepted] = counts.map(|count| count.get());
    assert!(refused > 100 && accepted > 40, "{refused} refused, {accepted} accepted");
}

/// Nesting that recursion would follow to the end of the stack.
#[test]
fn depth_is_refused() {
    let base = &scenes()[0];
    for depth in [100, 10_000, 300_000] {
        let path = vec!["a"; depth].join(".");
        let message =
            Scene::with_overrides(base, "deep.toml", &[(path.clone(), "1".to_string())]).unwrap_err().to_string();
        assert!(message.contains("32 keys") && message.len() < 400, "{message}");
        for text in [
            format!("{path} = 1\n{base}"),
            format!("[{path}]\n"),
            format!("x = {}", "[".repeat(depth)),
            format!("x = {}{}", "[".repeat(depth), "]".repeat(depth)),
            format!("x = {}", "{x=".repeat(depth)),
        ] {
            assert!(!Scene::from_str(&text, "deep.toml").unwrap_err().to_string().is_empty());
        }
        let value = format!("{}{}", "[".repeat(depth), "]".repeat(depth));
        assert!(Scene::with_overrides(base, "deep.toml", &[("fluid.spacing".to_string(), value)]).is_err());
    }
}

/// Files that are no text, no file, or nothing.
#[test]
fn files_that_are_no_text() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in
        [("utf8", &b"title = '\xff\xfe'"[..]), ("empty", b""), ("nul", b"\0\0\0"), ("bom", b"\xef\xbb\xbf[")]
    {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let message = Scene::from_file(&path).unwrap_err().to_string();
        assert!(message.contains(name), "{message}");
    }
    assert!(Scene::from_file(folder.path()).unwrap_err().to_string().contains("cannot read"));
}
