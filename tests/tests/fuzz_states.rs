//! Serialised states that were changed: refused with a message, or states like any other. Never a crash, a panic behind
//! the ABI, a flood of memory, or an instance that does not work any more.
//!
//! A changed byte is found by the checksum; the second half of the cases has a valid one, so that everything behind it
//! sees wrong contents. `PLIMSOLL_FUZZ_FACTOR` multiplies the number of cases, `PLIMSOLL_FUZZ_SEED` picks others.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{FluidComponent, Interface, LOAD, POSITION, StructureComponent};
use fmi::Component;
use fmi2::ffi::{Status, StatusKind};
use plimsoll_tests::{Library, Packed, Slave, State, real_outputs};
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestRunner;
use std::cell::Cell;
use std::time::Instant;

/// Magic word, version, GUID, length, checksum.
const HEADER: usize = 40;
const STEP: f64 = 0.002;
/// Most memory that a run of this file may ever have \[kB\]: grids over walls that a changed scene puts far away.
const MOST_MEMORY: u64 = 400_000;

/// Scene, overrides.
type Case = (&'static str, &'static str);

const WATER: &[Case] = &[
    ("hydrostatic", "fluid.spacing=0.1; fluid.threads=1"),
    ("hydrostatic", "fluid.spacing=0.1; fluid.threads=1; fluid.scheme=mps; fluid.wall.0.points.1=[-0.5,0.0]"),
    (
        "dam_break_plate",
        "fluid.spacing=0.03; fluid.threads=1; fluid.water.0.polygon=[[0,0],[0.286,0],[0.286,0.14],[0,0.14]]",
    ),
];
const BODIES: &[Case] =
    &[("free_decay", ""), ("floating_box_heave", ""), ("damaged_cabin", "integrator.rho_infinity=0.8")];

/// The scenes of both.
const SCENES: &[&str] = &["hydrostatic", "dam_break_plate", "free_decay", "floating_box_heave", "damaged_cabin"];

fn slave<'a, C: Component<Interface = Interface>>(library: &'a Library, (scene, overrides): Case) -> Slave<'a> {
    let packed = Packed::of(SCENES);
    let slave =
        Slave::new(library, &packed.guid::<C>(), Some(&packed.location())).unwrap_or_else(|why| panic!("{why:?}"));
    assert_eq!(slave.set_text(1, scene), Status::OK);
    assert_eq!(slave.set_text(2, overrides), Status::OK);
    slave
}

/// Serialised states of one scene: as instantiated, at the start, after some steps.
fn collect(slave: &Slave, states: &mut Vec<Vec<u8>>) {
    let keep = |states: &mut Vec<Vec<u8>>| {
        let state = slave.save();
        states.push(slave.bytes(&state));
        assert_eq!(slave.free(state), Status::OK);
    };
    keep(states);
    assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    keep(states);
    for step in 0..4 {
        let wave = f64::from(step) - 1.5;
        // Loads and added mass are inputs of one of the two only.
        slave.set_reals(&[POSITION + 3], &[1e-5 * wave]);
        slave.set_reals(&[LOAD + 1, 5_000_000, 5_000_001, 100_000_000, 100_010_001], &[wave, 0.1, 0.2, 3.0, 4.0]);
        assert_eq!(slave.step(STEP * f64::from(step), STEP), Status::OK, "{:?}", slave.messages());
    }
    keep(states);
}

/// Numbers that a field of a state should not have.
const NUMBERS: &[f64] =
    &[f64::NAN, f64::INFINITY, -1.0, 0.0, 1e-300, 1e300, -1e300, 1e9, 5.0, f64::MAX, f64::MIN_POSITIVE, 1e-3];

/// One change: kind, place, other place, amount.
type Change = (u8, Index, Index, u8);

fn changes() -> impl Strategy<Value = Vec<Change>> {
    prop::collection::vec((0..9u8, any::<Index>(), any::<Index>(), any::<u8>()), 1..4)
}

