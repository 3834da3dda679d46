//! A run that was stopped goes on with the same bits, and one that is done can be repeated from its folder.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A column of water that falls against an elastic plate: long enough to be stopped, about two seconds.
const SCENE: &str = "title = 'small dam'\n[run]\nend = 0.2\ncommunication_step = 0.0005\n\
    [output]\ninterval = 0.02\ncheckpoint_interval = 0.05\n\
    [fluid]\nspacing = 0.005\nwater = [{ polygon = [[0,0],[0.1,0],[0.1,0.2],[0,0.2]] }]\n\
    wall = [{ points = [[0,0.5],[0,0],[0.4,0],[0.4,0.5]] }]\n\
    [[body]]\nname = 'base'\n[[body.member]]\nname = 'plate'\nsupport = 'clamped_free'\nmiddle = [0.206, 0.05]\nlength = 0.1\nthickness = 0.012\n\
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

/// Waits until a checkpoint is there that was written after ten rows; false when the run ended before.
fn has_later_checkpoint(child: &mut Child, folder: &Path) -> bool {
    let written = || std::fs::metadata(folder.join("checkpoint.bin")).and_then(|file| file.modified()).ok();
    let rows = || std::fs::read_to_string(folder.join("results.csv")).unwrap_or_default().lines().count();
    let mut until = |condition: &dyn Fn() -> bool| {
        while !condition() {
            if child.try_wait().unwrap().is_some() {
                return false;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        true
    };
    if !until(&|| rows() > 10) {
        return false;
    }
    let before = written();
    until(&|| written().is_some() && written() != before)
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
    let before = lines.iter().take_while(|line| line["event"] == "warning").count();
    assert_eq!((&lines[before]["event"], &lines[before]["end"]), (&"start".into(), &0.2.into()));
    assert_eq!(lines.last().unwrap()["status"], "interrupted");
    std::fs::write(&scene, SCENE.replace("2e7", "3e7")).unwrap();
    let output = plimsoll(project, &arguments).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("with other inputs") && text.contains("youngs_modulus = 30000000.0"), "{text}");
    assert!(text.contains("without --resume"), "{text}");
}

/// Kills of [`a_run_that_is_killed_at_any_moment_is_completed`]; PLIMSOLL_KILLS sets another number.
const KILLS: u32 = 8;

/// A number between 0 and 1 that follows from the one before (Knuth's linear congruence).
fn next(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 53) as f64
}

/// What a kill at any moment must leave: whole rows, and a list of files that can be read.
fn is_sound(folder: &Path) {
    for name in ["results.csv", "iterations.csv"] {
        let Ok(text) = std::fs::read_to_string(folder.join(name)) else { continue };
        let columns = |line: &str| line.split(',').count();
        let first = text.lines().next().map(columns);
        assert!(text.is_empty() || text.ends_with('\n'), "{name}: the last row is torn");
        assert!(text.lines().all(|line| Some(columns(line)) == first), "{name}: a row is torn");
    }
    if let Ok(text) = std::fs::read_to_string(folder.join("run.json")) {
        assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok(), "run.json: {text}");
    }
}

/// Starts a run and kills it after a share of the time that a whole one takes, or, in its report, of the time for that.
fn kill_at(arguments: &[&str], out: &Path, times: (f64, f64), seed: &mut u64) -> bool {
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut child = plimsoll(project, arguments).stderr(Stdio::null()).spawn().unwrap();
    let in_report = next(seed) < 0.5;
    while in_report && !out.join("summary.json").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let longest = if in_report { times.1 } else { times.0 };
    std::thread::sleep(Duration::from_secs_f64(1.1 * longest * next(seed)));
    let ended = child.try_wait().unwrap().is_some();
    // No error where the process has ended in between.
    child.kill().unwrap();
    child.wait().unwrap();
    is_sound(out);
    ended
}

#[test]
fn a_run_that_is_killed_at_any_moment_is_completed() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let (kills, mut seed) =
        (number("PLIMSOLL_KILLS").unwrap_or(KILLS.into()), number("PLIMSOLL_FUZZ_SEED").unwrap_or(1));
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = at.join("small.toml");
    std::fs::write(&scene, SCENE.replace("end = 0.2", "end = 0.05").replace("interval = 0.02", "interval = 0.002"))
        .unwrap();
    let (scene, whole) = (scene.to_str().unwrap(), at.join("whole"));
    let begin = Instant::now();
    let mut child = plimsoll(project, &[scene, "--quiet", "--out", whole.to_str().unwrap()]).spawn().unwrap();
    while !whole.join("summary.json").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let computed = begin.elapsed().as_secs_f64();
    assert!(child.wait().unwrap().success());
    let total = begin.elapsed().as_secs_f64();
    let (mut done, mut round) = (0, 0);
    while done < kills {
        round += 1;
        let out = at.join(format!("cut-{round}"));
        let arguments = [scene, "--resume", "--quiet", "--out", out.to_str().unwrap()];
        // At most so many in a row: a run that is always killed comes to no end.
        for _ in 0..6 {
            done += 1;
            if kill_at(&arguments, &out, (total, total - computed), &mut seed) || done == kills {
                break;
            }
        }
        let last = plimsoll(project, &arguments).output().unwrap();
        done_with(last, &out, &whole);
    }
}

