//! A safety net for changes of the house: coarse runs of scenes of every kind whose results keep every bit.
//!
//! `PLIMSOLL_SAFETY_NET=renew cargo test --release -p plimsoll --test safety_net` stores the results anew; the commit that
//! does so says why and by how much they changed. On another kind of machine (processor, system, C library) the numbers
//! must agree to 1e-12 of the largest with the same unit at first, to 1e-6 at the end. That a run that was stopped goes on with the same bits is asked in
//! `resume.rs`.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Agreement on another kind of machine, over the largest number of the columns with the same unit.
/// in the first quarter of a run. Behind it rounding has grown, fastest in a splash: with other elementary functions (the
/// C library's for processors without fused products) to 1e-8 at the end of the plate's run, 1e-11 of the cabin's.
const ELSEWHERE: [f64; 2] = [1e-12, 1e-6];

/// Runs: the name that results are stored under, the scene, and what is set, apart by blanks. Both schemes, no body, bodies
/// held and free, beams, each way of coupling, probes, gauges, regions, forces on the water.
const RUNS: &[[&str; 3]] = &[
    ["dam_break", "dam_break_impact", "fluid.spacing=0.02 run.end=0.6 output.record_interval=0.02"],
    [
        "dam_break_classical",
        "dam_break_impact",
        "fluid.spacing=0.02 run.end=0.4 output.record_interval=0.02 fluid.scheme=mps",
    ],
    ["wave", "standing_wave", "fluid.spacing=0.05 run.end=0.6"],
    ["sloshing", "forced_sloshing", "fluid.spacing=0.05 run.end=0.6"],
    ["drop", "oscillating_drop", "fluid.spacing=0.1 fluid.start.jitter=0.05 run.end=1.0"],
    ["drop_stretched", "stretching_drop", "fluid.spacing=0.1 output.record_interval=4e-4 fluid.start.jitter=0.05"],
    ["plate", "dam_break_plate", "fluid.spacing=0.012 run.end=0.3 output.record_interval=0.01"],
    [
        "plate_classical",
        "dam_break_plate",
        "fluid.spacing=0.012 run.end=0.2 output.record_interval=0.01 fluid.scheme=mps",
    ],
    ["cabin", "damaged_cabin", "fluid.spacing=0.04 run.end=0.3 output.record_interval=0.01"],
    ["cabin_held", "damaged_cabin", "fluid.spacing=0.04 run.end=0.1 body.0.free=[] output.record_interval=0.01"],
    [
        "cabin_rigid",
        "damaged_cabin",
        "fluid.spacing=0.04 run.end=0.2 body.0.member.0.modes=0 output.record_interval=0.01",
    ],
    ["box_rolls", "floating_box_roll_free", "fluid.spacing=0.05 run.end=0.3 output.record_interval=0.01"],
    ["piston_newton", "piston", "fluid.spacing=0.04 run.end=0.4 coupling.method=newton output.record_interval=0.02"],
    ["piston_iqn_ils", "piston", "fluid.spacing=0.04 run.end=0.4 coupling.method=iqn_ils output.record_interval=0.02"],
    [
        "piston_aitken",
        "piston",
        "fluid.spacing=0.04 run.end=0.2 coupling.method=aitken body.0.mass=400.0 output.record_interval=0.02",
    ],
    [
        "piston_constant",
        "piston",
        "fluid.spacing=0.04 run.end=0.2 coupling.method=constant coupling.relaxation=0.5 body.0.mass=400.0 output.record_interval=0.02",
    ],
    [
        "piston_explicit",
        "piston",
        "fluid.spacing=0.04 run.end=0.4 coupling.method=explicit output.record_interval=0.02",
    ],
    ["beam_in_vacuo", "free_decay", "run.end=0.2 output.record_interval=0.01"],
];

fn run([name, scene, set]: &[&str; 3], out: &Path) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_plimsoll"));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    command.args(["run", scene, "--quiet", "--overwrite", "--out"]).arg(out);
    let settings = set.split_whitespace().chain(["output.interval=0", "output.plot=[]", "check=[]"]);
    let output = command.args(settings.flat_map(|change| ["--set", change])).output().unwrap();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    std::fs::read_to_string(out.join("results.csv")).unwrap()
}

fn stored(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/safety_net").join(name)
}

/// What decides about bits: system, the library that has the elementary functions, and the processor's instructions among
/// which that library and the direct solver choose.
fn kind_of_machine() -> String {
    let library = Command::new("ldd").arg("--version").output().ok();
    let library = library.and_then(|said| String::from_utf8_lossy(&said.stdout).lines().next().map(str::to_string));
    format!("{} {} {}{}\n", std::env::consts::ARCH, std::env::consts::OS, library.unwrap_or_default(), instructions())
}

