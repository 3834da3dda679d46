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
    let set = ["--spacing", "0.04", "--end", "0.006", "--out", out];
    plimsoll(&[&["reproduce", "cabin"][..], &set].concat());
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 11, "seven histories, two profiles, load and energy");
    assert_eq!(
        page.matches("data:image/png;base64,").count(),
        3,
        "pressure, speed, and first and last frame in motion"
    );
    assert!(page.contains("<td>IV</td><td>rigid</td><td>Complete</td>"), "the rigid bulkhead ran");
    // The paper's peak at P2 with a rigid bulkhead stands beside ours.
    assert!(page.contains("(56.15)") && page.contains("Misprints of the paper"));
    // Kept, nothing runs again; with a bulkhead elsewhere the same folder serves as the other spacing.
    let results = folder.path().join("model-IV").join("results.csv");
    let written = std::fs::metadata(&results).unwrap().modified().unwrap();
    plimsoll(&[&["reproduce", "cabin", "--keep", "--against", out][..], &set].concat());
    assert_eq!(std::fs::metadata(&results).unwrap().modified().unwrap(), written);
    assert!(std::fs::read_to_string(folder.path().join("report.html")).unwrap().contains("Convergence"));
}

#[test]
fn every_variant_of_the_cabin_starts() {
    for variant in ["bottom", "two-openings", "bulkhead-forward", "fixed", "roll-only"] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().unwrap();
        plimsoll(&["reproduce", "cabin", "--variant", variant, "--spacing", "0.04", "--end", "0.004", "--out", out]);
        let text = std::fs::read_to_string(folder.path().join("model-IV").join("results.csv")).unwrap();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().unwrap().clone();
        let last = reader.records().last().unwrap().unwrap();
        // A cabin that neither moves nor bends takes no part: it has no columns.
        let last_of = |name: &str| header.iter().position(|it| it == name).map_or("0", |column| &last[column]);
        // A rigid bulkhead adds no coordinate, and a held cabin none at all.
        let expected = match variant {
            "fixed" => "0",
            "roll-only" => "1",
            _ => "3",
        };
        let counts = (last_of("structure.solver.unknowns [1]"), last_of("fluid.solver.responses [1]"));
        assert_eq!(counts, (expected, expected), "{variant}");
    }
}

#[test]
fn the_paper_becomes_one_page() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let set = ["--spacing", "0.04", "--plate", "0.02", "--end", "0.006", "--out", out];
    plimsoll(&[&["reproduce", "paper"][..], &set].concat());
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Dam break on an elastic plate") && page.contains("The damaged cabin"));
}

#[test]
fn the_study_has_error_bars() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let set = ["--spacing", "0.04", "--end", "0.004", "--repeats", "2", "--parts", "opening", "--out", out];
    plimsoll(&[&["reproduce", "stiffness"][..], &set].concat());
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Against height of the opening") && page.contains('\u{b1}'));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 9, "four points twice, and the page");
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
