//! The types of fmi2TypesPlatform.h and fmi2FunctionTypes.h.
//!
//! Every value that comes from the other side of the ABI is a number in a transparent wrapper, never a Rust enum:
//! an unknown number would be undefined behaviour there.

#![allow(missing_docs, reason = "names and order are those of the standard's headers, see FMI 2.0.5 chapter 2")]

use std::ffi::{c_char, c_int, c_uint, c_void};

pub type Component = *mut c_void;
pub type ComponentEnvironment = *mut c_void;
pub type FmuState = *mut c_void;
pub type ValueReference = c_uint;
pub type Real = f64;
pub type Integer = c_int;
pub type Boolean = c_int;
pub type Char = c_char;
pub type Text = *const c_char;
pub type Byte = c_char;

pub const TRUE: Boolean = 1;
pub const FALSE: Boolean = 0;

/// fmi2Status.
#[repr(transparent)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Status(pub c_int);

impl Status {
    pub const OK: Self = Self(0);
    pub const WARNING: Self = Self(1);
    pub const DISCARD: Self = Self(2);
    pub const ERROR: Self = Self(3);
    pub const FATAL: Self = Self(4);
    pub const PENDING: Self = Self(5);

    /// The name in the standard, or `unknown` for a number that the standard does not define.
    pub fn name(self) -> &'static str {
        match self {
            Self::OK => "fmi2OK",
            Self::WARNING => "fmi2Warning",
            Self::DISCARD => "fmi2Discard",
            Self::ERROR => "fmi2Error",
            Self::FATAL => "fmi2Fatal",
            Self::PENDING => "fmi2Pending",
            _ => "unknown",
        }
    }
}

impl From<fmi::Status> for Status {
    fn from(status: fmi::Status) -> Self {
        match status {
            fmi::Status::Ok => Self::OK,
            fmi::Status::Warning => Self::WARNING,
            fmi::Status::Discard => Self::DISCARD,
            fmi::Status::Error => Self::ERROR,
        }
    }
}

/// fmi2Type.
#[repr(transparent)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Type(pub c_int);

impl Type {
    pub const MODEL_EXCHANGE: Self = Self(0);
    pub const CO_SIMULATION: Self = Self(1);
}

/// fmi2StatusKind.
#[repr(transparent)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StatusKind(pub c_int);

impl StatusKind {
    pub const DO_STEP_STATUS: Self = Self(0);
    pub const PENDING_STATUS: Self = Self(1);
    pub const LAST_SUCCESSFUL_TIME: Self = Self(2);
    pub const TERMINATED: Self = Self(3);
}

/// fmi2CallbackLogger: variadic, so an importer written in Rust needs a C function for it.
pub type CallbackLogger = unsafe extern "C" fn(ComponentEnvironment, Text, Status, Text, Text, ...);
pub type CallbackAllocateMemory = unsafe extern "C" fn(usize, usize) -> *mut c_void;
pub type CallbackFreeMemory = unsafe extern "C" fn(*mut c_void);
pub type StepFinished = unsafe extern "C" fn(ComponentEnvironment, Status);

/// fmi2CallbackFunctions; every pointer may be NULL.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CallbackFunctions {
    pub logger: Option<CallbackLogger>,
    pub allocate_memory: Option<CallbackAllocateMemory>,
    pub free_memory: Option<CallbackFreeMemory>,
    pub step_finished: Option<StepFinished>,
    pub component_environment: ComponentEnvironment,
}

pub type GetText = unsafe extern "C" fn() -> Text;
pub type SetDebugLogging = unsafe extern "C" fn(Component, Boolean, usize, *const Text) -> Status;
pub type Instantiate =
    unsafe extern "C" fn(Text, Type, Text, Text, *const CallbackFunctions, Boolean, Boolean) -> Component;
pub type FreeInstance = unsafe extern "C" fn(Component);
pub type SetupExperiment = unsafe extern "C" fn(Component, Boolean, Real, Real, Boolean, Real) -> Status;
/// fmi2EnterInitializationMode, fmi2ExitInitializationMode, fmi2Terminate, fmi2Reset, fmi2CancelStep.
pub type ComponentFunction = unsafe extern "C" fn(Component) -> Status;
pub type GetReal = unsafe extern "C" fn(Component, *const ValueReference, usize, *mut Real) -> Status;
pub type GetInteger = unsafe extern "C" fn(Component, *const ValueReference, usize, *mut Integer) -> Status;
pub type GetBoolean = unsafe extern "C" fn(Component, *const ValueReference, usize, *mut Boolean) -> Status;
pub type GetString = unsafe extern "C" fn(Component, *const ValueReference, usize, *mut Text) -> Status;
pub type SetReal = unsafe extern "C" fn(Component, *const ValueReference, usize, *const Real) -> Status;
pub type SetInteger = unsafe extern "C" fn(Component, *const ValueReference, usize, *const Integer) -> Status;
pub type SetBoolean = unsafe extern "C" fn(Component, *const ValueReference, usize, *const Boolean) -> Status;
pub type SetString = unsafe extern "C" fn(Component, *const ValueReference, usize, *const Text) -> Status;
/// fmi2GetFMUstate and fmi2FreeFMUstate.
pub type GetFmuState = unsafe extern "C" fn(Component, *mut FmuState) -> Status;
pub type FreeFmuState = GetFmuState;
pub type SetFmuState = unsafe extern "C" fn(Component, FmuState) -> Status;
pub type SerializedFmuStateSize = unsafe extern "C" fn(Component, FmuState, *mut usize) -> Status;
pub type SerializeFmuState = unsafe extern "C" fn(Component, FmuState, *mut Byte, usize) -> Status;
pub type DeSerializeFmuState = unsafe extern "C" fn(Component, *const Byte, usize, *mut FmuState) -> Status;
pub type GetDirectionalDerivative = unsafe extern "C" fn(
    Component,
    *const ValueReference,
    usize,
    *const ValueReference,
    usize,
    *const Real,
    *mut Real,
) -> Status;
pub type SetRealInputDerivatives =
    unsafe extern "C" fn(Component, *const ValueReference, usize, *const Integer, *const Real) -> Status;
pub type GetRealOutputDerivatives =
    unsafe extern "C" fn(Component, *const ValueReference, usize, *const Integer, *mut Real) -> Status;
pub type DoStep = unsafe extern "C" fn(Component, Real, Real, Boolean) -> Status;
pub type GetStatus = unsafe extern "C" fn(Component, StatusKind, *mut Status) -> Status;
pub type GetRealStatus = unsafe extern "C" fn(Component, StatusKind, *mut Real) -> Status;
pub type GetIntegerStatus = unsafe extern "C" fn(Component, StatusKind, *mut Integer) -> Status;
pub type GetBooleanStatus = unsafe extern "C" fn(Component, StatusKind, *mut Boolean) -> Status;
pub type GetStringStatus = unsafe extern "C" fn(Component, StatusKind, *mut Text) -> Status;
