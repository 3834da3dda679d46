//! Saved states through the C ABI: same bits after a restore, in another instance, in another process.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{ACCELERATION, FluidComponent, Interface, LOAD, POSITION, StructureComponent, VELOCITY};
use fmi::{Component, Logger};
use fmi2::Instance;
use fmi2::ffi::Status;
use plimsoll_tests::{Library, Packed, Slave, real_outputs};
use std::process::Command;

const STEP: f64 = 0.000_5;
const POSITION_Q1: u32 = POSITION + 3;
const VELOCITY_Q1: u32 = VELOCITY + 3;
const ACCELERATION_Q1: u32 = ACCELERATION + 3;
const LOAD_Q1: u32 = LOAD + 3;
/// The scene of these tests, and one with other titles for each part.
const SCENES: [&str; 3] = ["dam_break_plate", "hydrostatic", "free_decay"];
/// The plate of dam_break_plate with a coarse column that touches it.
const OVERRIDES: &str = "fluid.spacing = 0.012; fluid.water.0.polygon = [[0,0],[0.286,0],[0.286,0.14],[0,0.14]]";

fn slave<'a, C: Component<Interface = Interface>>(library: &'a Library) -> Slave<'a> {
    let packed = Packed::of(&SCENES);
    let slave =
        Slave::new(library, &packed.guid::<C>(), Some(&packed.location())).unwrap_or_else(|why| panic!("{why:?}"));
    assert_eq!(slave.set_text(1, "dam_break_plate"), Status::OK);
    assert_eq!(slave.set_text(2, OVERRIDES), Status::OK);
    slave
}

/// Inputs of step `n`: the plate is bent a little, the load pushes it.
fn inputs<C: 'static>(n: usize) -> (Vec<u32>, Vec<f64>) {
    let wave = (0.3 * n as f64).sin();
    if std::any::TypeId::of::<C>() == std::any::TypeId::of::<FluidComponent>() {
        (vec![POSITION_Q1, VELOCITY_Q1, ACCELERATION_Q1], vec![1e-4 * wave, 0.02 * wave, 3.0 * wave])
    } else {
        (vec![LOAD_Q1, LOAD_Q1 + 1], vec![5.0 * wave, -1.0])
    }
}

fn advance<C: Component<Interface = Interface>>(slave: &Slave, from: usize, to: usize) {
    for n in from..to {
        let (references, values) = inputs::<C>(n);
        assert_eq!(slave.set_reals(&references, &values), Status::OK);
        assert_eq!(slave.step(n as f64 * STEP, STEP), Status::OK, "{:?}", slave.messages());
    }
}

fn bits<C: Component<Interface = Interface>>(slave: &Slave) -> Vec<u64> {
    slave.reals(&real_outputs(&C::model(&Packed::of(&SCENES).interface))).iter().map(|value| value.to_bits()).collect()
}

fn repeats_give_the_same_bits<C: Component<Interface = Interface>>(name: &str) {
    let library = Library::load(name).unwrap();
    let first = slave::<C>(&library);
    assert_eq!(first.initialise(0.0), Status::OK, "{:?}", first.messages());
    advance::<C>(&first, 0, 3);
    let (state, at_save) = (first.save(), bits::<C>(&first));
    let bytes = first.bytes(&state);
    advance::<C>(&first, 3, 6);
    let expected = bits::<C>(&first);
    assert_ne!(expected, at_save, "something moves");
    // Other inputs on the way must leave no trace.
    assert_eq!(first.restore(&state), Status::OK);
    assert_eq!(first.set_reals(&[inputs::<C>(0).0[0]], &[1e-3]), Status::OK);
    assert_eq!(first.step(3.0 * STEP, 0.5 * STEP), Status::OK);
    assert_eq!(first.restore(&state), Status::OK);
    assert_eq!(bits::<C>(&first), at_save, "outputs belong to the state");
    advance::<C>(&first, 3, 6);
    assert_eq!(bits::<C>(&first), expected, "restored");
    // A fresh instance that was never initialised, and knows the state as bytes only.
    let second = slave::<C>(&library);
    let copy = second.from_bytes(&bytes).unwrap();
    assert_eq!(second.bytes(&copy), bytes, "bytes are a function of the state");
    assert_eq!(second.restore(&copy), Status::OK, "{:?}", second.messages());
    assert_eq!(bits::<C>(&second), at_save);
    advance::<C>(&second, 3, 6);
    assert_eq!(bits::<C>(&second), expected, "deserialised into another instance");
    assert_eq!(first.free(state), Status::OK);
    assert_eq!(second.free(copy), Status::OK);
}