#[cfg(target_arch = "x86_64")]
fn instructions() -> String {
    let has = |name, there| if there { format!(" {name}") } else { String::new() };
    let (vectors, fused) = (is_x86_feature_detected!("avx2"), is_x86_feature_detected!("fma"));
    [has("avx2", vectors), has("fma", fused), has("avx512f", is_x86_feature_detected!("avx512f"))].concat()
}

#[cfg(not(target_arch = "x86_64"))]
fn instructions() -> String {
    String::new()
}

fn table(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default().split(',').collect();
    let number = |text: &str| text.parse().unwrap_or(f64::NAN);
    (header, lines.map(|line| line.split(',').map(number).collect()).collect())
}

/// The largest difference of two tables over the largest number with the same unit, and where it is. A momentum that is
/// zero by symmetry has the scale of the other.
fn difference(was: &str, is: &str) -> Result<(f64, String), String> {
    let ((names, before), (new_names, after)) = (table(was), table(is));
    if names != new_names || before.len() != after.len() {
        return Err(format!(
            "{} columns and {} rows, now {} and {}",
            names.len(),
            before.len(),
            new_names.len(),
            after.len()
        ));
    }
    let unit = |name: &str| name.rsplit_once('[').map_or(String::new(), |(_, unit)| unit.to_string());
    let largest = |name: &str| {
        let alike = (0..names.len()).filter(|&other| unit(names[other]) == unit(name));
        let numbers = alike.flat_map(|other| before.iter().map(move |row| row[other].abs()));
        numbers.fold(f64::MIN_POSITIVE, f64::max)
    };
    let mut worst = (0.0, String::new());
    for (column, name) in names.iter().enumerate() {
        let largest = largest(name);
        for (old, new) in before.iter().zip(&after) {
            let gap = (old[column] - new[column]).abs() / largest;
            if gap > worst.0 || gap.is_nan() && !(old[column].is_nan() && new[column].is_nan()) {
                worst = (gap, format!("{name} at {} s: {} was {}", new[0], new[column], old[column]));
            }
        }
    }
    Ok(worst)
}

/// Whether two tables agree as far as those of two kinds of machines can.
fn agrees(was: &str, is: &str) -> bool {
    let head = |text: &str| {
        let quarter = text.lines().count() / 4 + 1;
        text.lines().take(quarter).map(|line| format!("{line}\n")).collect::<String>()
    };
    let within = |was: &str, is: &str, most: f64| difference(was, is).is_ok_and(|(gap, _)| gap <= most);
    within(&head(was), &head(is), ELSEWHERE[0]) && within(was, is, ELSEWHERE[1])
}

#[test]
fn results_keep_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    let renew = std::env::var("PLIMSOLL_SAFETY_NET").is_ok_and(|value| value == "renew");
    let machine = kind_of_machine();
    let same_kind = std::fs::read_to_string(stored("machine.txt")).is_ok_and(|stored| stored == machine);
    let mut report = String::new();
    for item @ [name, ..] in RUNS {
        let text = run(item, &folder.path().join(name));
        assert!(text.lines().count() > 5, "{name}: {} rows", text.lines().count());
        let path = stored(&format!("{name}.csv"));
        if renew {
            std::fs::write(&path, &text).unwrap();
            continue;
        }
        let was = std::fs::read_to_string(&path).unwrap();
        if was == text {
            continue;
        }
        match difference(&was, &text) {
            Ok(_) if !same_kind && agrees(&was, &text) => {}
            Ok((gap, place)) => writeln!(report, "{name}: {gap:e} of the largest, {place}").unwrap(),
            Err(shape) => writeln!(report, "{name}: {shape}").unwrap(),
        }
    }
    if renew {
        std::fs::write(stored("machine.txt"), machine).unwrap();
    }
    assert!(report.is_empty(), "results that changed:\n{report}");
}

#[test]
fn the_net_sees_the_last_bit() {
    let was = "time [s],a,b\n0,1,-2\n1,0.5,4\n";
    let (gap, place) = difference(was, "time [s],a,b\n0,1,-2\n1,0.5,4.000000000000001\n").unwrap();
    assert!(gap > 0.0 && gap < 1e-15, "{gap}");
    assert!(place.starts_with("b at 1 s"), "{place}");
    assert_eq!(difference(was, was).unwrap().0, 0.0);
    assert!(difference(was, "time [s],a\n0,1\n1,0.5\n").is_err());
    assert!(difference(was, "time [s],a,b\n0,1,-2\n1,NaN,4\n").unwrap().0.is_nan());
}
