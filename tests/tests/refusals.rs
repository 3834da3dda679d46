//! Impossible scenes and inputs through the C ABI: a message with numbers, fmi2Error, and every other instance goes on.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{ACCELERATION, FluidComponent, Interface, LOAD, POSITION, StructureComponent, VELOCITY};
use fmi::Component;
use fmi2::ffi::Status;
use plimsoll_tests::{Library, Packed, Slave};

const SCENE: u32 = 1;
const OVERRIDES: u32 = 2;
const SPACING: u32 = 3;
const YOUNGS_MODULUS: u32 = 10_000_000;

fn slave<'a, C: Component<Interface = Interface>>(library: &'a Library, scene: &str, overrides: &str) -> Slave<'a> {
    let packed = Packed::of(&[scene]);
    let slave =
        Slave::new(library, &packed.guid::<C>(), Some(&packed.location())).unwrap_or_else(|why| panic!("{why:?}"));
    assert_eq!(slave.set_text(SCENE, scene), Status::OK);
    assert_eq!(slave.set_text(OVERRIDES, overrides), Status::OK);
    slave
}

/// A running tank with 50 particles.
fn tank(library: &Library) -> Slave<'_> {
    let slave = slave::<FluidComponent>(library, "hydrostatic", "fluid.spacing=0.1");
    assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    slave
}

fn says(slave: &Slave, words: &[&str]) {
    let messages = slave.messages();
    let last = messages.last().unwrap_or_else(|| panic!("no message, expected {words:?}"));
    assert!(words.iter().all(|word| last.contains(word)), "{last}: expected {words:?}");
}

/// Initialisation fails with fmi2Error and these words, and nothing but freeing is possible afterwards.
fn refused(slave: &Slave, words: &[&str]) {
    assert_eq!(slave.initialise(0.0), Status::ERROR, "expected {words:?}");
    says(slave, words);
    assert_eq!(slave.step(0.0, 0.001), Status::ERROR);
}

#[test]
fn impossible_water_and_walls_are_refused_with_coordinates() {
    let library = Library::load("fluid_fmu").unwrap();
    let other = tank(&library);
    let cases: [(&str, &str, &[&str]); 10] = [
        // Particles of 0.1 m from x = 0.5 on: the first one behind the wall at x = 1 stands at 1.05.
        (
            "hydrostatic",
            "fluid.spacing=0.1; fluid.water.0.polygon=[[0.5,0.1],[1.5,0.1],[1.5,0.4],[0.5,0.4]]",
            &["water at (1.05", "0.15", "behind the wall"],
        ),
        (
            "hydrostatic",
            "fluid.spacing=0.1; fluid.wall.0.points=[[1,0.8],[1,0],[0,0],[0,0.8]]",
            &["water at (0.05, 0.05)", "fluid on the left"],
        ),
        ("hydrostatic", "fluid.spacing=0.8", &["1 x 0.5 m", "spacing 0.8 m", "at least 2 spacings"]),
        ("hydrostatic", "fluid.water.0.polygon=[[0,0],[1,0],[0.5,0]]", &["fluid.water[0].polygon = 0 m2", "1 x 0 m"]),
        (
            "hydrostatic",
            "fluid.water.0.polygon=[[0,0],[0.5,0.5],[0.25,0.25]]",
            &["fluid.water[0].polygon = 0 m2", "encloses an area"],
        ),
        (
            "hydrostatic",
            "fluid.wall.0.points=[[0,0.8],[0,0],[0,0],[1,0],[1,0.8]]",
            &["fixed wall 0 near (0, 0)", "a piece of 0 m", "0.001 m"],
        ),
        ("hydrostatic", "fluid.spacing=1e-9", &["fluid.spacing = 0.000000001", "1e7 particles in 0.5 m2"]),
        ("dam_break_plate", "body.0.member.0.middle=[0.7,0.04]", &["body's surface at (0.69", "outside the tank"]),
        ("dam_break_plate", "body.0.member.0.middle=[0.292,-0.2]", &["body's surface at (0.286", "outside the tank"]),
        ("dam_break_plate", "body.0.member.0.middle=[0.1,0.04]", &["water at (0.10", "behind the wall"]),
    ];
    for (index, (scene, overrides, words)) in cases.into_iter().enumerate() {
        let bad = slave::<FluidComponent>(&library, scene, overrides);
        refused(&bad, words);
        drop(bad);
        let time = 0.005 * index as f64;
        assert_eq!(other.step(time, 0.005), Status::OK, "others go on: {:?}", other.messages());
    }
}

