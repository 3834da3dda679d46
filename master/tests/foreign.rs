//! FMUs of somebody else that exit, crash or hang: told with FMU, call and time, and what was recorded is whole.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, ExitStatus};

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="clock" guid="{1}">
  <CoSimulation modelIdentifier="clock" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables><ScalarVariable name="now" valueReference="1" causality="output"><Real/></ScalarVariable></ModelVariables>
  <ModelStructure><Outputs><Unknown index="1" dependencies=""/></Outputs></ModelStructure>
</fmiModelDescription>"#;

/// Compiles the FMU with a statement in a place and packs it as `folder/clock.fmu`.
fn make(folder: &Path, place: &str, fault: &str) {
    let library = folder.join("clock.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign/fmu.c");
    // The compiler that Rust links with.
    let mut compiler = Command::new("cc");
    compiler.args(["-shared", "-fPIC", "-w", "-o"]).arg(&library).arg(source);
    compiler.arg(format!("-D{place}")).arg(format!("-DFAULT={fault}"));
    assert!(compiler.status().unwrap().success());
    let mut archive = zip::ZipWriter::new(std::fs::File::create(folder.join("clock.fmu")).unwrap());
    let binary = format!("binaries/{}/clock.{}", plimsoll::fmu::PLATFORM, std::env::consts::DLL_EXTENSION);
    let library = std::fs::read(library).unwrap();
    for (name, content) in [("modelDescription.xml", DESCRIPTION.as_bytes()), (&binary, &library)] {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap();
}

/// Runs a case with the FMU for ten steps of 0.01 s; gives how it ended and what it said.
fn run(folder: &Path, limits: &str, arguments: &[&str]) -> (ExitStatus, String) {
    let case = format!(
        "[run]\nend = 0.1\ncommunication_step = 0.01\n{limits}\n[[fmu]]\nname = 'clock'\npath = 'clock.fmu'\n\
         [output]\nplot = ['clock.now']\n"
    );
    std::fs::write(folder.join("case.toml"), case).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    program.current_dir(folder).args(["run", "case.toml", "--out", "out"]).args(arguments);
    let output = program.env("TMPDIR", folder.join("temporary")).output().unwrap();
    (output.status, String::from_utf8_lossy(&output.stderr).into_owned())
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("temporary")).unwrap();
    folder
}

/// The table has whole rows, up to the time in hundredths of a second.
fn recorded(folder: &Path, hundredths: usize) {
    let text = std::fs::read_to_string(folder.join("out/results.csv")).unwrap();
    assert!(text.ends_with('\n') && text.lines().all(|line| line.split(',').count() == 2), "{text}");
    assert_eq!(text.lines().count(), 2 + hundredths, "{text}");
}

fn says(text: &str, words: &[&str]) {
    assert!(words.iter().all(|word| text.contains(word)), "{text}: expected {words:?}");
}

#[test]
fn an_fmu_that_behaves_runs_to_its_end() {
    let folder = folder();
    make(folder.path(), "NOWHERE", "");
    let (status, text) = run(folder.path(), "", &["--quiet"]);
    assert!(status.success(), "{text}");
    recorded(folder.path(), 10);
    assert!(folder.path().join("out/report.html").is_file());
    assert_eq!(std::fs::read_dir(folder.path().join("temporary")).unwrap().count(), 0);
}

#[test]
fn exit_within_an_fmu_is_a_failure() {
    let folder = folder();
    make(folder.path(), "IN_STEP", "exit(0)");
    let (status, text) = run(folder.path(), "", &["--quiet"]);
    assert_eq!(status.code(), Some(1), "{text}");
    says(&text, &["error: clock: called exit in fmi2DoStep at t = 0.050000 s"]);
    recorded(folder.path(), 5);
    says(&std::fs::read_to_string(folder.path().join("out/log.txt")).unwrap(), &["called exit"]);
    let (_, text) = run(folder.path(), "", &["--log", "json"]);
    let last: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    assert_eq!((&last["event"], &last["status"]), (&"end".into(), &"failed".into()));
    says(last["error"].as_str().unwrap(), &["clock: called exit in fmi2DoStep"]);
}

#[test]
fn a_crash_is_told_before_the_process_ends() {
    for (fault, signal, name) in [("*(volatile int *)8 = 1", 11, "SIGSEGV"), ("abort()", 6, "SIGABRT")] {
        let folder = folder();
        make(folder.path(), "IN_STEP", fault);
        let (status, text) = run(folder.path(), "", &["--quiet"]);
        assert_eq!(status.signal(), Some(signal), "{text}");
        says(&text, &[&format!("error: clock: crashed ({name}) in fmi2DoStep at t = 0.050000 s"), "tables hold"]);
        recorded(folder.path(), 5);
        assert_eq!(std::fs::read_dir(folder.path().join("temporary")).unwrap().count(), 1, "nobody cleared up");
        // The next start does, and says that the run before was cut off.
        make(folder.path(), "NOWHERE", "");
        let (status, text) = run(folder.path(), "", &["--quiet"]);
        assert!(status.success(), "{text}");
        says(&text, &["the run before in this folder (process ", "was cut off"]);
        assert_eq!(std::fs::read_dir(folder.path().join("temporary")).unwrap().count(), 0);
    }
}

#[test]
fn a_crash_when_it_is_freed_costs_nothing_that_was_computed() {
    let folder = folder();
    make(folder.path(), "IN_FREE", "abort()");
    let (status, text) = run(folder.path(), "", &["--quiet"]);
    assert_eq!(status.signal(), Some(6), "{text}");
    says(&text, &["error: clock: crashed (SIGABRT) in fmi2FreeInstance at t = 0.100000 s"]);
    recorded(folder.path(), 10);
    let out = folder.path().join("out");
    assert!(std::fs::read_to_string(out.join("report.html")).unwrap().ends_with("</html>"));
    says(&std::fs::read_to_string(out.join("summary.json")).unwrap(), &["\"status\": \"complete\""]);
    says(&std::fs::read_to_string(out.join("run.json")).unwrap(), &["\"ended\""]);
}

#[test]
fn a_step_that_hangs_is_ended_after_its_limit() {
    let folder = folder();
    make(folder.path(), "IN_STEP", "for (;;) pause()");
    let begin = std::time::Instant::now();
    let (status, text) = run(folder.path(), "[limits]\nstep_limit_seconds = 1.0", &["--quiet"]);
    assert_eq!(status.code(), Some(1), "{text}");
    assert!((1.0..30.0).contains(&begin.elapsed().as_secs_f64()), "{:?}", begin.elapsed());
    says(&text, &["clock: did not return within limits.step_limit_seconds = 1 s in fmi2DoStep at t = 0.050000 s"]);
    recorded(folder.path(), 5);
}
