//! The export layer around a toy model, through the functions behind the C ABI and in process.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

mod common;

use common::Toy;
use fmi::{Component, Logger, Mode};
use fmi2::ffi::{self, Status, StatusKind};
use fmi2::{Instance, describe, entry};
use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

fn guid(outputs: usize) -> CString {
    CString::new(describe::guid(&Toy::model(&outputs)).unwrap().to_string()).unwrap()
}

/// An instance behind a C handle.
fn handle() -> ffi::Component {
    let guid = guid(1);
    // SAFETY: strings live during the call, the rest is NULL as the standard allows.
    unsafe {
        entry::instantiate::<Toy>(
            c"/tmp/some path".as_ptr(),
            ffi::Type::CO_SIMULATION,
            guid.as_ptr(),
            null(),
            null(),
            ffi::TRUE,
            ffi::TRUE,
        )
    }
}

fn ready() -> ffi::Component {
    let component = handle();
    // SAFETY: a live handle.
    unsafe {
        assert_eq!(entry::setup_experiment::<Toy>(component, 0, 0.0, 0.0, 0, 0.0), Status::OK);
        assert_eq!(entry::enter_initialization_mode::<Toy>(component), Status::OK);
        assert_eq!(entry::exit_initialization_mode::<Toy>(component), Status::OK);
    }
    component
}

fn set(component: ffi::Component, reference: u32, value: f64) -> Status {
    // SAFETY: a live handle and arrays of one.
    unsafe { entry::set_real::<Toy>(component, &reference, 1, &value) }
}

fn get(component: ffi::Component, reference: u32) -> f64 {
    let mut value = f64::NAN;
    // SAFETY: a live handle and arrays of one.
    assert_eq!(unsafe { entry::get_real::<Toy>(component, &reference, 1, &mut value) }, Status::OK);
    value
}

fn step(component: ffi::Component, time: f64, step: f64) -> Status {
    // SAFETY: a live handle.
    unsafe { entry::do_step::<Toy>(component, time, step, ffi::TRUE) }
}

fn free(component: ffi::Component) {
    // SAFETY: a live handle that is not used again.
    unsafe { entry::free_instance::<Toy>(component) }
}

#[test]
fn instantiation_is_refused_for_wrong_arguments() {
    let (right, wrong) = (guid(1), c"{00000000-0000-0000-0000-000000000000}");
    let make = |name: ffi::Text, kind: ffi::Type, guid: ffi::Text| {
        // SAFETY: strings are NULL or live during the call.
        unsafe { entry::instantiate::<Toy>(name, kind, guid, null(), null(), 0, 0) }
    };
    let slave = ffi::Type::CO_SIMULATION;
    assert!(make(c"a".as_ptr(), slave, wrong.as_ptr()).is_null());
    assert!(make(null(), slave, right.as_ptr()).is_null());
    assert!(make(c"".as_ptr(), slave, right.as_ptr()).is_null());
    assert!(make(c"a".as_ptr(), slave, null()).is_null());
    assert!(make(c"a".as_ptr(), ffi::Type::MODEL_EXCHANGE, right.as_ptr()).is_null());
    assert!(make(c"a".as_ptr(), ffi::Type(42), right.as_ptr()).is_null());
    let braces = CString::new(format!("{{{}}}", right.to_str().unwrap().to_uppercase())).unwrap();
    let component = make(c"a".as_ptr(), slave, braces.as_ptr());
    assert!(!component.is_null());
    free(component);
    free(null_mut());
}

