//! Life cycle and refusals through the C ABI of both FMUs.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{FluidComponent, LOAD, POSITION, StructureComponent};
use fmi2::ffi::{self, Status, StatusKind};
use plimsoll_tests::{Library, Packed, Slave, library};
use std::ffi::CStr;

const SCENE: u32 = 1;
const OVERRIDES: u32 = 2;
const SPACING: u32 = 3;
const OUTPUT: u32 = 5;
/// Deflection of the tip of the first member.
const TIP: u32 = 9_000_001;

/// An FMU of the scenes of these tests.
fn packed() -> Packed {
    Packed::of(&["hydrostatic", "dam_break_plate", "free_decay"])
}

fn guid<C: fmi::Component<Interface = components::Interface>>() -> String {
    packed().guid::<C>()
}

fn fluid(library: &Library) -> Slave<'_> {
    Slave::new(library, &guid::<FluidComponent>(), Some(&packed().location())).unwrap_or_else(|why| panic!("{why:?}"))
}

fn structure(library: &Library) -> Slave<'_> {
    Slave::new(library, &guid::<StructureComponent>(), Some(&packed().location()))
        .unwrap_or_else(|why| panic!("{why:?}"))
}

/// A tank with 200 particles.
fn tank(library: &Library) -> Slave<'_> {
    let slave = fluid(library);
    assert_eq!(slave.set_text(SCENE, "hydrostatic"), Status::OK);
    assert_eq!(slave.set_text(OVERRIDES, "fluid.spacing = 0.05"), Status::OK);
    slave
}

/// The last message contains every one of the words.
fn says(slave: &Slave, words: &[&str]) {
    let messages = slave.messages();
    let last = messages.last().unwrap_or_else(|| panic!("no message, expected {words:?}"));
    assert!(words.iter().all(|word| last.contains(word)), "{last}: expected {words:?}");
    assert!(last.starts_with("3 logStatusError") || last.starts_with("2 logStatusDiscard"), "{last}");
}

#[test]
fn versions_and_every_function_are_there() {
    for name in ["fluid_fmu", "structure_fmu"] {
        let library = Library::load(name).unwrap();
        // SAFETY: both functions return a constant text.
        unsafe {
            assert_eq!(CStr::from_ptr((library.get_version)()), c"2.0");
            assert_eq!(CStr::from_ptr((library.get_types_platform)()), c"default");
        }
        let output = std::process::Command::new("nm").args(["-D", "--defined-only"]).arg(&library.path).output();
        let text = String::from_utf8(output.unwrap().stdout).unwrap();
        let mut exported: Vec<&str> = text.lines().filter_map(|line| line.split_whitespace().last()).collect();
        let mut expected = library::NAMES.to_vec();
        exported.sort_unstable();
        expected.sort_unstable();
        assert_eq!(exported, expected, "{name} exports fmi2 functions and nothing else");
    }
}

#[test]
fn a_whole_run_of_each() {
    let library = Library::load("fluid_fmu").unwrap();
    let slave = tank(&library);
    assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    for step in 0..5 {
        assert_eq!(slave.step(0.01 * f64::from(step), 0.01), Status::OK, "{:?}", slave.messages());
    }
    assert_eq!(slave.integer(381), 200, "particles");
    assert_eq!(slave.integer(382), 0, "lost");
    // SAFETY: a live handle.
    unsafe {
        assert_eq!((library.terminate)(slave.handle), Status::OK);
        let mass = slave.reals(&[369]);
        assert!(mass[0].is_finite(), "outputs can be read after the end");
        assert_eq!((library.reset)(slave.handle), Status::OK);
    }
    assert_eq!(slave.set_text(SCENE, "hydrostatic"), Status::OK);
    assert_eq!(slave.set_text(OVERRIDES, "fluid.spacing = 0.1"), Status::OK);
    assert_eq!(slave.initialise(1.0), Status::OK, "after a reset everything is possible again");
    assert_eq!(slave.integer(381), 50);
    assert_eq!(slave.step(1.0, 0.01), Status::OK);

    let library = Library::load("structure_fmu").unwrap();
    let slave = structure(&library);
    assert_eq!(slave.set_text(SCENE, "free_decay"), Status::OK);
    assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    let start = slave.reals(&[TIP])[0];
    assert_eq!(slave.step(0.0, 0.001), Status::OK);
    assert!(slave.reals(&[TIP])[0].abs() < start.abs(), "a bent plate springs back");
}

