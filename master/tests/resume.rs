//! A run that was stopped goes on with the same bits, and one that is done can be repeated from its folder.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

/// A column of water that falls against an elastic plate: long enough to be stopped, about two seconds.
const SCENE: &str = "title = 'small dam'\n[run]\nend = 0.2\ncommunication_step = 0.0005\n\
    [output]\ninterval = 0.02\ncheckpoint_interval = 0.05\n\
    [fluid]\nspacing = 0.005\nwater = [{ polygon = [[0,0],[0.1,0],[0.1,0.2],[0,0.2]] }]\n\
    wall = [{ points = [[0,0.5],[0,0],[0.4,0],[0.4,0.5]] }]\n\
    [structure.beam]\nsupport = 'clamped_free'\nmiddle = [0.206, 0.05]\nlength = 0.1\nthickness = 0.012\n\
    density = 2500.0\nyoungs_modulus = 2e7\nmodes = 2\n";

fn plimsoll(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(folder).arg("run").args(arguments);
    command
}

fn done(output: Output) -> String {
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{error}");
    error
}

/// Waits until a checkpoint is there; false when the run ended before.
fn has_checkpoint(child: &mut Child, folder: &Path) -> bool {
    loop {
        if folder.join("checkpoint.bin").is_file() {
            return true;
        }
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Tables and frames of two runs have the same bytes.
fn same(one: &Path, other: &Path) {
    let mut names = vec!["results.csv".to_string(), "iterations.csv".to_string()];
    let frames = std::fs::read_dir(one.join("frames")).unwrap();
    names.extend(frames.map(|entry| format!("frames/{}", entry.unwrap().file_name().to_string_lossy())));
    assert!(names.len() > 20, "{names:?}");
    for name in names {
        assert!(std::fs::read(one.join(&name)).unwrap() == std::fs::read(other.join(&name)).unwrap(), "{name}");
    }
}

#[test]
fn a_killed_run_goes_on_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // The program packs FMUs with the scenes that it finds: the project's, from below its folder.
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = at.join("small.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let (scene, whole, mut cut) = (scene.to_str().unwrap(), at.join("whole"), at.join("cut"));
    done(plimsoll(project, &[scene, "--quiet", "--out", whole.to_str().unwrap()]).output().unwrap());
    for (k, signal) in ["-KILL", "-KILL", "-TERM"].into_iter().enumerate() {
        // It goes on wherever its folder was moved to.
        let before = std::mem::replace(&mut cut, at.join(format!("cut-{k}")));
        if before.exists() {
            std::fs::rename(&before, &cut).unwrap();
        }
        let arguments = [scene, "--resume", "--quiet", "--out", cut.to_str().unwrap()];
        let mut child = plimsoll(project, &arguments).stderr(Stdio::null()).spawn().unwrap();
        assert!(has_checkpoint(&mut child, &cut), "the run ended before it could be stopped");
        std::thread::sleep(Duration::from_millis(150));
        // The shell's own kill: a minimal system has no other.
        Command::new("sh").args(["-c", &format!("kill {signal} {}", child.id())]).status().unwrap();
        let code = child.wait().unwrap().code();
        assert_eq!(code, if signal == "-TERM" { Some(130) } else { None });
    }
    done(plimsoll(project, &[scene, "--resume", "--quiet", "--out", cut.to_str().unwrap()]).output().unwrap());
    same(&whole, &cut);
    assert!(!cut.join("checkpoint.bin").exists(), "a run that is done leaves none");
    let again = at.join("again");
    done(plimsoll(project, &[whole.to_str().unwrap(), "--quiet", "--out", again.to_str().unwrap()]).output().unwrap());
    let table = |folder: &Path| std::fs::read(folder.join("results.csv")).unwrap();
    assert!(table(&whole) == table(&again), "a run repeats from its folder");
}

#[test]
fn other_inputs_are_refused_and_progress_is_json() {
    let folder = tempfile::tempdir().unwrap();
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (scene, out) = (folder.path().join("small.toml"), folder.path().join("out"));
    std::fs::write(&scene, SCENE).unwrap();
    let arguments = [scene.to_str().unwrap(), "--resume", "--log", "json", "--out", out.to_str().unwrap()];
    let mut child = plimsoll(project, &arguments).stderr(Stdio::piped()).spawn().unwrap();
    assert!(has_checkpoint(&mut child, &out));
    Command::new("sh").args(["-c", &format!("kill -TERM {}", child.id())]).status().unwrap();
    let text = String::from_utf8(child.wait_with_output().unwrap().stderr).unwrap();
    let lines: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&lines[0]["event"], &lines[0]["end"]), (&"start".into(), &0.2.into()));
    assert_eq!(lines.last().unwrap()["status"], "interrupted");
    std::fs::write(&scene, SCENE.replace("2e7", "3e7")).unwrap();
    let output = plimsoll(project, &arguments).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("with other inputs") && text.contains("youngs_modulus = 3e7"), "{text}");
    assert!(text.contains("without --resume"), "{text}");
}
