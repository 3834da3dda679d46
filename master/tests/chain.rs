//! The whole chain: FMUs packed from the libraries of this build, run by the library and by the program.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use components::{FluidComponent, Interface, StructureComponent};
use coupling::participant::Participant;
use plimsoll::direct::DirectParticipant;
use plimsoll::fmu::FmuParticipant;
use plimsoll::folder::{RunFolder, Wish};
use plimsoll::job::{Job, ReportMetadata};
use plimsoll::log::Log;
use plimsoll::progress::{Progress, Style};
use plimsoll::record::Status;
use plimsoll::scene_case::{self, Places};
use scene::Scene;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// A column of water that falls against an elastic plate, coarse and short; the plate touches the water at once.
const SCENE: &str = "title = 'small dam'\n[run]\nend = 0.02\ncommunication_step = 0.0005\n[output]\ninterval = 0.01\n\
    [fluid]\nspacing = 0.01\nwater = [{ polygon = [[0,0],[0.1,0],[0.1,0.2],[0,0.2]] }]\n\
    wall = [{ points = [[0,0.5],[0,0],[0.4,0],[0.4,0.5]] }]\n\
    probe = [{ name = 'foot', point = [0.05, 0.01] }]\n\
    [[body]]\nname = 'base'\n[[body.member]]\nname = 'plate'\nsupport = 'clamped_free'\nmiddle = [0.106, 0.05]\nlength = 0.1\nthickness = 0.012\n\
    density = 2500.0\nyoungs_modulus = 1e6\nmodes = 2\n\
    [[check]]\nname = 'tip'\nkind = 'series_maximum'\nvariable = 'structure.body.base.plate.deflection.tip'\nunit = 'm'\n";

fn job(folder: &Path, name: &str) -> Job {
    let path = folder.join("small.toml");
    std::fs::write(&path, SCENE).unwrap();
    let scene = Scene::from_file(&path).unwrap();
    let out = folder.join(name);
    let places = Places { scene: path, fmus: folder.join("fmus"), frames: out.join("frames") };
    let case = scene_case::case(&scene, &[], Some(1), &places);
    Job {
        name: "small".into(),
        case,
        folder: out,
        references: folder.to_path_buf(),
        metadata: ReportMetadata::of(&scene),
        inputs: String::new(),
        parquet: false,
        warnings: Vec::new(),
    }
}

fn execute(job: &Job, participants: Vec<Box<dyn Participant>>) -> String {
    let folder = RunFolder::open(&job.folder).unwrap();
    assert!(job.take_folder(&folder, Wish::default()).unwrap().is_none());
    let mut progress = Progress::new(0.0, 1.0, Style::Quiet);
    let (summary, _) = job.execute(participants, None, &AtomicBool::new(false), &mut progress).unwrap();
    assert_eq!((summary.status, summary.error), (Status::Complete, None));
    assert!(summary.coupling.mean_iterations > 1.5, "{:?}", summary.coupling);
    assert!(summary.checks["tip"].value.unwrap().abs() > 0.0);
    std::fs::read_to_string(job.folder.join("results.csv")).unwrap()
}

#[test]
fn fmus_and_components_in_process_give_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let (job, other) = (job(folder.path(), "fmus-run"), job(folder.path(), "in-process"));
    let interface = Interface::of(&Scene::from_str(SCENE, "small.toml").unwrap());
    plimsoll::pack::pack_interface(&folder.path().join("fmus"), &interface).unwrap();
    let log = Log::default();
    let fmus = job
        .case
        .fmu
        .iter()
        .map(|fmu| -> Box<dyn Participant> { Box::new(FmuParticipant::load(&fmu.path, &fmu.name, &log).unwrap()) });
    let through_the_abi = execute(&job, fmus.collect());
    let direct: Vec<Box<dyn Participant>> = vec![
        Box::new(DirectParticipant::<StructureComponent>::new("structure", &interface, &log).unwrap()),
        Box::new(DirectParticipant::<FluidComponent>::new("fluid", &interface, &log).unwrap()),
    ];
    let in_process = execute(&other, direct);
    assert!(through_the_abi == in_process);
    assert_eq!(in_process.lines().count(), 1 + 41);
    assert!(in_process.lines().next().unwrap().contains("structure.body.base.plate.deflection.tip [m]"));
    for picture in ["field.png", "field.svg", "iterations.png", "structure-body-base-plate-deflection-m.png"] {
        assert!(job.folder.join("plots").join(picture).is_file(), "{picture}");
    }
    assert!(std::fs::read_to_string(job.folder.join("summary.md")).unwrap().contains("![field](plots/field.png)"));
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_plimsoll"))
}

