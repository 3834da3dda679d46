//! When a run starts, when it ends, and at which times it has rows; run as a user runs it.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use std::path::Path;
use std::process::Command;

/// A plate that swings, as one FMU of a case.
const CASE: &str = "start = START\n[run]\nend = 0.5\ncommunication_step = 0.03\n[output]\nrecord_interval = INTERVAL\n\
    [[fmu]]\nname = 'plate'\npath = 'structure.fmu'\nparameters = { scene = 'free_decay' }\n";

/// Times of the rows of a run with these arguments.
fn times(folder: &Path, target: &str, arguments: &[&str]) -> Vec<f64> {
    let out = folder.join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).args([
        "run",
        target,
        "--quiet",
        "--overwrite",
        "--out",
    ]);
    let output = command.arg(&out).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut table = csv::Reader::from_path(out.join("results.csv")).unwrap();
    table.records().map(|row| row.unwrap()[0].parse().unwrap()).collect()
}

fn near(times: &[f64], expected: &[f64]) {
    assert!(times.len() == expected.len(), "{times:?}: expected {expected:?}");
    assert!(times.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{times:?}: expected {expected:?}");
    assert_eq!(times.last(), expected.last(), "the end to the bit");
}

#[test]
fn a_case_has_its_rows_wherever_it_starts_and_ends_at_its_end() {
    let folder = tempfile::tempdir().unwrap();
    plimsoll::pack::pack(folder.path()).unwrap();
    for (start, interval) in [(-0.5_f64, 0.09), (0.0, 0.09), (-0.5, 0.0)] {
        let path = folder.path().join("case.toml");
        let text = CASE.replace("START", &format!("{start:?}")).replace("INTERVAL", &interval.to_string());
        std::fs::write(&path, text).unwrap();
        let step = if interval > 0.0 { interval } else { 0.03 };
        // The duration is no multiple of step or interval: the last row is that of the end.
        let count = ((0.5 - start) / step).floor() as i32;
        let mut expected: Vec<f64> = (0..=count).map(|row| start + step * f64::from(row)).collect();
        expected.push(0.5);
        near(&times(folder.path(), path.to_str().unwrap(), &[]), &expected);
    }
}

#[test]
fn a_scene_ends_at_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let coarse = ["fluid.spacing=0.1", "fluid.threads=1", "output.interval=0", "run.end=0.1", "check=[]"];
    let settings = coarse.iter().chain(&["run.communication_step=0.03"]).flat_map(|change| ["--set", change]);
    let rows = times(folder.path(), "hydrostatic", &settings.collect::<Vec<_>>());
    near(&rows, &[0.0, 0.03, 0.06, 0.09, 0.1]);
    let coupled = ["fluid.spacing=0.05", "fluid.threads=1", "output.interval=0", "run.end=0.1", "check=[]"];
    let settings = coupled.iter().chain(&["run.communication_step=0.006"]).flat_map(|change| ["--set", change]);
    let rows = times(folder.path(), "floating_box", &settings.collect::<Vec<_>>());
    assert_eq!((rows.len(), rows.last()), (18, Some(&0.1)), "{rows:?}");
}
