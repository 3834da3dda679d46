//! What the program says where something cannot be: file, line and key, six digits, no words of the program's own types;
//! and `check` says it as `run` does.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use std::path::Path;
use std::process::{Command, Output};

const SCENE: &str = r#"title = "base"
[run]
end = 0.004
communication_step = 0.002
[fluid]
spacing = 0.02
water = [{ polygon = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.25], [0.0, 0.25]] }]
wall = [{ points = [[0.0, 0.8], [0.0, 0.0], [1.0, 0.0], [1.0, 0.8]] }]
probe = [{ name = "p", point = [0.999, 0.01] }]
gauge = [{ name = "g", x = 0.5 }]
[[body]]
name = "base"
[[body.member]]
name = "plate"
support = "clamped_free"
middle = [0.6, 0.06]
length = 0.12
thickness = 0.024
density = 1200.0
youngs_modulus = 2.0e5
modes = 2
[[check]]
name = "c"
kind = "series_maximum"
variable = "fluid.front.x"
"#;

const CASE: &str = "[run]\nend = 0.02\ncommunication_step = 0.01\n[[fmu]]\nname = 'tank'\npath = 'fluid.fmu'\n\
    [fmu.parameters]\nscene = 'dam_break_plate'\nparticle_spacing = 0.03\n[[fmu]]\nname = 'plate'\npath = 'structure.fmu'\n\
    [[connection]]\nfrom = 'tank.body.base.load.fx'\nto = 'plate.body.base.load.fx'\n";

/// Words that only a programmer knows, or none at all.
const FOREIGN: [&str; 18] = [
    "f64", "f32", "usize", "i32", "i64", "u32", "u64", "struct ", "enum ", "newtype", "sequence", "Vec", "Some(",
    "Err(", "Option", "unwrap", "panicked", "variant",
];

fn plimsoll(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_plimsoll")).args(arguments).current_dir(folder).output().unwrap()
}

/// Standard error of a command that ends with code 1, after a look at its words and numbers.
fn refused(arguments: &[&str], folder: &Path) -> String {
    let output = plimsoll(arguments, folder);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    is_plain(&message);
    message
}

/// No foreign words, no number of more than seven digits, no error of the system without what was being done.
fn is_plain(message: &str) {
    for word in FOREIGN {
        assert!(!message.contains(word), "'{word}' in: {message}");
    }
    let numbers = message.split(|letter: char| !(letter.is_ascii_digit() || letter == '.'));
    for number in numbers {
        let digits = number.trim_start_matches(['0', '.']).chars().filter(char::is_ascii_digit).count();
        assert!(digits <= 7, "'{number}' in: {message}");
    }
    for line in message.lines().filter(|line| line.contains("os error")) {
        assert!(line.contains('.') && line.contains("cannot"), "no file, or not what was being done: {line}");
    }
}

/// The last line that begins with `error: `.
fn error_of(message: &str) -> &str {
    message.lines().rfind(|line| line.starts_with("error: ")).unwrap_or_else(|| panic!("no error in: {message}"))
}