#[test]
fn a_panic_breaks_one_instance_and_nothing_else() {
    let (first, second) = (ready(), ready());
    let mut state = null_mut();
    // SAFETY: live handles and a state of the same model.
    unsafe {
        assert_eq!(entry::get_state::<Toy>(first, &mut state), Status::OK);
        assert_eq!(set(first, 2, 666.0), Status::OK);
        assert_eq!(step(first, 0.0, 0.1), Status::ERROR);
        assert_eq!(step(first, 0.0, 0.1), Status::ERROR, "a broken instance does not step");
        assert_eq!(step(second, 0.0, 0.1), Status::OK, "the other one does");
        assert_eq!(entry::set_state::<Toy>(first, state), Status::OK);
        assert_eq!(step(first, 0.0, 0.1), Status::OK, "a restored one as well");
        assert_eq!(entry::free_state::<Toy>(first, &mut state), Status::OK);
        assert!(state.is_null());
        assert_eq!(entry::free_state::<Toy>(first, &mut state), Status::OK, "nothing to free is no error");
    }
    free(first);
    free(second);
}

#[test]
fn calls_out_of_order_are_refused_and_change_nothing() {
    let component = handle();
    // SAFETY: a live handle.
    unsafe {
        assert_eq!(step(component, 0.0, 0.1), Status::ERROR);
        assert_eq!(entry::exit_initialization_mode::<Toy>(component), Status::ERROR);
        assert_eq!(entry::terminate::<Toy>(component), Status::ERROR);
        assert_eq!(entry::enter_initialization_mode::<Toy>(component), Status::OK);
        assert_eq!(entry::enter_initialization_mode::<Toy>(component), Status::ERROR);
        assert_eq!(entry::setup_experiment::<Toy>(component, 0, 0.0, 0.0, 0, 0.0), Status::ERROR);
        assert_eq!(entry::exit_initialization_mode::<Toy>(component), Status::OK);
        assert_eq!(entry::cancel_step::<Toy>(component), Status::ERROR);
        assert_eq!(step(component, 0.0, 0.1), Status::OK);
        assert_eq!(entry::terminate::<Toy>(component), Status::OK);
        assert_eq!(step(component, 0.1, 0.1), Status::ERROR);
        assert_eq!(get(component, 10), 200.0);
        assert_eq!(entry::reset::<Toy>(component), Status::OK);
        assert_eq!(entry::enter_initialization_mode::<Toy>(component), Status::OK);
        assert_eq!(entry::do_step::<Toy>(null_mut(), 0.0, 0.1, 0), Status::ERROR, "NULL instance");
    }
    free(component);
}

#[test]
fn a_discarded_step_tells_the_last_successful_time() {
    let component = ready();
    let (mut time, mut flag, mut number) = (f64::NAN, -1, -1);
    assert_eq!(step(component, 0.0, 0.5), Status::OK);
    assert_eq!(set(component, 2, 13.0), Status::OK);
    assert_eq!(step(component, 0.5, 0.5), Status::DISCARD);
    // SAFETY: a live handle and results of one.
    unsafe {
        let status = entry::get_real_status::<Toy>(component, StatusKind::LAST_SUCCESSFUL_TIME, &mut time);
        assert_eq!((status, time), (Status::OK, 0.5));
        let status = entry::get_boolean_status::<Toy>(component, StatusKind::TERMINATED, &mut flag);
        assert_eq!((status, flag), (Status::OK, ffi::FALSE));
        let status = entry::get_real_status::<Toy>(component, StatusKind::PENDING_STATUS, &mut time);
        assert_eq!(status, Status::DISCARD);
        let kind = fmi2::Function::GetIntegerStatus;
        assert_eq!(entry::no_status::<Toy>(component, StatusKind(99), kind), Status::DISCARD);
        assert_eq!(entry::get_integer::<Toy>(component, &1, 1, &mut number), Status::OK);
    }
    assert_eq!(step(component, 0.5, 0.25), Status::ERROR, "only a restored state goes on");
    free(component);
}

