//! Getters, setters, derivatives.

use super::{call, slice, slice_mut, text};
use crate::Function;
use crate::ffi::{self, Boolean, Integer, Real, Status, Text, ValueReference};
use fmi::{Component, Failure};

/// fmi2GetReal.
pub unsafe fn get_real<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    values: *mut Real,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.get_real(slice(references, count, "references")?, slice_mut(values, count, "values")?)
        })
    }
}

/// fmi2GetInteger.
pub unsafe fn get_integer<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    values: *mut Integer,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.get_integer(slice(references, count, "references")?, slice_mut(values, count, "values")?)
        })
    }
}

/// fmi2GetBoolean.
pub unsafe fn get_boolean<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    _values: *mut Boolean,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.no_boolean(Function::GetBoolean, slice(references, count, "references")?)
        })
    }
}

/// fmi2GetString; the strings live until the next call of it on the same instance.
pub unsafe fn get_string<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    values: *mut Text,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            let values = slice_mut(values, count, "values")?;
            let texts = instance.get_string(slice(references, count, "references")?)?;
            for (value, text) in values.iter_mut().zip(texts) {
                *value = text.as_ptr();
            }
            Ok(())
        })
    }
}

/// fmi2SetReal.
pub unsafe fn set_real<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    values: *const Real,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.set_real(slice(references, count, "references")?, slice(values, count, "values")?)
        })
    }
}

/// fmi2SetInteger.
pub unsafe fn set_integer<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    values: *const Integer,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.set_integer(slice(references, count, "references")?, slice(values, count, "values")?)
        })
    }
}

/// fmi2SetBoolean.
pub unsafe fn set_boolean<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    _values: *const Boolean,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            instance.no_boolean(Function::SetBoolean, slice(references, count, "references")?)
        })
    }
}

/// fmi2SetString.
pub unsafe fn set_string<C: Component>(
    component: ffi::Component,
    references: *const ValueReference,
    count: usize,
    values: *const Text,
) -> Status {
    // SAFETY: handle, arrays and strings as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            let pointers = slice(values, count, "values")?;
            let texts: Result<Vec<&str>, Failure> = pointers.iter().map(|&pointer| text(pointer, "value")).collect();
            instance.set_string(slice(references, count, "references")?, &texts?)
        })
    }
}

/// fmi2GetDirectionalDerivative.
pub unsafe fn get_directional_derivative<C: Component>(
    component: ffi::Component,
    unknowns: *const ValueReference,
    unknown_count: usize,
    knowns: *const ValueReference,
    known_count: usize,
    seed: *const Real,
    result: *mut Real,
) -> Status {
    // SAFETY: handle and arrays as the standard passes them.
    unsafe {
        call::<C>(component, |instance| {
            let derivatives = instance.directional_derivative(
                slice(unknowns, unknown_count, "unknowns")?,
                slice(knowns, known_count, "knowns")?,
                slice(seed, known_count, "seed")?,
            )?;
            slice_mut(result, unknown_count, "result")?.copy_from_slice(&derivatives);
            Ok(())
        })
    }
}

/// fmi2SetRealInputDerivatives and fmi2GetRealOutputDerivatives: neither is offered (canInterpolateInputs = false,
/// maxOutputDerivativeOrder = 0).
pub unsafe fn no_derivatives<C: Component>(component: ffi::Component, count: usize, function: Function) -> Status {
    // SAFETY: handle as the standard passes it.
    unsafe {
        call::<C>(component, |instance| {
            instance.allow(function)?;
            match count {
                0 => Ok(()),
                _ => Err(Failure::refused(format!("{} is not supported by this model", function.name()))),
            }
        })
    }
}
