//! The program with input that cannot be used: a message that says what and where, exit code 1, no crash.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::Command;

const CASE: &str = "[run]\nend = 0.02\ncommunication_step = 0.01\n\
    [[fmu]]\nname = 'tank'\npath = 'FMU'\nparameters = { scene = 'hydrostatic', particle_spacing = 0.1 }\n";

/// Standard error of a run that ends with code 1.
fn refused(arguments: &[&str]) -> String {
    let program = env!("CARGO_BIN_EXE_plimsoll");
    let output = Command::new(program).args(arguments).current_dir(root()).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert!(message.contains("error: ") && !message.contains("panicked"), "{arguments:?}: {message}");
    message
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn says(message: &str, words: &[&str]) {
    assert!(words.iter().all(|word| message.contains(word)), "{message}: expected {words:?}");
}

/// Runs a case with these changes in a folder of its own; `prepare` puts files there.
fn case(changes: &[(&str, &str)], prepare: impl Fn(&Path)) -> String {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let text = changes.iter().fold(CASE.to_string(), |text, (from, to)| text.replace(from, to));
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).unwrap();
    let out = folder.path().join("out");
    refused(&["run", path.to_str().unwrap(), "--out", out.to_str().unwrap()])
}

fn pack(folder: &Path) {
    plimsoll::pack::pack(folder, 3).unwrap();
}

#[test]
fn scenes_and_files_that_are_not_there() {
    let message = refused(&["run", "dam_break_plat"]);
    says(
        &message,
        &["'dam_break_plat' is neither a file nor a scene", "hydrostatic", "did you mean 'dam_break_plate'"],
    );
    says(&refused(&["run", "nosuch"]), &["'nosuch'", "dam_break_front, dam_break_impact"]);
    says(&refused(&["run", "/no/such/scene.toml"]), &["'/no/such/scene.toml' is neither a file"]);
    let many = "fluid.probe=[{ name = \"p\", from = [0.0, 0.0], to = [0.0, 0.2], count = 17 }]";
    says(&refused(&["check", "hydrostatic", "--set", many]), &["17", "16", "fluid.probe"]);
    says(&refused(&["check", "scenes/hydrostatc"]), &["scenes/hydrostatc", "did you mean"]);
    says(&refused(&["run", "LICENSE-MIT"]), &["LICENSE-MIT, line 1"]);
    says(&refused(&["check", "hydrostatic", "--set", "fluid.spacing"]), &["'fluid.spacing'", "key.path=value"]);
    says(&refused(&["pack", "--modes", "9"]), &["--modes 9", "0 to 8"]);
}

#[test]
fn geometry_that_cannot_be_is_refused_by_the_fmu_and_passed_on() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let outside = "structure.beam.middle=[0.7,0.04]";
    let message = refused(&["run", "dam_break_plate", "--out", out.to_str().unwrap(), "--set", outside]);
    says(&message, &["fluid", "fmi2EnterInitializationMode", "the body's surface at (0.69", "outside the tank"]);
    assert!(!out.join("summary.json").exists(), "nothing ran");
}

#[test]
fn files_that_are_no_fmu() {
    let name = |name: &'static str| [("FMU", name)];
    says(&case(&name("missing.fmu"), |_| {}), &["missing.fmu: cannot unpack the FMU", "No such file"]);
    let text = case(&name("text.fmu"), |folder| std::fs::write(folder.join("text.fmu"), "not a zip").unwrap());
    says(&text, &["text.fmu: cannot unpack the FMU", "rchive"]);
    let empty = case(&name("empty.fmu"), |folder| std::fs::write(folder.join("empty.fmu"), "").unwrap());
    says(&empty, &["empty.fmu: cannot unpack the FMU"]);
    says(&case(&name("."), |_| {}), &["cannot unpack the FMU"]);
    for share in [2, 100] {
        let cut = case(&name("fluid.fmu"), |folder| {
            pack(folder);
            let path = folder.join("fluid.fmu");
            let content = std::fs::read(&path).unwrap();
            std::fs::write(&path, &content[..content.len() - content.len() / share]).unwrap();
        });
        says(&cut, &["fluid.fmu: cannot unpack the FMU"]);
    }
}

/// Writes an archive with these entries.
fn archive(path: &Path, entries: &[(&str, &str)]) {
    let mut archive = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    for (name, content) in entries {
        archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut archive, content.as_bytes()).unwrap();
    }
    archive.finish().unwrap();
}

#[test]
fn archives_without_what_an_fmu_needs() {
    let with = |entries: &[(&str, &str)]| case(&[("FMU", "a.fmu")], |folder| archive(&folder.join("a.fmu"), entries));
    says(&with(&[("readme", "")]), &["a.fmu: modelDescription.xml", "No such file"]);
    says(&with(&[("modelDescription.xml", "<fmi")]), &["a.fmu: modelDescription.xml"]);
    let description = std::fs::read_to_string(root().join("modelDescription/fluid.xml")).unwrap();
    let plain = ("modelDescription.xml", description.as_str());
    says(&with(&[plain]), &["a.fmu: no binary for", "binaries/"]);
    let binary = format!("binaries/{}/fluid.{}", plimsoll::fmu::PLATFORM, std::env::consts::DLL_EXTENSION);
    says(&with(&[plain, (&binary, "no library")]), &["a.fmu"]);
}

#[test]
fn cases_that_do_not_fit_their_fmu() {
    let with = |from: &str, to: &str| case(&[("FMU", "fluid.fmu"), (from, to)], pack);
    says(&with("particle_spacing", "particle_spacin"), &["particle_spacin", "'particle_spacing'"]);
    says(&with("= 0.1", "= -0.1"), &["particle_spacing", "-0.1"]);
    says(&with("= 0.1", "= 'wide'"), &["particle_spacing", "wide"]);
    says(&with("= 0.1", "= nan"), &["particle_spacing", "NaN"]);
    says(&with("'hydrostatic'", "'hydrostati'"), &["hydrostati", "hydrostatic"]);
    let unknown = "[coupling]\nmaximum_iterations = 0\n[[fmu]]";
    says(&with("[[fmu]]", unknown), &["coupling.maximum_iterations = 0", "from 1 to 10000"]);
    says(&with("end = 0.02", "end = -1"), &["run.end = -1"]);
    says(&with("end = 0.02", "end = inf"), &["run.end = inf"]);
}

/// A step that the fluid discards cannot be repeated shorter with a single FMU: the run ends, what it has stays.
#[test]
fn a_step_that_is_discarded_ends_the_run_as_failed() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let solve = "fluid.spacing=0.1; fluid.solve.maximum_iterations=1; fluid.solve.tolerance=1e-15";
    let message = refused(&["run", "hydrostatic", "--out", out.to_str().unwrap(), "--set", solve]);
    says(&message, &["step refused at t = 0 s", "pressure solve", "after 1 iterations", "1e-15"]);
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    says(&summary, &["\"status\": \"failed\"", "after 1 iterations", "\"particles lost\""]);
    let results = std::fs::read_to_string(out.join("results.csv")).unwrap();
    assert_eq!(results.lines().count(), 2, "names and the start: {results}");
}