#[test]
fn parameters_that_ask_for_too_much_are_refused_like_the_scenes_own() {
    let library = Library::load("fluid_fmu").unwrap();
    for (spacing, words) in [(1e-9, &["fluid.spacing", "particles"][..]), (5.0, &["1 x 0.5 m", "spacing 5 m"])] {
        let slave = slave::<FluidComponent>(&library, "hydrostatic", "");
        assert_eq!(slave.set_reals(&[SPACING], &[spacing]), Status::OK);
        refused(&slave, words);
    }
    let probes = "fluid.probe=[{ name = 'line', from = [0,0.1], to = [0,0.4], count = 17 }]";
    refused(
        &slave::<FluidComponent>(&library, "hydrostatic", probes),
        &["probe.line_1.pressure", "packed for another scene"],
    );
    let library = Library::load("structure_fmu").unwrap();
    for value in [f64::NAN, f64::INFINITY, -1.0] {
        let slave = slave::<StructureComponent>(&library, "free_decay", "");
        assert_ne!(slave.set_reals(&[YOUNGS_MODULUS], &[value]), Status::OK);
        says(&slave, &["youngs_modulus"]);
    }
}

#[test]
fn impossible_structures_are_refused_with_numbers() {
    let library = Library::load("structure_fmu").unwrap();
    let free = "body.0.free=['theta']; body.0.mass=1";
    let twice = "body.0.wall=[{ points = [[0,0],[0,0]] }]";
    for (overrides, words) in [
        ("body.0.member.0.length=-1", &["body[0].member[0].length = -1"][..]),
        ("body.0.member.0.damping=[0.1,0.2]", &["body[0].member[0].damping = 2", "from 0 to 1"]),
        ("integrator.beta=0.1", &["beta", "0.1", "gamma/2"]),
        ("gravity=[1.0,-9.81]", &["gravity = [1, -9.81]"]),
        (free, &["body[0].inertia = 0", "body[0].free has theta"]),
        ("body.0.free=['x']", &["body[0].mass = 0", "body[0].free has x"]),
        (twice, &["coincide", "(0, 0)"]),
    ] {
        refused(&slave::<StructureComponent>(&library, "free_decay", overrides), words);
    }
}

#[test]
fn no_input_may_be_nan_and_no_step_negative() {
    let library = Library::load("structure_fmu").unwrap();
    let structure = slave::<StructureComponent>(&library, "free_decay", "");
    assert_eq!(structure.step(0.0, 0.001), Status::ERROR, "a step before initialisation");
    assert_eq!(structure.initialise(0.0), Status::OK, "{:?}", structure.messages());
    let state = structure.save();
    for (step, number) in [(-0.001, "-0.001"), (0.0, "0"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        assert_eq!(structure.step(0.0, step), Status::ERROR);
        says(&structure, &["communication step", number]);
    }
    for reference in (LOAD..LOAD + 4).rev() {
        for value in [f64::NAN, f64::INFINITY] {
            assert_eq!(structure.set_reals(&[reference], &[value]), Status::ERROR);
            says(&structure, &["load.", &value.to_string()]);
            assert_eq!(structure.restore(&state), Status::OK);
        }
    }
    assert_eq!(structure.step(0.0, 0.001), Status::OK, "{:?}", structure.messages());
    assert_eq!(structure.free(state), Status::OK);

    let library = Library::load("fluid_fmu").unwrap();
    let (fluid, other) = (slave::<FluidComponent>(&library, "piston", "fluid.spacing=0.1"), tank(&library));
    assert_eq!(fluid.initialise(0.0), Status::OK, "{:?}", fluid.messages());
    let state = fluid.save();
    for first in [POSITION, VELOCITY, ACCELERATION] {
        for reference in first..first + 3 {
            assert_eq!(fluid.set_reals(&[reference], &[f64::NAN]), Status::ERROR);
            says(&fluid, &["motion.", "NaN"]);
            assert_eq!(fluid.restore(&state), Status::OK);
        }
    }
    assert_eq!(fluid.free(state), Status::OK);
    assert_eq!((fluid.step(0.0, 0.01), other.step(0.0, 0.01)), (Status::OK, Status::OK));
}

#[test]
fn a_step_that_would_never_end_is_discarded() {
    let library = Library::load("fluid_fmu").unwrap();
    let fluid = tank(&library);
    let state = fluid.save();
    for step in [1e9, 1e300, f64::MAX] {
        assert_eq!(fluid.step(0.0, step), Status::DISCARD);
        says(&fluid, &["1e6 internal steps", "shorter communication step"]);
        assert_eq!(fluid.restore(&state), Status::OK);
    }
    assert_eq!((fluid.free(state), fluid.step(0.0, 0.01)), (Status::OK, Status::OK));
}

/// The body is put where the importer says before the first step: not out of the domain.
#[test]
fn a_body_out_of_the_domain_at_the_start_is_refused() {
    let library = Library::load("fluid_fmu").unwrap();
    for place in [1e3, 1e300] {
        let slave = slave::<FluidComponent>(&library, "dam_break_plate", "fluid.spacing=0.04");
        assert_eq!(slave.set_reals(&[POSITION], &[place]), Status::OK);
        refused(&slave, &["motion: x of a point of the body's surface", "within"]);
    }
}
