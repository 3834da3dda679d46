//! The program with input that cannot be used: a message that says what and where, exit code 1, no crash.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::Command;

const CASE: &str = "[run]\nend = 0.02\ncommunication_step = 0.01\n\
    [[fmu]]\nname = 'tank'\npath = 'FMU'\nparameters = { scene = 'dam_break_plate', particle_spacing = 0.03 }\n";

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
    plimsoll::pack::pack(folder).unwrap();
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
    let many = "fluid.probe=[{ name = \"p\", from = [0.0, 0.0], to = [0.0, 0.2], count = 1001 }]";
    says(&refused(&["check", "hydrostatic", "--set", many]), &["fluid.probe[0].count = 1001", "1 to 1000"]);
    says(&refused(&["check", "scenes/hydrostatc"]), &["scenes/hydrostatc", "did you mean"]);
    says(&refused(&["run", "LICENSE-MIT"]), &["LICENSE-MIT, line 1"]);
    says(&refused(&["check", "hydrostatic", "--set", "fluid.spacing"]), &["'fluid.spacing'", "key.path=value"]);
    says(&refused(&["pack", "nosuch"]), &["'nosuch' is neither a file nor a scene"]);
    says(&refused(&["pack", "--set", "fluid.spacing=0.1"]), &["--set changes a scene, and none is given"]);
}

#[test]
fn geometry_that_cannot_be_is_refused_by_the_fmu_and_passed_on() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let outside = "body.0.member.0.middle=[0.7,0.04]";
    let message = refused(&["run", "dam_break_plate", "--out", out.to_str().unwrap(), "--set", outside]);
    says(&message, &["fluid", "fmi2EnterInitializationMode", "the body's surface at (0.69", "outside the tank"]);
    assert!(!out.join("summary.json").exists(), "nothing ran");
}

#[test]
fn files_that_are_no_fmu() {
    let name = |name: &'static str| [("FMU", name)];
    says(&case(&name("missing.fmu"), |_| {}), &["missing.fmu: cannot unpack the FMU", "no such file"]);
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
    let description = std::fs::read_to_string(root().join("modelDescription/dam_break_plate/fluid.xml")).unwrap();
    let plain = ("modelDescription.xml", description.as_str());
    says(&with(&[plain]), &["a.fmu: no binary for", "binaries/"]);
    let binary = format!("binaries/{}/fluid.{}", plimsoll::fmu::PLATFORM, std::env::consts::DLL_EXTENSION);
    says(&with(&[plain, (&binary, "no library")]), &["a.fmu"]);
}