#[test]
fn the_plate_of_these_tests_is_wet() {
    let library = Library::load("fluid_fmu").unwrap();
    let slave = slave::<FluidComponent>(&library);
    assert_eq!(slave.initialise(0.0), Status::OK);
    advance::<FluidComponent>(&slave, 0, 3);
    assert!(slave.reals(&[LOAD_Q1])[0].abs() > 1e-3, "or the inputs would not matter");
}

#[test]
fn fluid_repeats() {
    repeats_give_the_same_bits::<FluidComponent>("fluid_fmu");
}

#[test]
fn structure_repeats() {
    repeats_give_the_same_bits::<StructureComponent>("structure_fmu");
}

#[test]
fn foreign_and_damaged_bytes_are_refused() {
    let (fluid, structure) = (Library::load("fluid_fmu").unwrap(), Library::load("structure_fmu").unwrap());
    let plate = slave::<StructureComponent>(&structure);
    assert_eq!(plate.initialise(0.0), Status::OK);
    let state = plate.save();
    let mut bytes = plate.bytes(&state);
    let water = slave::<FluidComponent>(&fluid);
    assert_eq!(water.from_bytes(&bytes).err(), Some(Status::ERROR));
    assert!(water.messages()[0].contains("GUID"));
    let last = bytes.len() - 1;
    bytes[last] ^= 0x10;
    assert_eq!(plate.from_bytes(&bytes).err(), Some(Status::ERROR));
    assert!(plate.messages()[0].contains("checksum"));
    assert_eq!(plate.from_bytes(&bytes[..10]).err(), Some(Status::ERROR));
    assert_eq!(plate.free(state), Status::OK);
    assert_eq!(plate.step(0.0, STEP), Status::OK, "the instance is as before");
}

#[test]
fn states_of_another_scene_are_refused_with_both_names() {
    fn refused<C: Component<Interface = Interface>>(name: &str, other: &str, overrides: &str, titles: [&str; 2]) {
        let library = Library::load(name).unwrap();
        let first = slave::<C>(&library);
        assert_eq!(first.initialise(0.0), Status::OK, "{:?}", first.messages());
        let state = first.save();
        let bytes = first.bytes(&state);
        let second = slave::<C>(&library);
        assert_eq!((second.set_text(1, other), second.set_text(2, overrides)), (Status::OK, Status::OK));
        assert_eq!(second.initialise(0.0), Status::OK, "{:?}", second.messages());
        let before = bits::<C>(&second);
        assert_eq!(second.from_bytes(&bytes).err(), Some(Status::ERROR));
        assert_eq!(second.restore(&state), Status::ERROR);
        let messages = second.messages();
        let told =
            |text: &String| text.contains("the state belongs") && titles.iter().all(|title| text.contains(title));
        assert_eq!(messages.iter().filter(|text| told(text)).count(), 2, "{messages:?}");
        assert_eq!(bits::<C>(&second), before);
        assert_eq!(second.step(0.0, STEP), Status::OK, "the instance is as before: {:?}", second.messages());
        assert_eq!(first.free(state), Status::OK);
    }
    // The titles in the scene files.
    let (plate, tank) = ("'Dam break on an elastic plate'", "'Water at rest in a tank'");
    refused::<FluidComponent>("fluid_fmu", "hydrostatic", "fluid.spacing=0.05", [plate, tank]);
    refused::<StructureComponent>(
        "structure_fmu",
        "free_decay",
        "",
        [plate, "'Free decay of a clamped plate in vacuum'"],
    );
}

