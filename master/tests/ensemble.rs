//! Ensembles as a user makes them: equal runs from starts that differ a little, taken up again, compared.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use std::path::Path;
use std::process::{Command, Output};

/// A column that collapses, coarse and short.
const SCENE: &str = "title = 'a small column'\n[run]\nend = 0.1\ncommunication_step = 0.005\n[output]\ninterval = 0.0\n\
    [fluid]\nspacing = 0.02\nwater = [{ polygon = [[0,0],[0.1,0],[0.1,0.2],[0,0.2]] }]\n\
    wall = [{ points = [[0,0.5],[0,0],[0.4,0],[0.4,0.5]] }]\nprobe = [{ name = 'foot', point = [0.0, 0.01] }]\n\
    [[check]]\nname = 'front'\nkind = 'series_maximum'\nvariable = 'fluid.front.x'\nunit = 'm'\n";

fn plimsoll(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_plimsoll")).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn make(folder: &Path, out: &str, more: &[&str]) -> (String, serde_json::Value) {
    let arguments = [&["ensemble", "column.toml", "--out", out, "--members", "3"], more].concat();
    let output = plimsoll(folder, &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json = std::fs::read_to_string(folder.join(out).join("ensemble.json")).unwrap();
    (text(&output.stderr), serde_json::from_str(&json).unwrap())
}

#[test]
fn an_ensemble_is_made_taken_up_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("column.toml"), SCENE).unwrap();
    let (told, first) = make(folder, "light", &[]);
    assert_eq!(told.matches("s of wall-clock time").count(), 3, "{told}");
    let fronts = first["figures"]["front"]["values"].as_object().unwrap();
    let values: Vec<f64> = fronts.values().map(|value| value.as_f64().unwrap()).collect();
    assert!(values.len() == 3 && values[0] != values[1] && (values[0] / values[1] - 1.0).abs() < 0.1, "{values:?}");
    assert!(first["figures"]["impulse of fluid.probe.foot.pressure"]["unit"] == "Pa s");
    assert_eq!(first["members"][2]["seed"], 3);
    // A run that was not finished is made again, the others are taken as they are.
    let kept = std::fs::metadata(folder.join("light/member-001/results.csv")).unwrap().modified().unwrap();
    std::fs::remove_dir_all(folder.join("light/member-003")).unwrap();
    assert_eq!(make(folder, "light", &[]).1, first, "the same starts give the same runs");
    let again = std::fs::metadata(folder.join("light/member-001/results.csv")).unwrap().modified().unwrap();
    assert_eq!(kept, again);
    let page = std::fs::read_to_string(folder.join("light/report.html")).unwrap();
    assert!(page.contains("a small column: 3 runs") && page.contains("95 % band"));
    make(folder, "heavy", &["--set", "gravity=[0.0,-19.62]", "--jobs", "1", "--seed", "9"]);
    let output = plimsoll(folder, &["compare", "light", "heavy", "--out", "both.html"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let page = std::fs::read_to_string(folder.join("both.html")).unwrap();
    assert!(page.contains("Welch") && page.contains("<td>differ</td>"), "twice the gravity is seen");
    let output = plimsoll(folder, &["compare", "light", "light/member-001", "--out", "both.html"]);
    assert!(text(&output.stderr).contains("an ensemble is compared with one other ensemble"));
}

#[test]
fn what_cannot_be_is_told_with_its_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("column.toml"), SCENE).unwrap();
    let refused = |more: &[&str]| {
        let output = plimsoll(folder.path(), &[&["ensemble", "column.toml", "--out", "e"], more].concat());
        assert_eq!(output.status.code(), Some(1));
        text(&output.stderr)
    };
    assert!(refused(&["--members", "0"]).contains("--members 0: expected 1 to 10000"));
    assert!(refused(&["--jitter", "0.5"]).contains("--jitter 0.5: expected a number above 0, up to 0.2"));
    let message = refused(&["--members", "2", "--set", "fluid.spacing=-1"]);
    assert!(message.contains("member-002: ") && message.contains("fluid.spacing = -1"), "{message}");
}
