//! Every fault of `tests/mutations/faults.toml` can still be planted.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

#[test]
fn every_fault_can_be_planted() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let text = std::fs::read_to_string(root.join("tests/mutations/faults.toml")).unwrap();
    let table: toml::Table = text.parse().unwrap();
    let faults = table["fault"].as_array().unwrap();
    assert!(faults.len() >= 30, "{} faults", faults.len());
    for fault in faults {
        let entry = |key: &str| fault[key].as_str().unwrap();
        let source = std::fs::read_to_string(root.join(entry("file"))).unwrap();
        let count = source.matches(entry("from")).count();
        assert_eq!(count, 1, "{}: `{}` stands there {count} times", entry("file"), entry("from"));
        assert_ne!(entry("from"), entry("to"));
    }
}