#[test]
fn instantiation_says_why_it_refuses() {
    let library = Library::load("fluid_fmu").unwrap();
    let wrong = "{12345678-0000-0000-0000-000000000000}";
    let messages = Slave::new(&library, wrong, None).err().unwrap();
    assert!(messages[0].contains(wrong) && messages[0].contains("GUID"), "{messages:?}");
    let structure = guid::<StructureComponent>();
    assert!(Slave::new(&library, &structure, None).is_err(), "the other FMU's GUID");
    let messages = Slave::new(&library, &guid::<FluidComponent>(), Some("https://host/resources")).err().unwrap();
    assert!(messages[0].contains("file URI"), "{messages:?}");
    let guid = std::ffi::CString::new(guid::<FluidComponent>()).unwrap();
    // SAFETY: NULL pointers and live strings.
    unsafe {
        let null = std::ptr::null();
        let slave = ffi::Type::CO_SIMULATION;
        assert!((library.instantiate)(null, slave, guid.as_ptr(), null, std::ptr::null(), 0, 0).is_null());
        assert!((library.instantiate)(c"a".as_ptr(), slave, null, null, std::ptr::null(), 0, 0).is_null());
        let exchange = ffi::Type::MODEL_EXCHANGE;
        assert!((library.instantiate)(c"a".as_ptr(), exchange, guid.as_ptr(), null, std::ptr::null(), 0, 0).is_null());
        (library.free_instance)(std::ptr::null_mut());
    }
}

#[test]
fn bad_scenes_are_refused_with_numbers() {
    let library = Library::load("fluid_fmu").unwrap();
    for (scene, overrides, words) in [
        ("no_such_scene", "", &["no_such_scene", "hydrostatic", "dam_break_plate"][..]),
        ("/no/such/file.toml", "", &["/no/such/file.toml"]),
        ("free_decay", "", &["[fluid]"]),
        ("hydrostatic", "fluid.spacing=-1", &["fluid.spacing", "-1"]),
        ("hydrostatic", "fluid.spacin=1", &["did you mean `spacing`"]),
        ("hydrostatic", "fluid.spacing", &["key.path=value"]),
        ("hydrostatic", "fluid.mps.courant=3", &["fluid.mps.courant", "3"]),
        ("hydrostatic", "fluid.spacing=5.0", &["5"]),
        ("dam_break_plate", "body.0.member.0.modes=5", &["body.base.plate.load.q4", "packed for another scene"]),
        ("100%s%n", "", &["100%"]),
    ] {
        let slave = fluid(&library);
        assert_eq!(slave.set_text(SCENE, scene), Status::OK);
        assert_eq!(slave.set_text(OVERRIDES, overrides), Status::OK);
        assert_eq!(slave.enter(0.0), Status::ERROR, "{scene} {overrides}");
        says(&slave, words);
        assert_eq!(slave.step(0.0, 0.01), Status::ERROR);
    }
    let library = Library::load("structure_fmu").unwrap();
    for (scene, words) in [("hydrostatic", &["[[body]]"][..]), ("dam_break_plates", &["dam_break_plate"])] {
        let slave = structure(&library);
        assert_eq!(slave.set_text(SCENE, scene), Status::OK);
        assert_eq!(slave.enter(0.0), Status::ERROR);
        says(&slave, words);
    }
}

#[test]
fn missing_resources_matter_only_when_they_are_needed() {
    let library = Library::load("fluid_fmu").unwrap();
    let generic = Packed::of(&[]).guid::<FluidComponent>();
    let slave = Slave::new(&library, &generic, None).unwrap();
    assert_eq!(slave.set_text(SCENE, "dam_break_front"), Status::OK);
    assert_eq!(slave.enter(0.0), Status::ERROR);
    says(&slave, &["fmuResourceLocation", "path of a scene file"]);
    let path = plimsoll_tests::root().join("scenes/dam_break_plate.toml");
    for scene in ["", path.to_str().unwrap()] {
        let slave = Slave::new(&library, &generic, None).unwrap();
        assert_eq!(slave.set_text(SCENE, scene), Status::OK);
        assert_eq!(slave.set_reals(&[SPACING], &[0.03]), Status::OK);
        assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    }
    // Packed for scenes, and without one of its own in its resources: it does not begin with another one.
    let slave = fluid(&library);
    assert_eq!(slave.enter(0.0), Status::ERROR);
    says(&slave, &["the resources have no scene.toml"]);
    // What it was packed for stands in the resources.
    let messages = Slave::new(&library, &guid::<FluidComponent>(), None).err().unwrap();
    assert!(messages[0].contains("the importer gave no fmuResourceLocation"), "{messages:?}");
}

