//! The paper's cabins run and leave a report, and the speed of a step a record.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::process::Command;

fn plimsoll(arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).to_string()
}

#[test]
fn four_cabins_become_one_page() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    plimsoll(&["reproduce", "cabin", "--spacing", "0.04", "--end", "0.005", "--out", out]);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 9, "seven histories and two profiles");
    assert!(page.contains("<td>IV</td><td>rigid</td><td>Complete</td>"), "the rigid bulkhead ran");
    // The paper's peak at P2 with a rigid bulkhead stands beside ours.
    assert!(page.contains("(56.15)"));
    for model in ["model-I", "model-II", "model-III", "model-IV"] {
        assert!(folder.path().join(model).join("results.csv").is_file(), "{model}");
    }
}

#[test]
fn a_quick_try_of_the_speed_can_be_compared_with_itself() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    plimsoll(&["bench", "speed", "--smoke", "--repeats", "1", "--out", out]);
    let table = folder.path().join("speed.csv");
    let again = folder.path().join("again");
    let arguments = ["bench", "speed", "--smoke", "--repeats", "1", "--against", table.to_str().unwrap(), "--out"];
    plimsoll(&[&arguments[..], &[again.to_str().unwrap()]].concat());
    let mut reader = csv::Reader::from_path(again.join("speed.csv")).unwrap();
    let row = reader.records().next().unwrap().unwrap();
    let number = |column: usize| row[column].parse::<f64>().unwrap();
    assert_eq!((number(2), number(3)), (990.0, 400.0), "particles and internal steps");
    assert!(number(11) > 0.0 && number(11) <= 10.0, "iterations per step: {}", number(11));
    assert!(number(13) > 0.0, "a ratio to the first record");
}
