//! The program compares the schemes and leaves a record, also when runs are ended early.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::process::{Command, Output};

fn bench(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["bench", "accuracy", "--out"]).arg(folder).args(arguments);
    command.output().unwrap()
}

fn rows(folder: &Path) -> Vec<csv::StringRecord> {
    csv::Reader::from_path(folder.join("accuracy.csv")).unwrap().records().map(Result::unwrap).collect()
}

#[test]
fn a_quick_try_leaves_tables_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let output = bench(folder.path(), &["--smoke"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows = rows(folder.path());
    // Three figures, two schemes, two spacings.
    assert_eq!(rows.len(), 12);
    for row in &rows {
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        // Error, wall-clock time, steps, particles, particle-steps. The spacing is 4 or 8 times the finest, so 190
        // communication steps of the scene become 48 or 24, of at least one step each.
        assert!(number(5) > 0.0 && number(8) > 0.0 && number(11) >= 24.0, "{row:?}");
        assert!(number(12) > 100.0 && number(13) >= number(12) * 24.0 * 0.9, "{row:?}");
        assert_eq!((&row[10], &row[19]), ("1", ""), "{row:?}");
    }
    // At equal spacing the scheme `voronoi` is at least twice as near to the exact semi-axis.
    let error = |index: usize| rows[index][5].parse::<f64>().unwrap();
    assert_eq!((&rows[2][3], &rows[2][4], &rows[3][3]), ("voronoi", "0.08", "mps"));
    assert!(error(2) < 0.5 * error(3), "{} {}", error(2), error(3));
    let page = std::fs::read_to_string(folder.path().join("accuracy.md")).unwrap();
    assert!(page.contains("## stretching_drop") && page.contains("| voronoi | all | |"));
    for name in ["spacing.png", "spacing.svg", "time.png", "time.svg"] {
        assert!(folder.path().join(format!("stretching_drop-{name}")).is_file(), "{name}");
    }
}

#[test]
fn runs_over_the_cap_are_rows_that_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["rotating_square", "--levels", "2", "--schemes", "voronoi", "--cap", "0.01"];
    let output = bench(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows = rows(folder.path());
    assert_eq!(rows.len(), 4);
    assert!(rows.iter().all(|row| row[5].is_empty() && row[19].contains("by the cap of 0.01 s")), "{rows:?}");
    assert!(std::fs::read_to_string(folder.path().join("accuracy.md")).unwrap().contains("by the cap of 0.01 s"));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str]| {
        let output = bench(folder.path(), arguments);
        assert!(!output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(refused(&["free_decay"]).contains("expected one of hydrostatic, "));
    assert!(refused(&["--schemes", "fast"]).contains("expected 'voronoi' or 'mps'"));
    assert!(refused(&["--levels", "1"]).contains("expected 2 to 4"));
    assert!(refused(&["--cap", "0"]).contains("expected a finite number above 0"));
}