/// Changes bytes; `donors` give the other half of a splice.
fn apply(bytes: &mut Vec<u8>, donors: &[Vec<u8>], (kind, place, other, amount): &Change) {
    if bytes.is_empty() {
        return;
    }
    let at = place.index(bytes.len());
    let end = (at + usize::from(*amount)).min(bytes.len());
    match kind {
        0 => bytes[at] ^= amount.max(&1),
        1 => bytes.truncate(at),
        2 => bytes.extend(std::iter::repeat_n(*amount, 1 + other.index(64))),
        3 => drop(bytes.splice(at..end, std::iter::repeat_n(0xff, other.index(12)))),
        4 => drop(bytes.drain(at..end)),
        5 => bytes.extend_from_within(at..end),
        6 => {
            let donor = &donors[other.index(donors.len())];
            let from = at.min(donor.len());
            bytes.splice(at.., donor[from..].iter().copied());
        }
        _ => {
            let number = NUMBERS[other.index(NUMBERS.len())].to_le_bytes();
            let end = (at + 8).min(bytes.len());
            bytes[at..end].copy_from_slice(&number[..end - at]);
        }
    }
}

/// Puts length and checksum of what follows it into the header.
fn seal(bytes: &mut [u8]) {
    let checksum = crc32fast::hash(&bytes[HEADER..]);
    let length = (bytes.len() - HEADER) as u64;
    bytes[28..36].copy_from_slice(&length.to_le_bytes());
    bytes[36..40].copy_from_slice(&checksum.to_le_bytes());
}

/// A call that was not carried out says why, and not that it panicked.
fn told(slave: &Slave, status: Status) -> Result<(), TestCaseError> {
    let messages = slave.messages();
    prop_assert!(matches!(status, Status::OK | Status::DISCARD | Status::ERROR), "{status:?}");
    prop_assert!(status == Status::OK || !messages.is_empty(), "{status:?} without a message");
    prop_assert!(!messages.iter().any(|message| message.contains("internal error")), "{messages:?}");
    Ok(())
}

/// A state that was read is used: restored, looked at, stepped, saved.
fn use_it(slave: &Slave, state: &State, outputs: &[u32]) -> Result<(), TestCaseError> {
    let restored = slave.restore(state);
    told(slave, restored)?;
    let (mut time, mut values) = (0.0, vec![0.0; outputs.len()]);
    // SAFETY: a live handle, arrays of the lengths passed.
    unsafe {
        let last = StatusKind::LAST_SUCCESSFUL_TIME;
        told(slave, (slave.library.get_real_status)(slave.handle, last, &mut time))?;
        for step in [0.1 * STEP, STEP] {
            told(slave, (slave.library.get_real)(slave.handle, outputs.as_ptr(), outputs.len(), values.as_mut_ptr()))?;
            let status = slave.step(time, step);
            told(slave, status)?;
            time += step;
        }
        let mut derivative = 0.0;
        let library = slave.library;
        for (unknown, known) in [(200, 120), (100, 200)] {
            told(
                slave,
                (library.get_directional_derivative)(slave.handle, &unknown, 1, &known, 1, &1.0, &mut derivative),
            )?;
        }
    }
    let (again, bytes) = (slave.save(), slave.bytes(state));
    prop_assert_eq!(slave.free(again), Status::OK);
    prop_assert!(bytes.len() > HEADER);
    Ok(())
}

/// A state with changed values and a checksum that fits them.
fn resealed(state: &[u8], donors: &[Vec<u8>], changes: &[Change]) -> Vec<u8> {
    let mut values = state[HEADER..].to_vec();
    let donors: Vec<Vec<u8>> = donors.iter().map(|donor| donor[HEADER..].to_vec()).collect();
    changes.iter().for_each(|change| apply(&mut values, &donors, change));
    let mut bytes = [&state[..HEADER], &values].concat();
    seal(&mut bytes);
    bytes
}

/// The states of the other FMU as well.
fn donors(name: &str, library: &Library, states: &[Vec<u8>]) -> Vec<Vec<u8>> {
    let mut donors = states.to_vec();
    if name == "fluid_fmu" {
        collect(&slave::<StructureComponent>(library, BODIES[0]), &mut donors);
    } else {
        collect(&slave::<FluidComponent>(library, WATER[0]), &mut donors);
    }
    donors
}

