//! Calls in any order with any arguments that the C ABI allows to check: every one that is not carried out says why,
//! none crashes, and no sequence leaves an instance that fmi2Reset does not mend.
//!
//! `PLIMSOLL_FUZZ_FACTOR` multiplies the number of cases, `PLIMSOLL_FUZZ_SEED` picks others.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{FluidComponent, Interface, StructureComponent};
use fmi::Component;
use fmi2::ffi::{self, Status, StatusKind};
use plimsoll_tests::{Library, Packed, Slave, root};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::cell::Cell;
use std::ffi::CStr;
use std::ptr::{null, null_mut};

/// Scene and overrides; the first ones are sound.
const WATER: &[(&str, &str)] = &[
    ("hydrostatic", "fluid.spacing=0.1; fluid.threads=1"),
    ("dam_break_plate", "fluid.spacing=0.04; fluid.threads=1"),
    ("hydrostatic", "fluid.spacing=0.1; fluid.threads=1; fluid.scheme=mps"),
    ("free_decay", ""),
    ("hydrostatic", "fluid.spacing=1e-9"),
    ("hydrostatic", "fluid.spacing=0.1; fluid.wall.0.points.1=[-1e300,0.0]"),
    ("no such scene", ""),
];
const BODIES: &[(&str, &str)] = &[
    ("free_decay", ""),
    ("floating_box_heave", ""),
    ("damaged_cabin", "integrator.rho_infinity=0.8"),
    ("hydrostatic", ""),
    ("free_decay", "body.0.member.0.length=-1"),
    ("free_decay", "body.0.member.0.density=1e300"),
    ("/no/such/file.toml", "x"),
];
/// How many of either are sound.
const SOUND: usize = 3;

#[rustfmt::skip]
const NUMBERS: &[f64] = &[
    0.0, 1e-5, -1e-3, 0.1, -0.0, 20.0, 1e18, -1e18, 1e300, -1e300,
    f64::MAX, f64::MIN_POSITIVE, f64::NAN, f64::INFINITY, f64::NEG_INFINITY,
];
const STEPS: &[f64] =
    &[1e-3, 1e-3, 1e-3, 5e-3, 2e-2, 1e-9, 0.0, -1e-3, 1e-300, 1e9, 1e300, f64::MAX, f64::NAN, f64::INFINITY];
const INTEGERS: &[i32] = &[0, 1, 2, -1, 1025, i32::MAX, i32::MIN];
const TEXTS: &[&CStr] = &[c"", c"hydrostatic", c"%s%n%d", c"\xff\xfe", c"fluid.spacing=0.2;;=", c"/proc/no/such"];

/// Kind of a call and three choices for its arguments.
type Call = (u8, u8, u8, u8);

/// Kinds of calls; the last ones are more of what a run is made of.
const KINDS: u8 = 44;

fn pick<T: Copy>(list: &[T], choice: u8) -> T {
    list[usize::from(choice) % list.len()]
}

/// One instance after the other of one FMU, and what outlives them.
struct World<'a> {
    library: &'a Library,
    guid: String,
    location: String,
    scenes: &'static [(&'static str, &'static str)],
    references: Vec<u32>,
    slave: Slave<'a>,
    states: Vec<ffi::FmuState>,
    bytes: Vec<u8>,
}

impl<'a> World<'a> {
    fn new<C: Component<Interface = Interface>>(
        library: &'a Library,
        scenes: &'static [(&'static str, &'static str)],
    ) -> Self {
        let packed = Packed::of(&scenes.iter().map(|(scene, _)| *scene).collect::<Vec<_>>());
        let (model, guid) = (C::model(&packed.interface), packed.guid::<C>());
        let mut references: Vec<u32> = model.variables.iter().map(|variable| variable.reference).collect();
        references.extend([0, 99, 4711, u32::MAX]);
        let location = packed.location();
        let slave = Slave::new(library, &guid, Some(&location)).unwrap_or_else(|why| panic!("{why:?}"));
        Self { library, guid, location, scenes, references, slave, states: Vec::new(), bytes: Vec::new() }
    }

    fn choose(&self, number: usize) {
        let (scene, overrides) = self.scenes[number % self.scenes.len()];
        self.slave.set_text(1, scene);
        self.slave.set_text(2, overrides);
    }

    /// One of the saved states, or none.
    fn state(&self, choice: u8) -> ffi::FmuState {
        let number = usize::from(choice) % (self.states.len() + 1);
        self.states.get(number).copied().unwrap_or(null_mut())
    }

    fn time(&self) -> f64 {
        let mut time = 0.0;
        // SAFETY: a live handle, a result of one.
        unsafe { (self.library.get_real_status)(self.slave.handle, StatusKind::LAST_SUCCESSFUL_TIME, &mut time) };
        time
    }

