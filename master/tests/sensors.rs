//! Probes in results: rows are means and largest values over their interval, whatever the interval, and after a stop.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use std::path::Path;
use std::process::Command;

const SCENE: &str = "title = 'column'\n[run]\nend = 0.4\ncommunication_step = 0.002\n[output]\ninterval = 0.0\n\
    [fluid]\nspacing = 0.02\nthreads = 1\nwater = [{ polygon = [[0,0],[0.1,0],[0.1,0.2],[0,0.2]] }]\n\
    wall = [{ points = [[0,0.5],[0,0],[0.3,0],[0.3,0.5]] }]\n\
    probe = [{ name = 'foot', point = [0.3, 0.02], size = 0.04, largest = true, threshold = 200.0 }]\n";

fn run(folder: &Path, out: &str, arguments: &[&str]) {
    std::fs::write(folder.join("column.toml"), SCENE).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(folder).args(["run", "column.toml", "--quiet", "--out", out]);
    let output = command.args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn column(folder: &Path, out: &str, name: &str) -> Vec<f64> {
    let mut table = csv::Reader::from_path(folder.join(out).join("results.csv")).unwrap();
    let headers = table.headers().unwrap().clone();
    let place = headers.iter().position(|header| header.split(" [").next() == Some(name));
    let place = place.unwrap_or_else(|| panic!("{name} is not among {headers:?}"));
    table.records().map(|row| row.unwrap()[place].parse().unwrap()).collect()
}

#[test]
fn rows_stand_for_their_interval() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, "fine", &[]);
    run(folder, "coarse", &["--set", "output.record_interval=0.02"]);
    let read = |out: &str, what: &str| column(folder, out, &format!("fluid.probe.foot.{what}"));
    let [fine, coarse] = ["fine", "coarse"].map(|out| ["pressure", "largest", "impulse"].map(|what| read(out, what)));
    assert_eq!((fine[0].len(), coarse[0].len()), (201, 21));
    for row in 1..21 {
        let of_row = |values: &[f64]| values[10 * row - 9..=10 * row].to_vec();
        let mean = of_row(&fine[0]).iter().sum::<f64>() / 10.0;
        assert!((coarse[0][row] - mean).abs() < 1e-9 * mean.abs().max(1.0), "row {row}: {} for {mean}", coarse[0][row]);
        let largest = of_row(&fine[1]).into_iter().fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(coarse[1][row], largest, "row {row}");
        assert_eq!(coarse[2][row], fine[2][10 * row], "row {row}");
    }
    let (peak, mean) = (coarse[1].iter().copied().fold(0.0, f64::max), coarse[0].iter().copied().fold(0.0, f64::max));
    assert!(peak > 1.1 * mean && mean > 500.0 && coarse[2][20] > 10.0, "{peak}, {mean} Pa, {} Pa s", coarse[2][20]);
}

#[test]
fn keys_of_probes_are_in_their_ranges() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("column.toml"), SCENE.replace("size = 0.04", "size = -1.0")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    let output = command.current_dir(folder.path()).args(["check", "column.toml"]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("fluid.probe[0].size = -1"), "{message}");
}
