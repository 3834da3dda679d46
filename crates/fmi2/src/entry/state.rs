//! States: get, set, free, to and from bytes.

use super::{call, slice, slice_mut};
use crate::Function;
use crate::ffi::{self, Byte, FmuState, Status};
use fmi::{Component, Failure, Snapshot};

/// fmi2GetFMUstate: a handle that is not NULL is overwritten.
pub unsafe fn get_state<C: Component>(component: ffi::Component, state: *mut FmuState) -> Status {
    // SAFETY: handle and state pointer as the standard passes them; a state that is not NULL came from this model.
    unsafe {
        call::<C>(component, |instance| {
            let handle = state.as_mut().ok_or_else(|| Failure::refused("FMUstate is a NULL pointer"))?;
            match handle.cast::<Snapshot<C::State>>().as_mut() {
                Some(old) => instance.get_state_into(old)?,
                None => *handle = Box::into_raw(Box::new(instance.get_state()?)).cast(),
            }
            Ok(())
        })
    }
}

fn missing(function: Function) -> Failure {
    Failure::refused(format!("{}: the state is NULL", function.name()))
}

/// fmi2SetFMUstate.
pub unsafe fn set_state<C: Component>(component: ffi::Component, state: FmuState) -> Status {
    // SAFETY: handle and state as the standard passes them; a state that is not NULL came from this model.
    unsafe {
        call::<C>(component, |instance| {
            let snapshot = state.cast::<Snapshot<C::State>>().as_ref().ok_or_else(|| missing(Function::SetFmuState))?;
            instance.set_state(snapshot)
        })
    }
}

/// fmi2FreeFMUstate: nothing for a NULL state; the handle is NULL afterwards.
pub unsafe fn free_state<C: Component>(component: ffi::Component, state: *mut FmuState) -> Status {
    // SAFETY: handle and state pointer as the standard passes them; a state that is not NULL came from this model and
    // is not used again.
    unsafe {
        call::<C>(component, |instance| {
            instance.allow(Function::FreeFmuState)?;
            let Some(handle) = state.as_mut().filter(|handle| !handle.is_null()) else { return Ok(()) };
            drop(Box::from_raw(handle.cast::<Snapshot<C::State>>()));
            *handle = std::ptr::null_mut();
            Ok(())
        })
    }
}

/// fmi2SerializedFMUstateSize \[bytes\].
pub unsafe fn serialized_size<C: Component>(component: ffi::Component, state: FmuState, size: *mut usize) -> Status {
    // SAFETY: handle, state and result as the standard passes them; a state that is not NULL came from this model.
    unsafe {
        call::<C>(component, |instance| {
            let function = Function::SerializedFmuStateSize;
            instance.allow(function)?;
            let snapshot = state.cast::<Snapshot<C::State>>().as_ref().ok_or_else(|| missing(function))?;
            *size.as_mut().ok_or_else(|| Failure::refused("size is a NULL pointer"))? = snapshot.size()?;
            Ok(())
        })
    }
}

/// fmi2SerializeFMUstate.
pub unsafe fn serialize<C: Component>(
    component: ffi::Component,
    state: FmuState,
    buffer: *mut Byte,
    size: usize,
) -> Status {
    // SAFETY: handle, state and buffer as the standard passes them; a state that is not NULL came from this model.
    unsafe {
        call::<C>(component, |instance| {
            let snapshot =
                state.cast::<Snapshot<C::State>>().as_ref().ok_or_else(|| missing(Function::SerializeFmuState))?;
            let bytes = instance.serialize(snapshot)?;
            let room = slice_mut(buffer.cast::<u8>(), size, "serializedState")?;
            let short = || Failure::refused(format!("buffer of {size} bytes: expected at least {}", bytes.len()));
            room.get_mut(..bytes.len()).ok_or_else(short)?.copy_from_slice(&bytes);
            Ok(())
        })
    }
}

/// fmi2DeSerializeFMUstate: a handle that is not NULL is overwritten.
pub unsafe fn deserialize<C: Component>(
    component: ffi::Component,
    buffer: *const Byte,
    size: usize,
    state: *mut FmuState,
) -> Status {
    // SAFETY: handle, buffer and state pointer as the standard passes them; a state that is not NULL came from this
    // model.
    unsafe {
        call::<C>(component, |instance| {
            let handle = state.as_mut().ok_or_else(|| Failure::refused("FMUstate is a NULL pointer"))?;
            let snapshot = instance.deserialize(slice(buffer.cast::<u8>(), size, "serializedState")?)?;
            match handle.cast::<Snapshot<C::State>>().as_mut() {
                Some(old) => *old = snapshot,
                None => *handle = Box::into_raw(Box::new(snapshot)).cast(),
            }
            Ok(())
        })
    }
}
