//! Limits that a run misses, those of the watch over it among them: told at once, kept in every report, exit code 3.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A column of water that stands in a tank without a right wall.
const OPEN: &str = "title = 'open'\n[run]\nend = 0.8\ncommunication_step = 0.01\n[output]\ninterval = 0.0\n[fluid]\n\
    spacing = 0.02\nthreads = 1\nwater = [{ polygon = [[0,0],[0.2,0],[0.2,0.2],[0,0.2]] }]\n\
    wall = [{ points = [[0,0.4],[0,0],[0.25,0]] }]\n[[check]]\nname = 'front'\nkind = 'series_maximum'\n\
    variable = 'fluid.front.x'\nunit = 'm'\nlimit = LIMIT\n";

fn run(folder: &Path, target: &str, changes: &[&str]) -> (Output, Value) {
    let out = folder.join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .args(["run", target, "--quiet", "--overwrite", "--out"])
        .arg(&out);
    let output = command.args(changes.iter().flat_map(|change| ["--set", change])).output().unwrap();
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    (output, serde_json::from_str(&summary).unwrap())
}

/// The text of a finding that stands in every place where it belongs.
fn told(folder: &Path, output: &Output, summary: &Value, words: &str) -> String {
    let texts = summary["missed"].as_array().unwrap();
    let text = texts.iter().map(|text| text.as_str().unwrap()).find(|text| text.contains(words));
    let text = text.unwrap_or_else(|| panic!("{texts:?}: expected '{words}'")).to_string();
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains(&format!("warning: {text}")), "standard error");
    let file = |name: &str| std::fs::read_to_string(folder.join("out").join(name)).unwrap();
    assert!(file("summary.md").contains(&format!("- {text}")), "{}", file("summary.md"));
    assert!(file("report.html").contains("Limits that were missed"));
    text
}

#[test]
fn lost_water_is_told_unless_it_is_meant_to_run_out() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("open.toml");
    std::fs::write(&scene, OPEN.replace("LIMIT", "10.0")).unwrap();
    let scene = scene.to_str().unwrap();
    let (output, summary) = run(folder.path(), scene, &[]);
    let text = told(folder.path(), &output, &summary, "(watch.lost)");
    assert!(text.contains("of 100 particles had left the scene"), "{text}");
    assert_eq!(summary["warnings"][0].as_str(), Some(text.as_str()));
    let log = std::fs::read_to_string(folder.path().join("out/log.txt")).unwrap();
    assert!(log.contains(&text), "{log}");
    assert_eq!(summary["missed"].as_array().unwrap().len(), 1, "{}", summary["missed"]);
    let (output, summary) = run(folder.path(), scene, &["watch.lost=1"]);
    assert_eq!((output.status.code(), summary["status"].as_str()), (Some(0), Some("complete")));
    assert!(output.stderr.is_empty() && summary["missed"].as_array().unwrap().is_empty());
}

#[test]
fn a_check_outside_its_limit_ends_with_its_own_code() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("open.toml");
    std::fs::write(&scene, OPEN.replace("LIMIT", "0.01")).unwrap();
    let (output, summary) = run(folder.path(), scene.to_str().unwrap(), &["watch.lost=1", "run.end=0.02"]);
    let text = told(folder.path(), &output, &summary, "check 'front'");
    assert!(text.contains("m, expected at most 0.01000 m"), "{text}");
    assert_eq!(summary["checks"]["front"]["passed"], false);
    let arguments =
        ["run", scene.to_str().unwrap(), "--set", "watch.lost=1", "--set", "run.end=0.02", "--resume", "--out"];
    let mut again = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    let again = again.args(arguments).arg(folder.path().join("out")).output().unwrap();
    assert_eq!(again.status.code(), Some(3), "{}", String::from_utf8_lossy(&again.stderr));
    let again = String::from_utf8_lossy(&again.stderr);
    assert!(again.contains("complete already") && again.contains(&format!("warning: {text}")), "{again}");
}

