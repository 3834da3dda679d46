//! Several bodies, and several members on one: from the scene file through both FMUs and the master to the report.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use std::path::Path;
use std::process::Command;

/// A tank that is the mirror image of itself, with two plates on its floor, bent towards each other, and a box that floats
/// between them and is a tenth too heavy.
const SCENE: &str = "title = 'two plates and a box'\n[run]\nend = 0.05\ncommunication_step = 0.001\n[output]\ninterval = 0.05\n\
    [fluid]\nspacing = 0.02\nthreads = 1\nwall = [{ points = [[0,0.6],[0,0],[1.2,0],[1.2,0.6]] }]\n\
    water = [{ polygon = [[0,0],[0.3,0],[0.3,0.2],[0.32,0.2],[0.32,0],[0.88,0],[0.88,0.2],[0.9,0.2],[0.9,0],[1.2,0],\
    [1.2,0.3],[0.7,0.3],[0.7,0.2],[0.5,0.2],[0.5,0.3],[0,0.3]] }]\n\
    probe = [{ name = 'keel, middle', point = [0.6, 0.2], on_body = 'the box' }]\n\
    [[body]]\nname = 'base'\n\
    [[body.member]]\nname = 'left'\nsupport = 'clamped_free'\nmiddle = [0.31, 0.1]\nlength = 0.2\nthickness = 0.02\n\
    density = 2500.0\nyoungs_modulus = 1e7\nmodes = 2\ninitial_modes = [-0.001]\n\
    [[body.member]]\nname = 'right'\nsupport = 'clamped_free'\nmiddle = [0.89, 0.1]\nlength = 0.2\nthickness = 0.02\n\
    density = 2500.0\nyoungs_modulus = 1e7\nmodes = 1\ninitial_modes = [0.001]\n\
    [[body]]\nname = 'the box'\norigin = [0.6, 0.3]\nfree = ['x', 'y', 'theta']\nmass = 22.0\ninertia = 0.15\n\
    wall = [{ points = [[-0.1,-0.1],[-0.1,0.1],[0.1,0.1],[0.1,-0.1]], closed = true }]\n\
    [[check]]\nname = 'sinkage'\nkind = 'series_minimum'\nvariable = 'structure.body.the_box.motion.y'\nunit = 'm'\n";

fn run(folder: &Path, set: &[&str]) {
    std::fs::write(folder.join("several.toml"), SCENE).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(folder).args(["run", "several.toml", "--quiet", "--overwrite", "--out", "out"]);
    let output = command.args(set.iter().flat_map(|change| ["--set", change])).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Values of a column of the results.
fn column(folder: &Path, name: &str) -> Vec<f64> {
    let mut table = csv::Reader::from_path(folder.join("out/results.csv")).unwrap();
    let headers = table.headers().unwrap().clone();
    let place = headers.iter().position(|header| header.split(" [").next() == Some(name));
    let place = place.unwrap_or_else(|| panic!("{name} is not among {headers:?}"));
    table.records().map(|row| row.unwrap()[place].parse().unwrap()).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// With as many modes left and right all is symmetric; with one mode less the other way of counting is seen.
#[test]
fn two_plates_and_a_box_run_from_the_scene_to_the_report() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &["body.base.member.right.modes=2"]);
    let column = |name: &str| column(folder.path(), name);
    let tips = ["left", "right"].map(|side| column(&format!("structure.body.base.{side}.deflection.tip")));
    let sums: Vec<f64> = tips[0].iter().zip(&tips[1]).map(|(left, right)| left + right).collect();
    assert!(largest(&tips[0]) > 1e-4, "{tips:?}");
    // The last digits of places, over the square of a step of 1 ms: that of the areas is a pressure.
    assert!(largest(&sums) < 1e-6 * largest(&tips[0]), "{}", largest(&sums) / largest(&tips[0]));
    let fall = column("structure.body.the_box.motion.y");
    assert!(
        *fall.last().unwrap() < -1e-4 && largest(&column("structure.body.the_box.motion.x")) < 1e-6 * largest(&fall)
    );
    let loads = ["left", "right"].map(|side| column(&format!("fluid.body.base.{side}.load.q2")));
    assert!(loads[0].iter().zip(&loads[1]).all(|(left, right)| (left + right).abs() < 1e-4 * largest(&loads[0])));
    // 0.1 m of water, more or less.
    let keel = column("fluid.probe.keel_middle.pressure");
    assert!(keel.iter().skip(1).all(|pressure| (500.0..2000.0).contains(pressure)), "{keel:?}");
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("out/summary.json")).unwrap()).unwrap();
    assert!(summary["coupling"]["mean_iterations"].as_f64().unwrap() <= 2.5, "{}", summary["coupling"]);
    assert!(summary["checks"]["sinkage"]["value"].as_f64().unwrap() < -1e-4);
    let report = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    for name in ["structure.body.base.left.deflection.tip", "structure.body.the_box.motion.y", "keel, middle"] {
        assert!(report.contains(name), "{name} is not in the report");
    }
    run(folder.path(), &[]);
    let asymmetric = self::column(folder.path(), "structure.body.base.right.deflection.tip");
    assert_ne!(asymmetric, tips[1]);
    assert!(
        (asymmetric.last().unwrap() / tips[1].last().unwrap() - 1.0).abs() < 0.05,
        "the second mode is a small part"
    );
}