#[test]
fn what_a_scene_cannot_be_has_file_line_and_key() {
    // What is replaced, by what, and the key; the line is the last one of what is put there.
    let changes: [(&str, &str, &str); 24] = [
        ("spacing = 0.02", "spacing = 'wide'", "fluid.spacing: got the text \"wide\", expected a number"),
        ("spacing = 0.02", "spacing = -0.019999999999999962", "fluid.spacing = -0.02: expected"),
        ("spacing = 0.02", "spacing = -1e300", "fluid.spacing = -1e300: expected"),
        ("spacing = 0.02", "spacing = nan", "fluid.spacing = NaN"),
        ("spacing = 0.02", "spacing = 1.2345678901234e-7", "fluid.spacing = 1.23457e-7: expected at least"),
        (
            "spacing = 0.02",
            "spacing = 0.02\nthreads = -1",
            "fluid.threads: got -1, expected a whole number of at least 0",
        ),
        ("spacing = 0.02", "spacing = 0.02\ndensty = 3.0", "did you mean `density`?"),
        ("spacing = 0.02", "spacing = = 2", "line 6"),
        ("end = 0.004", "end = -1e300", "run.end = -1e300: expected a finite number above the start, 0 s"),
        ("end = 0.004", "end = true", "run.end: got true, expected a number"),
        ("communication_step = 0.002", "communication_step = 0.012345678901", "run.communication_step = 0.0123457"),
        ("title = \"base\"", "title = 3", "title: got 3, expected a text"),
        ("gauge = [{ name = \"g\", x = 0.5 }]", "gauge = [{ name = \"g\" }]", "fluid.gauge[0]: missing key `x`"),
        ("gauge = [{ name = \"g\", x = 0.5 }]", "gauge = 7", "fluid.gauge: got 7, expected a list"),
        ("gauge = [{ name = \"g\", x = 0.5 }]", "gauge = [{ name = \"g\", x = inf }]", "fluid.gauge[0].x = inf"),
        ("point = [0.999, 0.01]", "point = [0.999]", "fluid.probe[0].point: got a list of 1, expected a list of 2"),
        ("wall = [{ points", "walls = [{ points", "unknown key `walls`"),
        ("support = \"clamped_free\"", "support = \"clamped\"", "body[0].member[0].support: unknown word `clamped`"),
        ("thickness = 0.024", "thickness = 0.12", "body[0].member[0].thickness = 0.12: expected less than the length"),
        ("modes = 2", "modes = 1.5", "body[0].member[0].modes: got 1.5, expected a whole number"),
        ("modes = 2", "modes = 2\ndamping = [2.3456789012]", "body[0].member[0].damping[0] = 2.34568"),
        ("modes = 2", "modes = 2\ndamping = [0.0, 0.0, 0.0]", "length of body[0].member[0].damping = 3"),
        ("kind = \"series_maximum\"", "kind = \"maximum\"", "check[0].kind: unknown word `maximum`"),
        ("kind = \"series_maximum\"", "kind = \"series_maximum\"\nlimit = -1", "check[0].limit = -1"),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (from, to, words) in changes {
        assert!(SCENE.contains(from), "{from}");
        let text = SCENE.replacen(from, to, 1);
        std::fs::write(folder.path().join("scene.toml"), &text).unwrap();
        let line = text[..text.find(to).unwrap() + to.len()].lines().count();
        let checked = refused(&["check", "scene.toml"], folder.path());
        assert!(
            checked.contains(&format!("scene.toml, line {line}: ")) || words == "line 6",
            "{to}, line {line}: {checked}"
        );
        assert!(checked.contains(words), "{to}: {checked}");
        let run = refused(&["run", "scene.toml", "--out", "out"], folder.path());
        assert_eq!(error_of(&checked), error_of(&run));
    }
}

#[test]
fn changes_on_the_command_line_are_quoted_and_have_no_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let said = |set: &str| refused(&["check", "scene.toml", "--set", set], folder.path());
    let range = said("fluid.spacing=-0.019999999999999962");
    assert!(range.contains("scene.toml: fluid.spacing = -0.02: expected"), "{range}");
    let kind = said("fluid.wall.0.points=3");
    assert!(kind.contains("'fluid.wall.0.points=3': fluid.wall[0].points: got 3, expected a list"), "{kind}");
}

#[test]
fn a_set_up_that_cannot_be_is_refused_by_check_as_by_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    for set in [
        "fluid.water.0.polygon=[[0.7,0.1],[1.51,0.1],[1.51,0.4],[0.7,0.4]]",
        "body.0.member.0.middle=[1.4,0.06]",
        "fluid.wall.0.points=[[0.0,0.8],[0.0,0.0],[1.0,0.0],[1.0000000001,0.0],[1.0,0.8]]",
        "gravity=[1.0000000001,-9.81]",
        "body.0.wall=[{points=[[0.1,0.3],[0.1,0.3],[0.2,0.3]]}]",
    ] {
        let checked = refused(&["check", "scene.toml", "--set", set], folder.path());
        let run = refused(&["run", "scene.toml", "--out", "out", "--set", set], folder.path());
        assert_eq!(error_of(&checked), error_of(&run));
        assert!(checked.contains("scene.toml"), "{checked}");
    }
}

