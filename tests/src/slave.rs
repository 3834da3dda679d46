//! One instance behind the C ABI, with its messages.

use crate::Library;
use fmi2::ffi::{self, Status};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};

unsafe extern "C" {
    fn plimsoll_test_logger(
        environment: *mut c_void,
        name: ffi::Text,
        status: Status,
        category: ffi::Text,
        format: ffi::Text,
        ...
    );
}

/// Receives what the C logger formatted.
///
/// # Safety
/// `environment` leads to the messages of a slave, the texts end with NUL.
#[unsafe(no_mangle)]
unsafe extern "C" fn plimsoll_test_receive(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: by the contract above; the instance that logs is used by one thread.
    let (messages, category, message) =
        unsafe { (&mut *environment.cast::<Vec<String>>(), CStr::from_ptr(category), CStr::from_ptr(message)) };
    messages.push(format!("{status} {}: {}", category.to_string_lossy(), message.to_string_lossy()));
}

/// A saved state; freed through its slave.
pub struct State(pub ffi::FmuState);

/// One instance. Functions return the status of the C function.
pub struct Slave<'a> {
    /// Its library.
    pub library: &'a Library,
    /// Its handle.
    pub handle: ffi::Component,
    messages: *mut Vec<String>,
}

impl<'a> Slave<'a> {
    /// Instantiates; on refusal the messages are the error.
    pub fn new(library: &'a Library, guid: &str, location: Option<&str>) -> Result<Self, Vec<String>> {
        let text = |text: &str| CString::new(text).map_err(|error| vec![error.to_string()]);
        let (guid, location) = (text(guid)?, location.map(text).transpose()?);
        let messages = Box::into_raw(Box::new(Vec::new()));
        let handle = {
            // The struct and the texts end with this block: the FMU must have copied them.
            let callbacks = ffi::CallbackFunctions {
                logger: Some(plimsoll_test_logger),
                allocate_memory: None,
                free_memory: None,
                step_finished: None,
                component_environment: messages.cast(),
            };
            // SAFETY: every pointer is NULL or valid during the call.
            unsafe {
                (library.instantiate)(
                    c"/the same/for all".as_ptr(),
                    ffi::Type::CO_SIMULATION,
                    guid.as_ptr(),
                    location.as_ref().map_or(null(), |location| location.as_ptr()),
                    &callbacks,
                    ffi::TRUE,
                    ffi::FALSE,
                )
            }
        };
        if handle.is_null() {
            // SAFETY: made above, and no instance holds it.
            return Err(*unsafe { Box::from_raw(messages) });
        }
        Ok(Self { library, handle, messages })
    }

    /// Takes the messages that came since the last call.
    pub fn messages(&self) -> Vec<String> {
        // SAFETY: lives as long as the slave; no call into the FMU is under way.
        std::mem::take(unsafe { &mut *self.messages })
    }

    /// fmi2SetupExperiment without stop time and tolerance, fmi2EnterInitializationMode.
    pub fn enter(&self, start: f64) -> Status {
        // SAFETY: a live handle.
        unsafe {
            match (self.library.setup_experiment)(self.handle, 0, 0.0, start, 0, 0.0) {
                Status::OK => (self.library.enter_initialization_mode)(self.handle),
                other => other,
            }
        }
    }

    /// As [`Self::enter`], then fmi2ExitInitializationMode.
    pub fn initialise(&self, start: f64) -> Status {
        match self.enter(start) {
            // SAFETY: a live handle.
            Status::OK => unsafe { (self.library.exit_initialization_mode)(self.handle) },
            other => other,
        }
    }

    /// fmi2SetString of one variable.
    pub fn set_text(&self, reference: u32, value: &str) -> Status {
        let value = CString::new(value).unwrap_or_default();
        // SAFETY: a live handle, arrays of one.
        unsafe { (self.library.set_string)(self.handle, &reference, 1, &value.as_ptr()) }
    }

    /// fmi2SetReal.
    pub fn set_reals(&self, references: &[u32], values: &[f64]) -> Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: a live handle, arrays of the length passed.
        unsafe { (self.library.set_real)(self.handle, references.as_ptr(), references.len(), values.as_ptr()) }
    }

    /// fmi2GetReal; panics when it does not return OK.
    pub fn reals(&self, references: &[u32]) -> Vec<f64> {
        let mut values = vec![f64::NAN; references.len()];
        // SAFETY: a live handle, arrays of the length passed.
        let status =
            unsafe { (self.library.get_real)(self.handle, references.as_ptr(), references.len(), values.as_mut_ptr()) };
        assert_eq!(status, Status::OK, "{:?}", self.messages());
        values
    }

    /// fmi2GetInteger of one variable; panics when it does not return OK.
    pub fn integer(&self, reference: u32) -> i32 {
        let mut value = i32::MIN;
        // SAFETY: a live handle, arrays of one.
        let status = unsafe { (self.library.get_integer)(self.handle, &reference, 1, &mut value) };
        assert_eq!(status, Status::OK, "{:?}", self.messages());
        value
    }

    /// fmi2DoStep.
    pub fn step(&self, time: f64, step: f64) -> Status {
        // SAFETY: a live handle.
        unsafe { (self.library.do_step)(self.handle, time, step, ffi::TRUE) }
    }

    /// fmi2GetFMUstate; panics when it does not return OK.
    pub fn save(&self) -> State {
        let mut state = null_mut();
        // SAFETY: a live handle and a NULL state.
        assert_eq!(unsafe { (self.library.get_state)(self.handle, &mut state) }, Status::OK);
        State(state)
    }

    /// fmi2SetFMUstate.
    pub fn restore(&self, state: &State) -> Status {
        // SAFETY: a live handle and a state of the same FMU.
        unsafe { (self.library.set_state)(self.handle, state.0) }
    }

    /// fmi2FreeFMUstate.
    pub fn free(&self, mut state: State) -> Status {
        // SAFETY: a live handle and a state of the same FMU that is not used again.
        unsafe { (self.library.free_state)(self.handle, &mut state.0) }
    }

    /// fmi2SerializedFMUstateSize and fmi2SerializeFMUstate; panics when one does not return OK.
    pub fn bytes(&self, state: &State) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: a live handle, a state of the same FMU, a buffer of the size passed.
        unsafe {
            assert_eq!((self.library.serialized_size)(self.handle, state.0, &mut size), Status::OK);
            let mut bytes = vec![0u8; size];
            let status = (self.library.serialize)(self.handle, state.0, bytes.as_mut_ptr().cast(), size);
            assert_eq!(status, Status::OK);
            bytes
        }
    }

    /// fmi2DeSerializeFMUstate.
    pub fn from_bytes(&self, bytes: &[u8]) -> Result<State, Status> {
        let mut state = null_mut();
        // SAFETY: a live handle, a buffer of the size passed, a NULL state.
        let status = unsafe { (self.library.deserialize)(self.handle, bytes.as_ptr().cast(), bytes.len(), &mut state) };
        if status == Status::OK { Ok(State(state)) } else { Err(status) }
    }
}

impl Drop for Slave<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is live and not used again; the messages were made by `new`.
        unsafe {
            (self.library.free_instance)(self.handle);
            drop(Box::from_raw(self.messages));
        }
    }
}