/// Threads and the stop time are the importer's to say, and change no bits.
#[test]
fn a_state_goes_on_for_longer_and_on_other_threads() {
    let begun = |overrides: &str, stop: f64| {
        let Packed { interface, folder } = Packed::of(&SCENES);
        let mut instance = Instance::<FluidComponent>::new(interface, Some(folder), Logger::silent()).unwrap();
        instance.set_string(&[1, 2], &["dam_break_plate", &format!("{OVERRIDES}; {overrides}")]).unwrap();
        instance.setup_experiment(None, 0.0, Some(stop)).unwrap();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        instance
    };
    let steps = |instance: &mut Instance<FluidComponent>, from: usize, to: usize| {
        for n in from..to {
            let (references, values) = inputs::<FluidComponent>(n);
            instance.set_real(&references, &values).unwrap();
            instance.do_step(n as f64 * STEP, STEP).unwrap();
        }
    };
    let bytes = |instance: &mut Instance<FluidComponent>| {
        let references = real_outputs(&FluidComponent::model(&Packed::of(&SCENES).interface));
        let mut values = vec![0.0; references.len()];
        instance.get_real(&references, &mut values).unwrap();
        values.iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    let mut whole = begun("fluid.threads=1", 4.0 * STEP);
    steps(&mut whole, 0, 4);
    let mut first = begun("fluid.threads=1", 2.0 * STEP);
    steps(&mut first, 0, 2);
    let saved = first.serialize(&first.get_state().unwrap()).unwrap();
    let mut second = begun("fluid.threads=2; run.end=7", 4.0 * STEP);
    let state = second.deserialize(&saved).unwrap();
    second.set_state(&state).unwrap();
    steps(&mut second, 2, 4);
    assert_eq!(bytes(&mut second), bytes(&mut whole));
}

/// What the child process does: reads the state, goes on, writes the bits. Without the variables there is nothing to
/// do.
#[test]
fn child_goes_on() {
    let (Ok(input), Ok(output)) = (std::env::var("PLIMSOLL_STATE"), std::env::var("PLIMSOLL_BITS")) else { return };
    let library = Library::load("fluid_fmu").unwrap();
    let slave = slave::<FluidComponent>(&library);
    let state = slave.from_bytes(&std::fs::read(input).unwrap()).unwrap();
    assert_eq!(slave.restore(&state), Status::OK, "{:?}", slave.messages());
    advance::<FluidComponent>(&slave, 3, 6);
    std::fs::write(output, format!("{:x?}", bits::<FluidComponent>(&slave))).unwrap();
    assert_eq!(slave.free(state), Status::OK);
}

#[test]
fn another_process_gives_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("state"), folder.path().join("bits"));
    let library = Library::load("fluid_fmu").unwrap();
    let slave = slave::<FluidComponent>(&library);
    assert_eq!(slave.initialise(0.0), Status::OK);
    advance::<FluidComponent>(&slave, 0, 3);
    let state = slave.save();
    std::fs::write(&input, slave.bytes(&state)).unwrap();
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child_goes_on"])
        .env("PLIMSOLL_STATE", &input)
        .env("PLIMSOLL_BITS", &output)
        .status();
    assert!(status.unwrap().success());
    advance::<FluidComponent>(&slave, 3, 6);
    assert_eq!(std::fs::read_to_string(output).unwrap(), format!("{:x?}", bits::<FluidComponent>(&slave)));
    assert_eq!(slave.free(state), Status::OK);
}

/// The same run in process, without the C ABI.
fn direct_bits<C: Component<Interface = Interface>>() -> Vec<u64> {
    let Packed { interface, folder } = Packed::of(&SCENES);
    let mut instance = Instance::<C>::new(interface, Some(folder), Logger::silent()).unwrap();
    instance.set_string(&[1, 2], &["dam_break_plate", OVERRIDES]).unwrap();
    instance.setup_experiment(None, 0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    for n in 0..6 {
        let (references, values) = inputs::<C>(n);
        instance.set_real(&references, &values).unwrap();
        instance.do_step(n as f64 * STEP, STEP).unwrap();
    }
    let references = real_outputs(&C::model(&Packed::of(&SCENES).interface));
    let mut values = vec![0.0; references.len()];
    instance.get_real(&references, &mut values).unwrap();
    values.iter().map(|value| value.to_bits()).collect()
}

fn abi_bits<C: Component<Interface = Interface>>(name: &str) -> Vec<u64> {
    let library = Library::load(name).unwrap();
    let slave = slave::<C>(&library);
    assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    advance::<C>(&slave, 0, 6);
    bits::<C>(&slave)
}

#[test]
fn in_process_and_through_the_abi_the_bits_are_the_same() {
    assert_eq!(direct_bits::<FluidComponent>(), abi_bits::<FluidComponent>("fluid_fmu"));
    assert_eq!(direct_bits::<StructureComponent>(), abi_bits::<StructureComponent>("structure_fmu"));
}

#[test]
fn two_instances_in_two_threads_do_not_disturb_each_other() {
    let alone = abi_bits::<FluidComponent>("fluid_fmu");
    let other = abi_bits::<StructureComponent>("structure_fmu");
    std::thread::scope(|scope| {
        let runs: Vec<_> = (0..2)
            .map(|_| {
                scope.spawn(|| {
                    (abi_bits::<FluidComponent>("fluid_fmu"), abi_bits::<StructureComponent>("structure_fmu"))
                })
            })
            .collect();
        for run in runs {
            assert_eq!(run.join().unwrap(), (alone.clone(), other.clone()));
        }
    });
}
