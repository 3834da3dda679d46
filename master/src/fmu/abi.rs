//! C types of FMI 2.0 co-simulation as an importer sees them (FMI 2.0.5, headers fmi2TypesPlatform.h and
//! fmi2FunctionTypes.h). Status codes stay integers: an unknown one must not be undefined behaviour.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// fmi2Status: 0 OK, 1 warning, 2 discard, 3 error, 4 fatal, 5 pending.
pub type Status = c_int;
/// fmi2Component.
pub type Component = *mut c_void;
/// fmi2FMUstate.
pub type StateHandle = *mut c_void;
/// fmi2Boolean.
pub type Boolean = c_int;
/// fmi2ValueReference.
pub type Reference = c_uint;
/// fmi2String.
pub type Text = *const c_char;

/// fmi2True.
pub const TRUE: Boolean = 1;
/// fmi2False.
pub const FALSE: Boolean = 0;
/// fmi2CoSimulation.
pub const CO_SIMULATION: c_int = 1;
/// fmi2OK.
pub const OK: Status = 0;
/// fmi2Warning.
pub const WARNING: Status = 1;
/// fmi2Discard.
pub const DISCARD: Status = 2;
/// fmi2Error.
pub const ERROR: Status = 3;

/// The word of a status code.
pub fn status_name(status: Status) -> String {
    match status {
        0 => "fmi2OK".to_string(),
        1 => "fmi2Warning".to_string(),
        2 => "fmi2Discard".to_string(),
        3 => "fmi2Error".to_string(),
        4 => "fmi2Fatal".to_string(),
        5 => "fmi2Pending".to_string(),
        other => format!("the unknown status {other}"),
    }
}

/// fmi2CallbackLogger.
pub type Logger = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text, ...);

/// fmi2CallbackFunctions.
#[repr(C)]
pub struct Callbacks {
    /// Receives messages.
    pub logger: Logger,
    /// calloc.
    pub allocate_memory: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    /// free.
    pub free_memory: unsafe extern "C" fn(*mut c_void),
    /// fmi2StepFinished; not used by synchronous steps.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    /// Handed back to the logger.
    pub environment: *mut c_void,
}

unsafe extern "C" {
    /// The shim in source/logger.c.
    pub fn plimsoll_logger(
        environment: *mut c_void,
        instance: Text,
        status: Status,
        category: Text,
        message: Text,
        ...
    );
    /// The C library's.
    pub fn calloc(count: usize, size: usize) -> *mut c_void;
    /// The C library's.
    pub fn free(memory: *mut c_void);
}

/// fmi2InstantiateTYPE.
pub type Instantiate = unsafe extern "C" fn(Text, c_int, Text, Text, *const Callbacks, Boolean, Boolean) -> Component;
/// fmi2FreeInstanceTYPE.
pub type FreeInstance = unsafe extern "C" fn(Component);
/// fmi2SetupExperimentTYPE.
pub type SetupExperiment = unsafe extern "C" fn(Component, Boolean, f64, f64, Boolean, f64) -> Status;
/// Functions of the component alone.
pub type Plain = unsafe extern "C" fn(Component) -> Status;
/// fmi2GetXxxTYPE.
pub type Get<T> = unsafe extern "C" fn(Component, *const Reference, usize, *mut T) -> Status;
/// fmi2SetXxxTYPE.
pub type Set<T> = unsafe extern "C" fn(Component, *const Reference, usize, *const T) -> Status;
/// fmi2GetFMUstateTYPE and fmi2FreeFMUstateTYPE.
pub type StateByAddress = unsafe extern "C" fn(Component, *mut StateHandle) -> Status;
/// fmi2SetFMUstateTYPE.
pub type StateByValue = unsafe extern "C" fn(Component, StateHandle) -> Status;
/// fmi2GetDirectionalDerivativeTYPE.
pub type Derivative =
    unsafe extern "C" fn(Component, *const Reference, usize, *const Reference, usize, *const f64, *mut f64) -> Status;
/// fmi2DoStepTYPE.
pub type DoStep = unsafe extern "C" fn(Component, f64, f64, Boolean) -> Status;
/// fmi2GetVersionTYPE and fmi2GetTypesPlatformTYPE.
pub type Version = unsafe extern "C" fn() -> Text;
