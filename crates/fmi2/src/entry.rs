//! The C functions of the standard for one model `C`. [`crate::export!`] gives them their exported names.
//!
//! Every function catches panics: one that crossed the ABI would end the importer's process. A panic breaks the
//! instance and gives fmi2Error; fmi2Fatal would declare every instance of every FMU dead.

#![allow(clippy::missing_safety_doc, reason = "every function has the contract stated in the standard for its name")]

mod life;
mod state;
mod value;

pub use life::*;
pub use state::*;
pub use value::*;

use crate::Instance;
use crate::ffi::{self, Status};
use fmi::{Component, Failure};
use std::any::Any;
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Calls a method on the instance behind a handle; messages, status and panics are dealt with here.
///
/// # Safety
/// The handle is NULL or came from [`instantiate`] of the same model and is used by no other thread meanwhile.
unsafe fn call<C: Component>(
    component: ffi::Component,
    body: impl FnOnce(&mut Instance<C>) -> Result<(), Failure>,
) -> Status {
    // SAFETY: by the contract above the pointer is NULL or a live, exclusively used instance of this type.
    let Some(instance) = (unsafe { component.cast::<Instance<C>>().as_mut() }) else {
        return Status::ERROR;
    };
    let failure = match catch_unwind(AssertUnwindSafe(|| body(instance))) {
        Ok(Ok(())) => return Status::OK,
        Ok(Err(failure)) => failure,
        Err(panic) => Failure::broken(format!("internal error: {}", panic_text(panic.as_ref()))),
    };
    instance.tell(&failure);
    failure.status.into()
}

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_string());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "unknown panic".to_string())
}

/// An array argument as a slice; empty for a count of 0, whatever the pointer.
///
/// # Safety
/// A pointer that is not NULL leads to `count` values that nobody changes during the call.
unsafe fn slice<'a, T>(pointer: *const T, count: usize, what: &str) -> Result<&'a [T], Failure> {
    match (count, pointer.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err(Failure::refused(format!("{what}: NULL pointer for {count} values"))),
        // SAFETY: not NULL and `count` values long by the contract above.
        _ => Ok(unsafe { std::slice::from_raw_parts(pointer, count) }),
    }
}

/// As [`slice()`], for results.
///
/// # Safety
/// A pointer that is not NULL leads to `count` writable, initialised values that nobody else uses during the call.
unsafe fn slice_mut<'a, T>(pointer: *mut T, count: usize, what: &str) -> Result<&'a mut [T], Failure> {
    match (count, pointer.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err(Failure::refused(format!("{what}: NULL pointer for {count} values"))),
        // SAFETY: not NULL, exclusive and `count` values long by the contract above.
        _ => Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) }),
    }
}

/// A C string argument.
///
/// # Safety
/// A pointer that is not NULL leads to a string that ends with NUL and lives during the call.
unsafe fn text<'a>(pointer: ffi::Text, what: &str) -> Result<&'a str, Failure> {
    if pointer.is_null() {
        return Err(Failure::refused(format!("{what} is NULL")));
    }
    // SAFETY: not NULL and ended by NUL by the contract above.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|error| Failure::refused(format!("{what} is not UTF-8: {error}")))
}