#[test]
fn values_and_steps_that_cannot_be() {
    let library = Library::load("fluid_fmu").unwrap();
    let slave = tank(&library);
    assert_eq!(slave.set_reals(&[SPACING], &[-0.1]), Status::DISCARD);
    says(&slave, &["particle_spacing", "-0.1", "0"]);
    assert_eq!(slave.initialise(0.0), Status::OK);
    assert_eq!(slave.set_reals(&[SPACING], &[0.1]), Status::ERROR);
    says(&slave, &["particle_spacing", "fixed"]);
    assert_eq!(slave.set_reals(&[4711], &[0.1]), Status::ERROR);
    says(&slave, &["4711"]);
    for step in [-0.01, 0.0, f64::NAN] {
        assert_eq!(slave.step(0.0, step), Status::ERROR);
        says(&slave, &["communication step", "positive"]);
    }
    assert_eq!(slave.step(0.5, 0.01), Status::ERROR);
    says(&slave, &["communication point 0.5", "expected 0 s"]);
    assert_eq!(slave.enter(0.0), Status::ERROR);
    says(&slave, &["fmi2SetupExperiment", "step complete", "instantiated"]);
    assert_eq!(slave.step(0.0, 0.01), Status::OK, "refused calls change nothing: {:?}", slave.messages());
    let state = slave.save();
    assert_eq!(slave.set_reals(&[POSITION], &[f64::NAN]), Status::ERROR);
    says(&slave, &["body.base.motion.x", "NaN"]);
    assert_eq!(slave.step(0.01, 0.01), Status::ERROR);
    assert_eq!(slave.restore(&state), Status::OK);
    assert_eq!(slave.step(0.01, 0.01), Status::OK, "a restored state heals");
    assert_eq!(slave.free(state), Status::OK);
}

#[test]
fn asynchronous_and_interpolating_functions_say_no() {
    let library = Library::load("structure_fmu").unwrap();
    let slave = structure(&library);
    assert_eq!(slave.set_text(SCENE, "free_decay"), Status::OK);
    assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    let (mut real, mut status, mut flag) = (0.0, Status::OK, 0);
    // SAFETY: a live handle, arrays of one.
    unsafe {
        assert_eq!((library.cancel_step)(slave.handle), Status::ERROR);
        assert_eq!((library.set_real_input_derivatives)(slave.handle, &LOAD, 1, &1, &1.0), Status::ERROR);
        assert_eq!((library.get_real_output_derivatives)(slave.handle, &POSITION, 1, &1, &mut real), Status::ERROR);
        assert_eq!((library.get_boolean)(slave.handle, &1, 1, &mut flag), Status::ERROR);
        let pending = (library.get_status)(slave.handle, StatusKind::DO_STEP_STATUS, &mut status);
        assert_eq!(pending, Status::DISCARD);
        let last = (library.get_real_status)(slave.handle, StatusKind::LAST_SUCCESSFUL_TIME, &mut real);
        assert_eq!((last, real), (Status::OK, 0.0));
        // A category that nobody knows is no reason to stop.
        let categories = [c"logAll".as_ptr(), c"other".as_ptr()];
        assert_eq!((library.set_debug_logging)(slave.handle, 1, 2, categories.as_ptr()), Status::OK);
    }
    assert_eq!(slave.step(0.0, 0.001), Status::OK);
}

#[test]
fn an_output_directory_that_cannot_be_made_is_an_error() {
    let library = Library::load("fluid_fmu").unwrap();
    let slave = tank(&library);
    assert_eq!(slave.set_text(OUTPUT, "/proc/no/such/folder"), Status::OK);
    assert_eq!(slave.enter(0.0), Status::ERROR);
    says(&slave, &["/proc/no/such/folder"]);
}