#[test]
fn times_are_checked_with_tolerance() {
    let component = ready();
    assert_eq!(step(component, 0.0, 0.1), Status::OK);
    assert_eq!(step(component, 0.1, 0.2), Status::OK);
    // 0.1 + 0.2 is 0.30000000000000004.
    assert_eq!(step(component, 0.3, 0.099_999_999_999_999_98), Status::OK);
    for (time, length) in [(0.0, 0.1), (0.5, 0.1), (f64::NAN, 0.1)] {
        assert_eq!(step(component, time, length), Status::ERROR, "{time}");
    }
    for length in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert_eq!(step(component, 0.4, length), Status::ERROR, "{length}");
    }
    assert_eq!(step(component, 0.4, 0.1), Status::OK);
    free(component);
}

#[test]
fn values_are_checked_at_the_border() {
    let component = handle();
    assert_eq!(set(component, 1, 11.0), Status::DISCARD, "out of range");
    assert_eq!(set(component, 1, 3.0), Status::OK);
    assert_eq!(set(component, 10, 1.0), Status::ERROR, "an output");
    assert_eq!(set(component, 99, 1.0), Status::ERROR, "no such variable");
    assert_eq!(set(component, 2, 5.0), Status::OK, "inputs are taken right after instantiation");
    // SAFETY: a live handle.
    unsafe {
        assert_eq!(entry::enter_initialization_mode::<Toy>(component), Status::OK);
        assert_eq!(get(component, 10), 300.0);
        assert_eq!(set(component, 1, 4.0), Status::OK);
        assert_eq!(get(component, 10), 400.0, "a parameter changed in initialization mode counts");
        assert_eq!(entry::exit_initialization_mode::<Toy>(component), Status::OK);
    }
    assert_eq!(set(component, 1, 4.0), Status::ERROR, "fixed after initialization");
    assert_eq!(set(component, 2, f64::NAN), Status::ERROR);
    assert_eq!(step(component, 0.0, 0.1), Status::ERROR, "after a NaN nothing goes on");
    free(component);
}

#[test]
fn texts_live_until_the_next_call() {
    let component = ready();
    let (mut first, mut second) = (null(), null());
    // SAFETY: a live handle; the text is read before the next call of the getter.
    unsafe {
        assert_eq!(entry::get_string::<Toy>(component, &1, 1, &mut first), Status::OK);
        assert_eq!(CStr::from_ptr(first), c"toy");
        assert_eq!(entry::get_string::<Toy>(component, &1, 1, &mut second), Status::OK);
        assert_eq!(CStr::from_ptr(second), c"toy");
        assert_eq!(entry::get_string::<Toy>(component, &7, 1, &mut second), Status::ERROR);
        assert_eq!(entry::get_boolean::<Toy>(component, null(), 0, null_mut()), Status::OK);
        assert_eq!(entry::get_boolean::<Toy>(component, &1, 1, &mut 0), Status::ERROR);
        assert_eq!(entry::get_real::<Toy>(component, null(), 1, null_mut()), Status::ERROR, "NULL array");
    }
    free(component);
}

#[test]
fn states_go_through_bytes_and_buffers_are_checked() {
    let (first, second) = (ready(), ready());
    let (mut state, mut copy, mut size) = (null_mut(), null_mut(), 0);
    assert_eq!(set(first, 2, 0.1), Status::OK);
    assert_eq!(step(first, 0.0, 0.1), Status::OK);
    // SAFETY: live handles, states of the same model, a buffer of the size passed.
    unsafe {
        assert_eq!(entry::get_state::<Toy>(first, &mut state), Status::OK);
        assert_eq!(entry::serialized_size::<Toy>(first, state, &mut size), Status::OK);
        let mut bytes = vec![0u8; size];
        assert_eq!(entry::serialize::<Toy>(first, state, bytes.as_mut_ptr().cast(), size - 1), Status::ERROR);
        assert_eq!(entry::serialize::<Toy>(first, state, bytes.as_mut_ptr().cast(), size), Status::OK);
        assert_eq!(entry::deserialize::<Toy>(second, bytes.as_ptr().cast(), size, &mut copy), Status::OK);
        let before = copy;
        assert_eq!(entry::get_state::<Toy>(first, &mut copy), Status::OK);
        assert_eq!(before, copy, "a handle that is not NULL is overwritten");
        bytes[60] ^= 1;
        assert_eq!(entry::deserialize::<Toy>(second, bytes.as_ptr().cast(), size, &mut copy), Status::ERROR);
        assert_eq!(entry::set_state::<Toy>(second, copy), Status::OK);
        assert_eq!(entry::set_state::<Toy>(second, null_mut()), Status::ERROR);
        for component in [first, second] {
            assert_eq!(step(component, 0.1, 0.1), Status::OK);
        }
        assert_eq!(get(first, 10).to_bits(), get(second, 10).to_bits());
        assert_eq!(entry::free_state::<Toy>(first, &mut state), Status::OK);
        assert_eq!(entry::free_state::<Toy>(second, &mut copy), Status::OK);
    }
    free(first);
    free(second);
}