fn write_scene(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("small.toml");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn programs_that_pack_into_one_folder_at_once_do_not_disturb_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let fmus = folder.path().join("fmus");
    let pack = || program().arg("pack").arg("--out").arg(&fmus).stdout(Stdio::null()).spawn().unwrap();
    let mut children: Vec<_> = (0..4).map(|_| pack()).collect();
    assert!(children.iter_mut().all(|child| child.wait().unwrap().success()));
    let mut names: Vec<_> = std::fs::read_dir(&fmus).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["fluid.fmu", "structure.fmu"], "whole archives and nothing else");
}

#[test]
fn an_interrupted_run_leaves_whole_files() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), &SCENE.replace("end = 0.02", "end = 1000.0"));
    let out = folder.path().join("out");
    let mut child = program().arg("run").arg(&scene).arg("--out").arg(&out).stderr(Stdio::null()).spawn().unwrap();
    let results = out.join("results.csv");
    let begin = Instant::now();
    while std::fs::read_to_string(&results).unwrap_or_default().lines().count() < 5 {
        assert!(begin.elapsed() < Duration::from_secs(120), "no results within two minutes");
        std::thread::sleep(Duration::from_millis(50));
    }
    // The shell's own kill: a minimal system has no other.
    assert!(Command::new("sh").arg("-c").arg(format!("kill -INT {}", child.id())).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let text = std::fs::read_to_string(&results).unwrap();
    let columns = text.lines().next().unwrap().split(',').count();
    assert!(text.ends_with('\n') && text.lines().all(|line| line.split(',').count() == columns));
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["status"], "interrupted");
    assert!(out.join("frames/particles.pvd").is_file() && out.join("plots/field.png").is_file());
}

#[test]
fn wrong_input_ends_with_a_message_and_code_one() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str, arguments: &[&str]| {
        let scene = write_scene(folder.path(), text);
        let out = folder.path().join("out");
        let output = program().arg("run").arg(scene).arg("--out").arg(out).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8(output.stderr).unwrap()
    };
    let unknown = refused(&SCENE.replace("spacing", "spacin"), &[]);
    assert!(unknown.contains("small.toml, line 8") && unknown.contains("`spacing`"), "{unknown}");
    let range = refused(SCENE, &["--set", "fluid.spacing=-1"]);
    assert!(range.contains("fluid.spacing = -1"), "{range}");
    let method = refused(SCENE, &["--set", "coupling.methd=aitken"]);
    assert!(method.contains("`method`"), "{method}");
    let absent = program().args(["run", "no_such_scene"]).output().unwrap();
    assert!(String::from_utf8(absent.stderr).unwrap().contains("neither a file nor a scene"));
}

#[test]
fn a_run_that_cannot_converge_is_refused_with_numbers_and_keeps_its_results() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let out = folder.path().join("out");
    let settings =
        ["coupling.maximum_iterations=2", "coupling.tolerance_relative=0", "coupling.tolerance_absolute=1e-300"];
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let output = program().arg("run").arg(scene).arg("--out").arg(&out).args(settings).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("step refused at t = ") && message.contains("fluid.body.base.plate.load.q1 residual"),
        "{message}"
    );
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    assert!(summary.contains("\"status\": \"failed\"") && summary.contains("step refused"));
    assert!(std::fs::read_to_string(out.join("results.csv")).unwrap().lines().count() >= 2);
}