    /// A new instance in the place of the old one, or a refusal with a message.
    fn instantiate(&mut self, a: u8, b: u8) {
        let guid = pick(&[self.guid.as_str(), self.guid.as_str(), "", "{}", "12345678-0000-0000-0000-000000000000"], a);
        let packed = self.location.as_str();
        let location = pick(&[Some(packed), Some(packed), None, Some(""), Some("https://host/x"), Some("file:")], b);
        match Slave::new(self.library, guid, location) {
            Ok(slave) => self.slave = slave,
            Err(messages) => assert!(!messages.is_empty(), "refused without a message"),
        }
    }

    /// Life cycle and steps.
    fn live(&mut self, (kind, a, b, c): Call) -> Status {
        let (library, handle) = (self.library, self.slave.handle);
        let (flag, number) = (i32::from(a % 3) - 1, pick(NUMBERS, b));
        let categories = [c"logAll".as_ptr(), c"\xff".as_ptr(), null()];
        // SAFETY: a live handle; arrays are NULL or of the length passed.
        unsafe {
            match kind {
                0 => (library.setup_experiment)(handle, flag, number, pick(NUMBERS, c), flag, 1.0),
                1 => (library.enter_initialization_mode)(handle),
                2 => (library.exit_initialization_mode)(handle),
                3 => (library.terminate)(handle),
                4 => (library.reset)(handle),
                5 => (library.cancel_step)(handle),
                6 => (library.do_step)(handle, number, pick(STEPS, c), flag),
                7 => (library.do_step)(handle, self.time(), pick(STEPS, c), flag),
                8 => (library.set_debug_logging)(handle, 1, usize::from(a % 4), null()),
                _ => (library.set_debug_logging)(handle, flag, usize::from(a % 4), categories.as_ptr()),
            }
        }
    }

    /// Getters and setters of one or two variables, known or not, NULL or not.
    fn access(&mut self, (kind, a, b, c): Call) -> Status {
        let (library, handle) = (self.library, self.slave.handle);
        let references = [b, c].map(|choice| self.references[usize::from(choice) * 7 % self.references.len()]);
        let count = usize::from(a % 3);
        let vr = if a.is_multiple_of(11) { null() } else { references.as_ptr() };
        let missing = a.is_multiple_of(13);
        let (mut reals, mut integers, mut texts) = ([pick(NUMBERS, c), 0.0], [pick(INTEGERS, c), 0], [null(); 2]);
        let given = [pick(TEXTS, c).as_ptr(), if c.is_multiple_of(5) { null() } else { c"".as_ptr() }];
        let (real, integer) = (reals.as_mut_ptr(), integers.as_mut_ptr());
        let (real, integer) = if missing { (null_mut(), null_mut()) } else { (real, integer) };
        // SAFETY: a live handle; arrays are NULL or at least as long as passed, strings end with NUL.
        unsafe {
            match kind {
                10 => (library.get_real)(handle, vr, count, real),
                11 => (library.set_real)(handle, vr, count, real),
                12 => (library.get_integer)(handle, vr, count, integer),
                13 => (library.set_integer)(handle, vr, count, integer),
                14 => (library.get_boolean)(handle, vr, count, integer),
                15 => (library.set_boolean)(handle, vr, count, integer),
                16 => (library.set_string)(handle, vr, count, if missing { null() } else { given.as_ptr() }),
                17 => (library.set_real_input_derivatives)(handle, vr, count, integer, real),
                18 => (library.get_real_output_derivatives)(handle, vr, count, integer, real),
                _ => {
                    let status =
                        (library.get_string)(handle, vr, count, if missing { null_mut() } else { texts.as_mut_ptr() });
                    if status == Status::OK {
                        texts
                            .iter()
                            .filter(|text| !text.is_null())
                            .for_each(|&text| assert!(CStr::from_ptr(text).to_str().is_ok()));
                    }
                    status
                }
            }
        }
    }