#[test]
fn in_process_the_same_rules_hold() {
    let mut instance = Instance::<Toy>::new(0, None, Logger::silent()).unwrap();
    instance.setup_experiment(None, 0.0, Some(0.3)).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance.set_real(&[2], &[1.0]).unwrap();
    let before = instance.get_state().unwrap();
    for step in 0..3 {
        instance.do_step(0.1 * f64::from(step), 0.1).unwrap();
    }
    let message = instance.do_step(0.3, 0.1).unwrap_err().message;
    assert!(message.contains("stop time 0.3"), "{message}");
    instance.set_state(&before).unwrap();
    assert_eq!(instance.time(), 0.0);
    let failure = instance.set_real(&[2], &[f64::INFINITY]).unwrap_err();
    assert!(failure.message.contains("u = inf") && instance.mode() == Mode::Error, "{failure}");
}

/// The resources say which variables there are, and the GUID that they are those of the description.
#[test]
fn the_interface_is_that_of_the_resources() {
    let make = |outputs: usize, resources: Option<&str>| {
        let guid = guid(outputs).into_string().unwrap();
        Instance::<Toy>::with_guid(&guid, resources.map(Into::into), Logger::silent())
            .map_err(|failure| failure.message)
    };
    let variables = |instance: Instance<Toy>| instance.model().variables.len();
    assert_eq!(variables(make(2, Some("/toy/2")).unwrap()), variables(make(1, None).unwrap()) + 1);
    let message = make(2, None).err().unwrap();
    assert!(message.contains("the importer gave no fmuResourceLocation"), "{message}");
    let message = make(1, Some("/toy/2")).err().unwrap();
    assert!(message.contains("modelDescription.xml, resources and binary are not of the same build"), "{message}");
    assert!(make(1, Some("/toy/many")).err().unwrap().contains("resources 'many'"));
}

#[test]
fn a_bad_parameter_stops_the_initialisation_with_its_message() {
    let mut instance = Instance::<Toy>::new(0, None, Logger::silent()).unwrap();
    instance.set_string(&[1], &["bad"]).unwrap();
    let failure = instance.enter_initialization_mode().unwrap_err();
    assert!(failure.message.contains("'bad'") && instance.mode() == Mode::Error, "{failure}");
    instance.reset().unwrap();
    instance.enter_initialization_mode().unwrap();
}

#[test]
fn description_escapes_and_writes_dependencies() {
    let text = describe::xml(&Toy::model(&1)).unwrap();
    assert!(text.contains("factor, &lt;1 &amp; &gt;0"), "{text}");
    let unknowns = text.lines().filter(|line| line.contains("<Unknown "));
    let unknowns: Vec<&str> = unknowns.map(str::trim).collect();
    assert_eq!(
        unknowns,
        [
            r#"<Unknown index="5" dependencies=""/>"#,
            r#"<Unknown index="6" dependencies=""/>"#,
            r#"<Unknown index="5" dependencies="1 2 3"/>"#,
            r#"<Unknown index="6" dependencies="1 2 3"/>"#,
        ]
    );
    assert_ne!(guid(0), guid(1));
}
