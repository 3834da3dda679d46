//! The scenes as tests: the quick variant of each keeps its limits, and a limit that is missed is told.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use scene::Scene;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

fn scenes() -> Vec<PathBuf> {
    let files = std::fs::read_dir(SCENES).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect()
}

fn validate(arguments: &[&str], out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    command.args(["validate", "--quick", "--out"]).arg(out).args(arguments);
    command.output().unwrap()
}

#[test]
fn every_scene_keeps_the_limits_of_its_quick_variant() {
    let folder = tempfile::tempdir().unwrap();
    let output = validate(&[], folder.path());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let record = std::fs::read_to_string(folder.path().join("record.md")).unwrap();
    for path in scenes() {
        let name = path.file_stem().unwrap().to_string_lossy();
        assert!(record.contains(&format!("| {name} | ")), "{name} is not in the record:\n{said}");
    }
}

/// A figure without a limit is no test; one without a reference bounds itself.
#[test]
fn every_scene_has_limits_in_its_quick_variant() {
    for path in scenes() {
        let quick = Scene::from_file_with(&path, &[("quick.active".into(), "true".into())]).unwrap();
        let bounded = quick.check.iter().filter(|check| check.limit.is_some()).count();
        assert!(bounded >= 2 && bounded == quick.check.len(), "{}: {bounded} limits", path.display());
    }
}

#[test]
fn a_limit_that_is_missed_has_its_exit_code_and_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(Path::new(SCENES).join("piston.toml")).unwrap();
    let heavy = folder.path().join("heavy.toml");
    // Piston and water, 220 kg, become a tenth heavier: the frequency falls by five per cent.
    let set = "set = [\"body.0.mass=42.0\", ";
    std::fs::write(&heavy, text.replace("set = [", set)).unwrap();
    let output = validate(&[heavy.to_str().unwrap()], folder.path());
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    let record = std::fs::read_to_string(folder.path().join("record.md")).unwrap();
    assert!(record.contains("- heavy: missed: check 'frequency'"), "{record}");
}

#[test]
fn a_scene_without_a_quick_variant_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(Path::new(SCENES).join("free_decay.toml")).unwrap();
    let bare = folder.path().join("bare.toml");
    let without = text.split("[quick]").next().unwrap();
    std::fs::write(&bare, without).unwrap();
    let output = validate(&[bare.to_str().unwrap()], folder.path());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("quick.set") && said.contains("bare.toml"), "{said}");
}
