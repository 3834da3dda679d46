//! Instantiation, life cycle and steps.

use super::{call, panic_text, slice, text};
use crate::ffi::{self, Boolean, CallbackFunctions, Real, Status, StatusKind, Text, Type};
use crate::{Function, Instance, callback, resources};
use fmi::{Component, Failure, Logger};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// fmi2Instantiate.
pub unsafe fn instantiate<C: Component>(
    name: Text,
    kind: Type,
    guid: Text,
    location: Text,
    callbacks: *const CallbackFunctions,
    _visible: Boolean,
    logging_on: Boolean,
) -> ffi::Component {
    // SAFETY: the standard passes NULL or a valid struct; it is copied because it is valid during this call only.
    let functions = unsafe { callbacks.as_ref() }.copied();
    let logger = |name: &str| match functions {
        Some(functions) => callback::logger(functions, name, logging_on != ffi::FALSE),
        None => Logger::silent(),
    };
    let body = || -> Result<Instance<C>, Failure> {
        // SAFETY: strings of the importer as the standard passes them, valid during this call.
        let (name, guid) = unsafe { (text(name, "instanceName")?, text(guid, "fmuGUID")?) };
        if name.trim().is_empty() {
            return Err(Failure::refused("instanceName is empty: expected a name"));
        }
        if kind != Type::CO_SIMULATION {
            return Err(Failure::refused(format!("fmuType {}: expected fmi2CoSimulation (1)", kind.0)));
        }
        let folder = if location.is_null() {
            None
        } else {
            // SAFETY: as above.
            let location = unsafe { text(location, "fmuResourceLocation")? };
            let unknown = || Failure::refused(format!("fmuResourceLocation '{location}': expected a file URI"));
            if location.is_empty() { None } else { Some(resources::folder(location).ok_or_else(unknown)?) }
        };
        Instance::with_guid(guid, folder, logger(name))
    };
    let message = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(instance)) => return Box::into_raw(Box::new(instance)).cast(),
        Ok(Err(failure)) => failure.message,
        Err(panic) => format!("internal error: {}", panic_text(panic.as_ref())),
    };
    // SAFETY: as above; a name that cannot be read is replaced.
    let shown = unsafe { text(name, "instanceName") }.unwrap_or("unnamed instance");
    logger(shown).send(fmi::Status::Error, &message);
    std::ptr::null_mut()
}

/// fmi2FreeInstance; NULL is allowed.
pub unsafe fn free_instance<C: Component>(component: ffi::Component) {
    if component.is_null() {
        return;
    }
    // SAFETY: not NULL, so it came from `instantiate` of this model and is not used again.
    let instance = unsafe { Box::from_raw(component.cast::<Instance<C>>()) };
    // A panic while dropping has nobody left to be told.
    let _ = catch_unwind(AssertUnwindSafe(|| drop(instance)));
}

/// fmi2SetDebugLogging.
pub unsafe fn set_debug_logging<C: Component>(
    component: ffi::Component,
    on: Boolean,
    count: usize,
    categories: *const Text,
) -> Status {
    // SAFETY: handle and strings as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            let pointers = slice(categories, count, "categories")?;
            let names: Result<Vec<String>, Failure> =
                pointers.iter().map(|&pointer| text(pointer, "category").map(str::to_string)).collect();
            instance.set_debug_logging(on != ffi::FALSE, &names?)
        })
    }
}

/// fmi2SetupExperiment.
pub unsafe fn setup_experiment<C: Component>(
    component: ffi::Component,
    tolerance_defined: Boolean,
    tolerance: Real,
    start: Real,
    stop_defined: Boolean,
    stop: Real,
) -> Status {
    let defined = |flag: Boolean, value: Real| (flag != ffi::FALSE).then_some(value);
    // SAFETY: handle as the standard passes it.
    unsafe {
        call::<C>(component, |instance| {
            instance.setup_experiment(defined(tolerance_defined, tolerance), start, defined(stop_defined, stop))
        })
    }
}

/// fmi2EnterInitializationMode.
pub unsafe fn enter_initialization_mode<C: Component>(component: ffi::Component) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe { call::<C>(component, Instance::enter_initialization_mode) }
}

/// fmi2ExitInitializationMode.
pub unsafe fn exit_initialization_mode<C: Component>(component: ffi::Component) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe { call::<C>(component, Instance::exit_initialization_mode) }
}

/// fmi2Terminate.
pub unsafe fn terminate<C: Component>(component: ffi::Component) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe { call::<C>(component, Instance::terminate) }
}

/// fmi2Reset.
pub unsafe fn reset<C: Component>(component: ffi::Component) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe { call::<C>(component, Instance::reset) }
}

/// fmi2DoStep. `noSetFMUStatePriorToCurrentPoint` is not used: importers that roll back pass true as well.
pub unsafe fn do_step<C: Component>(
    component: ffi::Component,
    time: Real,
    step: Real,
    _no_rollback: Boolean,
) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe { call::<C>(component, |instance| instance.do_step(time, step)) }
}

/// fmi2CancelStep: steps are never asynchronous, so there is none to cancel.
pub unsafe fn cancel_step<C: Component>(component: ffi::Component) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe { call::<C>(component, |instance| instance.allow(Function::CancelStep)) }
}

fn unknown_kind(function: Function, kind: StatusKind) -> Failure {
    Failure::discard(format!("{}: status kind {} has no value here", function.name(), kind.0))
}

/// fmi2GetRealStatus: the last successful time \[s\].
pub unsafe fn get_real_status<C: Component>(component: ffi::Component, kind: StatusKind, value: *mut Real) -> Status {
    // SAFETY: handle and result as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.allow(Function::GetRealStatus)?;
            match (kind, value.as_mut()) {
                (StatusKind::LAST_SUCCESSFUL_TIME, Some(value)) => *value = instance.time(),
                _ => return Err(unknown_kind(Function::GetRealStatus, kind)),
            }
            Ok(())
        })
    }
}

/// fmi2GetBooleanStatus: whether the model wants to end the run, which it never does.
pub unsafe fn get_boolean_status<C: Component>(
    component: ffi::Component,
    kind: StatusKind,
    value: *mut Boolean,
) -> Status {
    // SAFETY: handle and result as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.allow(Function::GetBooleanStatus)?;
            match (kind, value.as_mut()) {
                (StatusKind::TERMINATED, Some(value)) => *value = ffi::FALSE,
                _ => return Err(unknown_kind(Function::GetBooleanStatus, kind)),
            }
            Ok(())
        })
    }
}

/// fmi2GetStatus, fmi2GetIntegerStatus, fmi2GetStringStatus: they tell of asynchronous steps, of which there are none.
pub unsafe fn no_status<C: Component>(component: ffi::Component, kind: StatusKind, function: Function) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe {
        call::<C>(component, |instance| {
            instance.allow(function)?;
            Err(unknown_kind(function, kind))
        })
    }
}