    /// Status functions and derivatives.
    fn ask(&mut self, (kind, a, b, c): Call) -> Status {
        let (library, handle) = (self.library, self.slave.handle);
        let status_kind = StatusKind(pick(&[0, 1, 2, 3, 4, -1], a));
        let (mut real, mut status, mut integer, mut text) = (0.0, Status::OK, 0, null());
        let references = [b, c].map(|choice| self.references[usize::from(choice) * 5 % self.references.len()]);
        let (unknowns, knowns) = ([200 + u32::from(a % 6), references[0]], [120 + u32::from(b % 6), references[1]]);
        let (seed, mut result) = ([pick(NUMBERS, c), 1.0], [0.0; 2]);
        let counts = [usize::from(b % 3), usize::from(c % 3)];
        // SAFETY: a live handle; results are NULL or one value, arrays NULL or at least as long as passed.
        unsafe {
            match kind {
                20 => (library.get_status)(handle, status_kind, &mut status),
                21 => (library.get_real_status)(handle, status_kind, if b < 40 { null_mut() } else { &mut real }),
                22 => (library.get_integer_status)(handle, status_kind, &mut integer),
                23 => (library.get_boolean_status)(handle, status_kind, if b < 40 { null_mut() } else { &mut integer }),
                24 => (library.get_string_status)(handle, status_kind, &mut text),
                _ => {
                    let seed = if a.is_multiple_of(17) { null() } else { seed.as_ptr() };
                    let result = if a.is_multiple_of(19) { null_mut() } else { result.as_mut_ptr() };
                    let (unknowns, knowns) = (unknowns.as_ptr(), knowns.as_ptr());
                    (library.get_directional_derivative)(handle, unknowns, counts[0], knowns, counts[1], seed, result)
                }
            }
        }
    }

    /// States: get, set, free, to and from bytes.
    fn keep(&mut self, (kind, a, b, _): Call) -> Status {
        let (library, handle) = (self.library, self.slave.handle);
        let chosen = self.state(a);
        // SAFETY: a live handle; states are NULL or live, buffers are NULL or of the size passed.
        unsafe {
            match kind {
                26 if b < 30 => (library.get_state)(handle, null_mut()),
                26 => {
                    let mut state = if b < 100 { chosen } else { null_mut() };
                    let status = (library.get_state)(handle, &mut state);
                    self.remember(state);
                    status
                }
                27 => (library.set_state)(handle, chosen),
                28 if b < 30 => (library.free_state)(handle, null_mut()),
                28 => {
                    let mut state = chosen;
                    let status = (library.free_state)(handle, &mut state);
                    assert!(state.is_null() || status != Status::OK, "freed and not NULL");
                    self.states.retain(|&kept| kept != chosen);
                    status
                }
                29 => self.serialize(chosen, b),
                _ => {
                    let mut state = null_mut();
                    let length = if b < 60 { self.bytes.len() / 2 } else { self.bytes.len() };
                    let buffer = if b < 20 { null() } else { self.bytes.as_ptr() };
                    let target = if (20..30).contains(&b) { null_mut() } else { &raw mut state };
                    let status = (library.deserialize)(handle, buffer.cast(), length.max(usize::from(b < 20)), target);
                    self.remember(state);
                    status
                }
            }
        }
    }

    fn serialize(&mut self, state: ffi::FmuState, b: u8) -> Status {
        let mut size = 0;
        // SAFETY: a live handle, a state that is NULL or live, a buffer that is NULL or of the size passed.
        unsafe {
            let length = if b < 20 { null_mut() } else { &raw mut size };
            let status = (self.library.serialized_size)(self.slave.handle, state, length);
            if status != Status::OK {
                return status;
            }
            let mut bytes = vec![0u8; if b < 60 { size / 2 } else { size }];
            let buffer = if (20..30).contains(&b) { null_mut() } else { bytes.as_mut_ptr() };
            let status = (self.library.serialize)(self.slave.handle, state, buffer.cast(), bytes.len());
            if status == Status::OK {
                self.bytes = bytes;
            }
            status
        }
    }

    fn remember(&mut self, state: ffi::FmuState) {
        if !state.is_null() && !self.states.contains(&state) {
            self.states.push(state);
        }
    }

    /// What a run is made of, so that sequences get somewhere.
    fn run(&mut self, (kind, a, b, c): Call) -> Status {
        match kind {
            31..=33 => {
                self.choose(usize::from(a) % SOUND);
                self.slave.initialise(0.0)
            }
            34 => {
                self.choose(usize::from(a));
                self.slave.initialise(pick(&[0.0, 1.0, -1.0, 1e300], b))
            }
            35..=39 => self.slave.step(self.time(), pick(&[1e-3, 2e-3, 5e-3], a)),
            _ => {
                let reference = pick(&[100, 103, 120, 123, 140, 143, 200, 201, 203, 220, 500, 512], b);
                self.slave.set_reals(&[reference], &[pick(&[1e-5, -1e-4, 0.01, 1.0], c)])
            }
        }
    }

    fn call(&mut self, call: Call) -> Status {
        match call.0 {
            0..=9 => self.live(call),
            10..=19 => self.access(call),
            20..=25 => self.ask(call),
            26..=30 => self.keep(call),
            31..=42 => self.run(call),
            _ => {
                self.instantiate(call.1, call.2);
                Status::OK
            }
        }
    }