/// Changes states until the cases are used up; returns how many were refused and how many were taken.
fn damage<C: Component<Interface = Interface>>(
    name: &str,
    other: &str,
    cases: u32,
    scenes: &[Case],
    sealed: bool,
) -> [u32; 2] {
    let library = Library::load(name).unwrap();
    let foreign = Library::load(other).unwrap();
    let mut states = Vec::new();
    let slaves: Vec<Slave> = scenes.iter().map(|&scene| slave::<C>(&library, scene)).collect();
    slaves.iter().for_each(|slave| collect(slave, &mut states));
    let donors = donors(name, &foreign, &states);
    let outputs = real_outputs(&C::model(&Packed::of(SCENES).interface));
    let counts = [Cell::new(0), Cell::new(0)];
    let strategy = (any::<Index>(), any::<Index>(), changes());
    let outcome = TestRunner::new(fuzzing::config(cases)).run(&strategy, |(which, slave, changes)| {
        let original = &donors[which.index(donors.len())];
        let slave = &slaves[slave.index(slaves.len())];
        let clock = Instant::now();
        let bytes = match sealed {
            true => resealed(&states[which.index(states.len())], &donors, &changes),
            false => {
                let mut bytes = original.clone();
                changes.iter().for_each(|change| apply(&mut bytes, &donors, change));
                bytes
            }
        };
        let before = slave.save();
        let read = slave.from_bytes(&bytes);
        told(slave, read.as_ref().err().copied().unwrap_or(Status::OK))?;
        counts[usize::from(read.is_ok())].set(counts[usize::from(read.is_ok())].get() + 1);
        if !sealed {
            prop_assert!(read.is_err() || states.contains(&bytes), "damage was not noticed");
        }
        if let Ok(state) = read {
            let used = use_it(slave, &state, &outputs);
            prop_assert_eq!(slave.free(state), Status::OK);
            used?;
        }
        prop_assert_eq!(slave.restore(&before), Status::OK, "{:?}", slave.messages());
        prop_assert_eq!(slave.free(before), Status::OK);
        let seconds = clock.elapsed().as_secs_f64();
        let memory = fuzzing::memory("VmHWM").unwrap_or(0);
        prop_assert!(seconds < 30.0 && memory < MOST_MEMORY, "{seconds} s, {memory} kB");
        Ok(())
    });
    assert!(outcome.is_ok(), "{outcome:?}");
    // Nothing of it has changed what the instances do.
    for slave in &slaves {
        assert_eq!(slave.step(4.0 * STEP, STEP), Status::OK, "{:?}", slave.messages());
    }
    let memory = fuzzing::memory("VmHWM").unwrap_or(0);
    assert!(memory < MOST_MEMORY, "{memory} kB");
    let counts = counts.map(|count| count.get());
    println!("{name}, sealed {sealed}: {} refused, {} taken, at most {memory} kB", counts[0], counts[1]);
    counts
}

#[test]
fn damaged_states_of_the_fluid_are_refused() {
    damage::<FluidComponent>("fluid_fmu", "structure_fmu", 4000, WATER, false);
}

#[test]
fn damaged_states_of_the_structure_are_refused() {
    damage::<StructureComponent>("structure_fmu", "fluid_fmu", 4000, BODIES, false);
}

#[test]
fn states_of_the_fluid_with_wrong_contents_do_no_harm() {
    let [refused, taken] = damage::<FluidComponent>("fluid_fmu", "structure_fmu", 4000, WATER, true);
    assert!(refused > 400 && taken > 40, "{refused} refused, {taken} taken: too few of a kind to say anything");
}

#[test]
fn states_of_the_structure_with_wrong_contents_do_no_harm() {
    let [refused, taken] = damage::<StructureComponent>("structure_fmu", "fluid_fmu", 4000, BODIES, true);
    assert!(refused > 400 && taken > 40, "{refused} refused, {taken} taken: too few of a kind to say anything");
}