/// An explicit exchange above a mass ratio of 1 feeds energy into water and piston before it fails.
#[test]
fn energy_that_nothing_supplied_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let changes = [
        "body.0.mass=181.8181818",
        "body.0.springs=[0.0, 15073.57763, 0.0]",
        "coupling.method=explicit",
        "coupling.added_mass=false",
        "fluid.spacing=0.04",
        "fluid.threads=1",
        "output.interval=0",
        "check=[]",
    ];
    // It fails at 0.185 s.
    let (output, summary) = run(folder.path(), "piston", &[&changes[..], &["run.end=0.15"]].concat());
    told(folder.path(), &output, &summary, "that nothing supplied");
    assert!(summary["energy_gain"].as_f64().unwrap() > 0.01);
    let (output, summary) = run(folder.path(), "piston", &[&changes[..2], &changes[4..], &["run.end=0.5"]].concat());
    assert_eq!(output.status.code(), Some(0), "newton: {}", summary["missed"]);
    assert!(summary["energy_gain"].as_f64().unwrap() < 0.005, "{}", summary["energy_gain"]);
}

#[test]
fn a_period_near_the_step_is_warned_of_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let stiff = ["body.0.member.0.youngs_modulus=1e9", "run.end=0.02", "output.interval=0", "check=[]"];
    let (output, summary) = run(folder.path(), "free_decay", &stiff);
    let warning = summary["warnings"][0].as_str().unwrap();
    assert!(warning.contains("mode 1 (0.005220 s, 11.1 % too long)"), "{warning}");
    assert!(String::from_utf8_lossy(&output.stderr).contains(warning) && output.status.success());
    for name in ["summary.md", "report.html", "log.txt"] {
        assert!(std::fs::read_to_string(folder.path().join("out").join(name)).unwrap().contains(warning), "{name}");
    }
    let mut check = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    check.current_dir(folder.path()).args(["check", concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/free_decay.toml")]);
    let output = check.args(stiff.iter().flat_map(|change| ["--set", change])).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).contains(&format!("warning: {warning}")), "{output:?}");
}

/// A polygon of 32 corners with a radius of 0.1 m, held under water: its load is recorded and is what it displaces.
#[test]
fn a_body_that_is_held_has_its_load_in_the_results() {
    let folder = tempfile::tempdir().unwrap();
    let corner = |k: i32, x: f64, y: f64| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 32.0).sin_cos();
        format!("[{},{}]", x + 0.1 * cos, y + 0.1 * sin)
    };
    let join = |corners: Vec<String>| corners.join(",");
    let body = join((0..32).map(|k| corner(-k, 0.0, 0.0)).collect());
    // The water on both sides of a cut through the middle: left of it from the lowest corner up, right of it down.
    let left = join((0..=16).map(|k| corner(-8 - k, 0.6, 0.4)).collect());
    let right = join((0..=16).map(|k| corner(8 - k, 0.6, 0.4)).collect());
    let scene = format!(
        "title = 'held'\n[run]\nend = 0.01\ncommunication_step = 0.002\n[output]\ninterval = 0.0\n[fluid]\n\
         spacing = 0.02\nthreads = 1\nwall = [{{ points = [[0,1],[0,0],[1.2,0],[1.2,1]] }}]\n\
         water = [{{ polygon = [[0,0],[0.6,0],{left},[0.6,0.8],[0,0.8]] }},\n\
         {{ polygon = [[1.2,0.8],[0.6,0.8],{right},[0.6,0],[1.2,0]] }}]\n\
         [[body]]\nname = 'box'\norigin = [0.6, 0.4]\nfree = []\nwall = [{{ points = [{body}], closed = true }}]\n"
    );
    let path = folder.path().join("held.toml");
    std::fs::write(&path, scene).unwrap();
    let (output, _) = run(folder.path(), path.to_str().unwrap(), &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut table = csv::Reader::from_path(folder.path().join("out/results.csv")).unwrap();
    let mut place = |name: &str| table.headers().unwrap().iter().position(|header| header.starts_with(name)).unwrap();
    let places = [place("fluid.body.box.load.fx"), place("fluid.body.box.load.fy"), place("fluid.body.box.load.mz")];
    let area = 16.0 * 0.01 * (std::f64::consts::TAU / 32.0).sin();
    let buoyancy = 9810.0 * area;
    for row in table.records().skip(1).map(Result::unwrap) {
        let [fx, fy, mz] = places.map(|place| row[place].parse::<f64>().unwrap());
        assert!((fy - buoyancy).abs() < 0.02 * buoyancy, "{fy} N/m, expected {buoyancy}");
        assert!(fx.abs() < 0.02 * buoyancy && mz.abs() < 0.02 * 0.1 * buoyancy, "{fx} N/m, {mz} N m/m");
    }
}