    /// Whatever happened: after a reset a run is possible, and every state can be freed.
    fn mend(self) -> Result<(), TestCaseError> {
        let (library, slave) = (self.library, &self.slave);
        // SAFETY: a live handle.
        prop_assert_eq!(unsafe { (library.reset)(slave.handle) }, Status::OK, "{:?}", slave.messages());
        // The instance may have been given no resources: a path needs none.
        let (scene, overrides) = self.scenes[0];
        let path = root().join(format!("scenes/{scene}.toml"));
        prop_assert_eq!(
            (slave.set_text(1, path.to_str().unwrap()), slave.set_text(2, overrides)),
            (Status::OK, Status::OK)
        );
        prop_assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
        prop_assert_eq!(slave.step(0.0, 1e-3), Status::OK, "{:?}", slave.messages());
        for mut state in self.states {
            // SAFETY: a live handle and a live state, which is not used again.
            prop_assert_eq!(unsafe { (library.free_state)(slave.handle, &mut state) }, Status::OK);
        }
        Ok(())
    }
}

/// Runs sequences of up to 40 calls; returns how many calls were carried out and how many were not.
fn sequences<C: Component<Interface = Interface>>(
    name: &str,
    scenes: &'static [(&'static str, &'static str)],
    cases: u32,
) -> [u64; 2] {
    let library = Library::load(name).unwrap();
    let counts = [Cell::new(0), Cell::new(0)];
    let calls = prop::collection::vec((0..KINDS, any::<u8>(), any::<u8>(), any::<u8>()), 1..40);
    let outcome = TestRunner::new(fuzzing::config(cases)).run(&calls, |calls| {
        let mut world = World::new::<C>(&library, scenes);
        for call in calls {
            world.slave.messages();
            let status = world.call(call);
            let messages = world.slave.messages();
            prop_assert!(matches!(status, Status::OK | Status::DISCARD | Status::ERROR), "{call:?}: {status:?}");
            prop_assert!(status == Status::OK || !messages.is_empty(), "{call:?}: {status:?} without a message");
            prop_assert!(!messages.iter().any(|text| text.contains("internal error")), "{call:?}: {messages:?}");
            let count = &counts[usize::from(status != Status::OK)];
            count.set(count.get() + 1);
        }
        world.mend()
    });
    assert!(outcome.is_ok(), "{outcome:?}");
    let counts = counts.map(|count| count.get());
    println!("{name}: {} calls carried out, {} refused", counts[0], counts[1]);
    counts
}

#[test]
fn any_sequence_of_calls_of_the_fluid() {
    let [done, refused] = sequences::<FluidComponent>("fluid_fmu", WATER, 2000);
    assert!(done > 5000 && refused > 5000, "{done} done, {refused} refused");
}

#[test]
fn any_sequence_of_calls_of_the_structure() {
    let [done, refused] = sequences::<StructureComponent>("structure_fmu", BODIES, 4000);
    assert!(done > 5000 && refused > 5000, "{done} done, {refused} refused");
}

/// There is nobody to send a message to, and nothing to do.
#[test]
fn functions_without_an_instance() {
    for name in ["fluid_fmu", "structure_fmu"] {
        let library = Library::load(name).unwrap();
        let (mut state, mut size, mut real) = (null_mut(), 0, 0.0);
        // SAFETY: a NULL handle; results are values of their own.
        let statuses = unsafe {
            [
                (library.setup_experiment)(null_mut(), 0, 0.0, 0.0, 0, 0.0),
                (library.enter_initialization_mode)(null_mut()),
                (library.exit_initialization_mode)(null_mut()),
                (library.terminate)(null_mut()),
                (library.reset)(null_mut()),
                (library.do_step)(null_mut(), 0.0, 1.0, 0),
                (library.get_real)(null_mut(), &1, 1, &mut real),
                (library.set_real)(null_mut(), &1, 1, &1.0),
                (library.set_string)(null_mut(), null(), 0, null()),
                (library.get_state)(null_mut(), &mut state),
                (library.set_state)(null_mut(), null_mut()),
                (library.free_state)(null_mut(), &mut state),
                (library.serialized_size)(null_mut(), null_mut(), &mut size),
                (library.deserialize)(null_mut(), null(), 0, &mut state),
                (library.get_real_status)(null_mut(), StatusKind::LAST_SUCCESSFUL_TIME, &mut real),
                (library.set_debug_logging)(null_mut(), 1, 0, null()),
            ]
        };
        assert_eq!(statuses, [Status::ERROR; 16]);
        // SAFETY: NULL is allowed.
        unsafe { (library.free_instance)(null_mut()) };
    }
}