#[test]
fn cases_that_do_not_fit_their_fmu() {
    let with = |from: &str, to: &str| case(&[("FMU", "fluid.fmu"), (from, to)], pack);
    says(&with("particle_spacing", "particle_spacin"), &["particle_spacin", "'particle_spacing'"]);
    says(&with("= 0.03", "= -0.03"), &["particle_spacing", "-0.03"]);
    says(&with("= 0.03", "= 'wide'"), &["particle_spacing", "wide"]);
    // A whole number of any length is a number: it reaches the scene's own check.
    says(&with("= 0.03", "= 210000000000"), &["fmi2EnterInitializationMode", "0.1 spacings = 21000000000 m"]);
    says(
        &with("particle_spacing = 0.03", "threads = 210000000000"),
        &["'threads' takes a whole number below 2^31", "210000000000"],
    );
    says(&with("= 0.03", "= nan"), &["particle_spacing", "NaN"]);
    says(&with("'dam_break_plate'", "'dam_break_plat'"), &["dam_break_plat", "hydrostatic"]);
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

const TANK: &str = "title = 'tank'\ngravity = [0.0, -9.81]\n[run]\nend = 0.02\ncommunication_step = 0.01\n\
    [output]\ninterval = 0.0\n[fluid]\nspacing = 0.05\nwater = [{ polygon = [[0, 0], [0.3, 0], [0.3, 0.25], [0, 0.25]] }]\n\
    wall = [{ points = [[0, 0.8], [0, 0], [1, 0], [1, 0.8]] }]\nprobe = [{ name = 'p', point = [0.3, 0.01] }]\n\
    gauge = [{ name = 'g', x = 0.5 }]\n[[check]]\nname = 'x'\nkind = 'series_maximum'\nvariable = 'fluid.front.x'\n";

/// Writes the scene with this change into the folder.
fn changed(folder: &Path, from: &str, to: &str) -> String {
    assert!(TANK.contains(from), "{from}");
    let path = folder.join("tank.toml");
    std::fs::write(&path, TANK.replacen(from, to, 1)).unwrap();
    path.to_str().unwrap().to_string()
}

/// What a scene gets wrong is told by `check` and by `run` in the same words.
#[test]
fn scenes_that_cannot_mean_what_they_say_are_refused_by_check_and_run() {
    let walls = "[[0, 0.8], [0, 0], [1, 0], [1, 0.8]]";
    let second = "kind = 'series_maximum'\n[[check]]\nname = 'x'\nkind = 'series_maximum'";
    for (from, to, words) in [
        ("[0.0, -9.81]", "[0.0, 0.0, -9.81]", &["tank.toml, line 2: gravity has 3 entries, expected 2"][..]),
        ("[[0, 0], [0.3", "[[0, 0, 0], [0.3", &["line 10: fluid.water[0].polygon[0] has 3 entries, expected 2"]),
        (
            "spacing =",
            "start = { velocity = [1e300, 0.0] }\nspacing =",
            &["fluid.start.velocity[0] = 1e300", "-100000 to 100000"],
        ),
        ("kind = 'series_maximum'", second, &["check[1].name = 'x'", "check[0] has it too"]),
        ("[0.3, 0.01]", "[0.9, -0.1]", &["fluid.probe[0] 'p' = (0.9, -0.1)", "0.1 m within a solid; move it"]),
        ("[0.3, 0.01]", "[5, 5]", &["fluid.probe[0] 'p' = (5, 5)", "outside of walls, water and structure"]),
        ("x = 0.5", "x = 5", &["fluid.gauge[0] 'g' = 5 m", "it lies 4 m outside"]),
        (
            walls,
            "[[0, 0.8], [0, 0], [1, 0], [0.5, 0], [1, 0], [1, 0.8]]",
            &["fixed wall 0 turns back on itself at (1, 0)"],
        ),
        (walls, "[[0, 0.8], [0, 0], [1, 0], [1, 0.8], [0.5, -0.3]]", &["fixed wall 0 crosses itself at (0.636364, 0)"]),
        ("[0.3, 0.25], [0, 0.25]", "[0, 0.25], [0.4, 0.3]", &["water 0 crosses itself at (0.157895, 0.118421)"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = changed(folder.path(), from, to);
        let out = folder.path().join("out");
        let picture = folder.path().join("picture");
        says(&refused(&["check", &path, "--picture", picture.to_str().unwrap()]), words);
        says(&refused(&["run", &path, "--out", out.to_str().unwrap()]), words);
        assert!(!out.join("summary.json").exists(), "nothing ran: {words:?}");
    }
}

/// A probe that stands a little in the wall does not hinder a run, but is told of.
#[test]
fn doubtful_probes_are_warned_of_by_check_and_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = changed(folder.path(), "[0.3, 0.01]", "[0.3, -0.01]");
    let (out, picture) = (folder.path().join("out"), folder.path().join("picture"));
    let program = env!("CARGO_BIN_EXE_plimsoll");
    for arguments in
        [["check", &path, "--picture", picture.to_str().unwrap()], ["run", &path, "--out", out.to_str().unwrap()]]
    {
        let output = Command::new(program).args(arguments).current_dir(root()).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{arguments:?}: {message}");
        says(&message, &["fluid.probe[0] 'p' at (0.3, -0.01) may read nothing: it lies 0.01 m within a solid"]);
    }
}