/// The run in `out` was completed, and nothing tells it from the `whole` one.
fn done_with(last: Output, out: &Path, whole: &Path) {
    done(last);
    same(whole, out);
    assert!(std::fs::read_to_string(out.join("report.html")).unwrap().ends_with("</html>"));
    let names = |folder: &Path| {
        let files = |folder: &Path| -> Vec<_> {
            std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect()
        };
        let mut names = [files(folder), files(&folder.join("plots")), files(&folder.join("frames"))].concat();
        names.sort();
        names
    };
    assert_eq!(names(out), names(whole));
}

#[test]
fn a_run_goes_on_with_other_threads_another_interval_and_a_later_end() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = at.join("small.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let (scene, whole, cut) = (scene.to_str().unwrap(), at.join("whole"), at.join("cut"));
    let later = [scene, "--set", "run.end=0.25", "--quiet", "--out"];
    done(plimsoll(project, &[&later[..], &[whole.to_str().unwrap()]].concat()).output().unwrap());
    let cut_text = cut.to_str().unwrap();
    let mut child = plimsoll(project, &[scene, "--quiet", "--threads", "2", "--out", cut_text]).spawn().unwrap();
    assert!(has_later_checkpoint(&mut child, &cut), "the run ended before it could be stopped");
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = at.join("kept");
    assert!(Command::new("cp").arg("-r").arg(&cut).arg(&kept).status().unwrap().success());
    let other = ["--resume", "--threads", "1", "--set", "output.checkpoint_interval=7"];
    done(plimsoll(project, &[&later[..], &[cut_text], &other].concat()).output().unwrap());
    same(&whole, &cut);
    // An end that lies before the checkpoint is none.
    let before = [scene, "--resume", "--set", "run.end=0.0005", "--quiet", "--out", kept.to_str().unwrap()];
    let output = plimsoll(project, &before).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("beyond run.end = 0.0005 s"), "{text}");
}

#[test]
fn a_complete_run_is_replaced_only_when_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = folder.path().join("out");
    let run = |more: &[&str]| {
        // As short as that it has no frequency, which would be a limit missed.
        let arguments =
            ["free_decay", "--set", "run.end=0.01", "--set", "check=[]", "--quiet", "--out", out.to_str().unwrap()];
        plimsoll(project, &[&arguments[..], more].concat()).output().unwrap()
    };
    let text = |output: Output| String::from_utf8_lossy(&output.stderr).into_owned();
    done(run(&[]));
    let written = || std::fs::metadata(out.join("results.csv")).unwrap().modified().unwrap();
    let first = written();
    let again = run(&[]);
    assert_eq!(again.status.code(), Some(1));
    assert!(text(again).contains("holds a complete run; --overwrite replaces it"));
    assert!(done(run(&["--resume"])).contains("is complete already"));
    let other = run(&["--resume", "--set", "run.end=0.02"]);
    assert!(text(other).contains("a complete run of other inputs"));
    assert_eq!(written(), first);
    // Cut off in its report it is neither lost nor taken for complete.
    let list = out.join("run.json");
    let mut recipe: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&list).unwrap()).unwrap();
    recipe.as_object_mut().unwrap().remove("ended").unwrap();
    std::fs::write(&list, recipe.to_string()).unwrap();
    std::fs::remove_file(out.join("report.html")).unwrap();
    assert!(text(run(&[])).contains("--resume finishes it"));
    done(run(&["--resume"]));
    assert!(out.join("report.html").is_file());
    done(run(&["--overwrite"]));
    std::fs::write(out.join("thesis.tex"), "mine").unwrap();
    assert!(text(run(&["--overwrite"])).contains("thesis.tex: is a file that no run wrote"));
    assert_eq!(std::fs::read_to_string(out.join("thesis.tex")).unwrap(), "mine");
    assert!(out.join("results.csv").is_file(), "nothing was removed");
}
