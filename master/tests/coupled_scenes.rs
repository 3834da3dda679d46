//! Scenes with a free structure, run as a user runs them: every coupling method against the exact answer.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use serde_json::Value;
use std::process::{Command, Output};

/// Mass and spring of rows of J_piston_added_mass: the water is 0.1, 10 and 1000 times as heavy as the piston.
const RATIOS: [(f64, f64); 3] = [(2000.0, 86_852.518_73), (20.0, 8_685.251_873), (0.2, 7_903.579_204)];

fn run(scene: &str, changes: &[String]) -> (Output, Option<Value>) {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).args(["run", scene, "--quiet", "--out"]);
    command.arg(folder.path());
    for change in changes {
        command.args(["--set", change]);
    }
    let output = command.output().unwrap();
    let summary = std::fs::read_to_string(folder.path().join("summary.json")).ok();
    (output, summary.map(|text| serde_json::from_str(&text).unwrap()))
}

fn piston((mass, spring): (f64, f64), method: &str, added_mass: bool) -> (Output, Option<Value>) {
    run(
        "piston",
        &[
            format!("body.0.mass={mass}"),
            format!("body.0.springs=[0.0, {spring}, 0.0]"),
            format!("coupling.method={method}"),
            format!("coupling.added_mass={added_mass}"),
            "fluid.spacing=0.04".to_string(),
            "fluid.threads=1".to_string(),
            "output.interval=0".to_string(),
        ],
    )
}

/// At its end, within the scene's limits (0) or, as a coarse run may be, outside one of them (3).
fn ended(output: &Output) -> bool {
    matches!(output.status.code(), Some(0 | 3))
}

fn check(summary: &Value, name: &str) -> f64 {
    summary["checks"][name]["error"].as_f64().unwrap_or(f64::NAN)
}

/// Work is counted: passes per step do not depend on the mass ratio.
#[test]
fn iterations_close_at_every_mass_ratio() {
    for ratio in RATIOS {
        for (method, most) in [("newton", 2.5), ("iqn_ils", 4.0)] {
            let (output, summary) = piston(ratio, method, true);
            assert!(ended(&output), "{}", String::from_utf8_lossy(&output.stderr));
            let summary = summary.unwrap();
            let mean = summary["coupling"]["mean_iterations"].as_f64().unwrap();
            assert!(mean <= most, "{method} at {ratio:?}: {mean} iterations per step");
            assert_eq!(summary["coupling"]["rollbacks"].as_u64(), Some(0), "{method} at {ratio:?}");
            let (frequency, sag) = (check(&summary, "frequency"), check(&summary, "static sag"));
            assert!(frequency.abs() < 0.005, "{method} at {ratio:?}: frequency is off by {frequency} Hz of 1");
            assert!(sag.abs() < 0.005 * 0.2485, "{method} at {ratio:?}: sag is off by {sag} m of 0.2485");
        }
    }
}

#[test]
fn explicit_with_added_mass_is_stable_at_every_mass_ratio() {
    for ratio in RATIOS {
        let (output, summary) = piston(ratio, "explicit", true);
        assert!(ended(&output), "{}", String::from_utf8_lossy(&output.stderr));
        let frequency = check(&summary.unwrap(), "frequency");
        assert!(frequency.abs() < 0.01, "at {ratio:?}: frequency is off by {frequency} Hz of 1");
    }
}

#[test]
fn plain_explicit_fails_above_one_and_says_why() {
    // Added masses of 0.9, 1.1 and 10 times the piston's.
    let (output, _) = piston((222.222_222_2, 16_668.665_21), "explicit", false);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    for (row, factor) in [((181.818_181_8, 15_073.577_63), "1.1"), (RATIOS[1], "10.0")] {
        let (output, _) = piston(row, "explicit", false);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{message}");
        let says = format!("multiplies errors by up to {factor}");
        assert!(message.contains(&says) && message.contains("added_mass"), "{message}");
    }
}

#[test]
fn the_default_method_is_newton() {
    let (output, summary) = piston(RATIOS[1], "auto", true);
    assert!(output.status.success());
    assert_eq!(summary.unwrap()["coupling"]["method"], "newton");
    let mps = vec!["fluid.scheme=mps".to_string(), "run.end=0.01".to_string(), "coupling.method=auto".to_string()];
    let (output, summary) = run("dam_break_plate", &mps);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(summary.unwrap()["coupling"]["method"], "iqn_ils", "the paper's scheme gives no derivatives");
}