#[test]
fn a_case_is_checked_down_to_its_fmus() {
    let folder = tempfile::tempdir().unwrap();
    plimsoll::pack::pack(folder.path()).unwrap();
    let changes: [(&str, &str, &str); 11] = [
        (
            "particle_spacing = 0.03",
            "particle_spacin = 0.03",
            "fmu.0.parameters.particle_spacin: tank: there is no variable",
        ),
        ("particle_spacing = 0.03", "particle_spacing = 'wide'", "takes a number, got 'wide'"),
        ("particle_spacing = 0.03", "particle_spacing = -0.019999999999999962", "= -0.02: expected at least 0, as its"),
        ("particle_spacing = 0.03", "threads = 5000", "= 5000: expected 0 to 1024, as its description declares"),
        (
            "from = 'tank.body.base.load.fx'",
            "from = 'tank.body.base.load.f'",
            "connection.0: tank: there is no variable 'body.base.load.f'",
        ),
        (
            "from = 'tank.body.base.load.fx'",
            "from = 'tan.body.base.load.fx'",
            "there is no participant 'tan'; known: tank, plate",
        ),
        ("from = 'tank.body.base.load.fx'", "from = 'tank.body.base.load.mz'", "the units differ"),
        ("from = 'tank.body.base.load.fx'", "from = 'tank.particles.count'", "expected the role 'output' and a number"),
        ("to = 'plate.body.base.load.fx'", "to = 'plate.body.base.motion.x'", "expected the role 'input'"),
        ("scene = 'dam_break_plate'", "scene = 'dam_break_plat'", "'dam_break_plat' not found"),
        ("path = 'fluid.fmu'", "path = 'none.fmu'", "none.fmu: cannot unpack the FMU: it cannot be opened"),
    ];
    for (from, to, words) in changes {
        assert!(CASE.contains(from), "{from}");
        std::fs::write(folder.path().join("case.toml"), CASE.replacen(from, to, 1)).unwrap();
        let checked = refused(&["check", "case.toml"], folder.path());
        let run = refused(&["run", "case.toml", "--out", "out"], folder.path());
        assert!(checked.contains(words), "{to}: {checked}");
        // The folder that an FMU is unpacked in has another name each time.
        let until = |message: &str| error_of(message).split("packed in").next().map(str::to_string);
        assert_eq!(until(&checked), until(&run));
        if from.starts_with("particle") {
            assert!(checked.contains("case.toml, line 9: fmu.0.parameters."), "{checked}");
        }
    }
    std::fs::write(folder.path().join("case.toml"), CASE).unwrap();
    let good = plimsoll(&["check", "case.toml"], folder.path());
    assert!(good.status.success(), "{}", String::from_utf8_lossy(&good.stderr));
}

#[test]
fn check_warns_of_what_run_warns_of() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let warnings = |output: Output| -> Vec<String> {
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{text}");
        is_plain(&text);
        text.lines().filter(|line| line.starts_with("warning: ")).map(str::to_string).collect()
    };
    for (set, words) in [
        ("body.0.member.0.middle=[0.6,0.36]", "clamped end at [0.6, 0.3] m touches no wall"),
        ("check.0.variable=fluid.front.y", "this run has no variable 'fluid.front.y'"),
        ("check.0.kind=arrival_time", "check 'c': needs `level`"),
        (
            "check.0={name=\"c\",kind=\"curve_rms\",variable=\"fluid.front.x\",file=\"nosuch.csv\"}",
            "`columns` has 0 names",
        ),
        (
            "check.0={name=\"c\",kind=\"curve_rms\",variable=\"fluid.front.x\",file=\"nosuch.csv\",columns=[\"t\",\"x\"]}",
            "nosuch.csv: the reference cannot be read",
        ),
    ] {
        let checked = warnings(plimsoll(&["check", "scene.toml", "--no-estimate", "--set", set], folder.path()));
        let run = warnings(plimsoll(
            &["run", "scene.toml", "--quiet", "--overwrite", "--out", "out", "--set", set],
            folder.path(),
        ));
        assert_eq!(checked, run, "{set}");
        assert!(checked.len() == 1 && checked[0].contains(words), "{set}: {checked:?}");
    }
}

#[test]
fn a_deflection_beyond_its_limit_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    // eta = phi q is positive along -x of the body, the outputs along +x.
    let bent = "body.0.member.0.initial_modes=[0.01]; body.0.member.0.deflection_limit=0.001";
    let message = refused(&["run", "scene.toml", "--quiet", "--out", "out", "--set", bent], folder.path());
    assert_eq!(message.matches("beam deflects by -").count(), 1, "{message}");
    assert_eq!(message.matches("beyond -0.00012 m").count(), 1, "{message}");
}

#[test]
fn new_makes_its_folder_and_quotes_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let output = plimsoll(&["new", "my scenes/tank v1.2"], folder.path());
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && folder.path().join("my scenes/tank v1.2.toml").is_file(), "{said}");
    assert!(
        said.contains("plimsoll check 'my scenes/tank v1.2.toml'; plimsoll run 'my scenes/tank v1.2.toml'"),
        "{said}"
    );
}

#[test]
fn packages_and_other_files_get_a_fitting_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["x.ssp", "x.fmu"] {
        std::fs::write(folder.path().join(name), b"PK\x03\x04\xff\xfe").unwrap();
        let message = refused(&["run", name], folder.path());
        assert!(message.contains(&format!("cannot read {name}: an archive and no scene or case")), "{message}");
    }
    std::fs::write(folder.path().join("x.bin"), b"\xff\xfe\x00").unwrap();
    assert!(
        refused(&["run", "x.bin"], folder.path()).contains("cannot read x.bin: it is no text in UTF-8 from byte 0 on")
    );
    let inline = "fmu = [{ name = 'a', path = 'none.fmu' }]\n[run]\nend = 1.0\ncommunication_step = 0.1\n";
    std::fs::write(folder.path().join("inline.toml"), inline).unwrap();
    assert!(refused(&["run", "inline.toml"], folder.path()).contains("none.fmu: cannot unpack the FMU"));
}
