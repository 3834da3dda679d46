//! The call sequence of the standard as one table (FMI 2.0.5, section 4.2.4).

use fmi::{Failure, Mode};

/// Asynchronous steps are not offered, so the standard's `stepInProgress` and `stepCanceled` are never entered.
fn name(mode: Mode) -> &'static str {
    match mode {
        Mode::Instantiated => "instantiated",
        Mode::Initialization => "initialization mode",
        Mode::StepComplete => "step complete",
        Mode::StepFailed => "step failed",
        Mode::Terminated => "terminated",
        Mode::Error => "error",
    }
}

const INSTANTIATED: u8 = 1 << Mode::Instantiated as u8;
const INITIALIZATION: u8 = 1 << Mode::Initialization as u8;
const COMPLETE: u8 = 1 << Mode::StepComplete as u8;
const FAILED: u8 = 1 << Mode::StepFailed as u8;
const TERMINATED: u8 = 1 << Mode::Terminated as u8;
const ERROR: u8 = 1 << Mode::Error as u8;
const AFTER_STEP: u8 = COMPLETE | FAILED | TERMINATED | ERROR;
const ALWAYS: u8 = INSTANTIATED | INITIALIZATION | AFTER_STEP;

/// The functions of the standard that need an instance; families that share a row share a member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are those of the standard")]
pub enum Function {
    SetDebugLogging,
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    GetReal,
    GetInteger,
    GetBoolean,
    GetString,
    SetReal,
    SetInteger,
    SetBoolean,
    SetString,
    GetFmuState,
    SetFmuState,
    FreeFmuState,
    SerializedFmuStateSize,
    SerializeFmuState,
    DeSerializeFmuState,
    GetDirectionalDerivative,
    SetRealInputDerivatives,
    GetRealOutputDerivatives,
    DoStep,
    CancelStep,
    GetStatus,
    GetRealStatus,
    GetIntegerStatus,
    GetBooleanStatus,
    GetStringStatus,
}

impl Function {
    /// The table: name and modes in which the call is allowed.
    #[rustfmt::skip]
    const fn row(self) -> (&'static str, u8) {
        match self {
            Self::SetDebugLogging          => ("fmi2SetDebugLogging", ALWAYS),
            Self::SetupExperiment          => ("fmi2SetupExperiment", INSTANTIATED),
            Self::EnterInitializationMode  => ("fmi2EnterInitializationMode", INSTANTIATED),
            Self::ExitInitializationMode   => ("fmi2ExitInitializationMode", INITIALIZATION),
            Self::Terminate                => ("fmi2Terminate", COMPLETE | FAILED),
            Self::Reset                    => ("fmi2Reset", ALWAYS),
            Self::GetReal                  => ("fmi2GetReal", INITIALIZATION | AFTER_STEP),
            Self::GetInteger               => ("fmi2GetInteger", INITIALIZATION | AFTER_STEP),
            Self::GetBoolean               => ("fmi2GetBoolean", INITIALIZATION | AFTER_STEP),
            Self::GetString                => ("fmi2GetString", INITIALIZATION | AFTER_STEP),
            Self::SetReal                  => ("fmi2SetReal", INSTANTIATED | INITIALIZATION | COMPLETE),
            Self::SetInteger               => ("fmi2SetInteger", INSTANTIATED | INITIALIZATION | COMPLETE),
            Self::SetBoolean               => ("fmi2SetBoolean", INSTANTIATED | INITIALIZATION | COMPLETE),
            Self::SetString                => ("fmi2SetString", INSTANTIATED | INITIALIZATION | COMPLETE),
            Self::GetFmuState              => ("fmi2GetFMUstate", ALWAYS),
            Self::SetFmuState              => ("fmi2SetFMUstate", ALWAYS),
            Self::FreeFmuState             => ("fmi2FreeFMUstate", ALWAYS),
            Self::SerializedFmuStateSize   => ("fmi2SerializedFMUstateSize", ALWAYS),
            Self::SerializeFmuState        => ("fmi2SerializeFMUstate", ALWAYS),
            Self::DeSerializeFmuState      => ("fmi2DeSerializeFMUstate", ALWAYS),
            Self::GetDirectionalDerivative => ("fmi2GetDirectionalDerivative", INITIALIZATION | AFTER_STEP),
            Self::SetRealInputDerivatives  => ("fmi2SetRealInputDerivatives", INSTANTIATED | INITIALIZATION | COMPLETE),
            Self::GetRealOutputDerivatives => ("fmi2GetRealOutputDerivatives", AFTER_STEP),
            Self::DoStep                   => ("fmi2DoStep", COMPLETE),
            Self::CancelStep               => ("fmi2CancelStep", 0),
            Self::GetStatus                => ("fmi2GetStatus", COMPLETE | FAILED | TERMINATED),
            Self::GetRealStatus            => ("fmi2GetRealStatus", COMPLETE | FAILED | TERMINATED),
            Self::GetIntegerStatus         => ("fmi2GetIntegerStatus", COMPLETE | FAILED | TERMINATED),
            Self::GetBooleanStatus         => ("fmi2GetBooleanStatus", COMPLETE | FAILED | TERMINATED),
            Self::GetStringStatus          => ("fmi2GetStringStatus", COMPLETE | FAILED | TERMINATED),
        }
    }

    /// Name in the standard.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// Whether the call is allowed in this mode.
    pub fn allowed(self, mode: Mode) -> bool {
        self.row().1 & (1 << mode as u8) != 0
    }

    /// Refuses a call that the standard does not allow in this mode.
    pub(crate) fn check(self, mode: Mode) -> Result<(), Failure> {
        if self.allowed(mode) {
            return Ok(());
        }
        let allowed: Vec<&str> = [
            Mode::Instantiated,
            Mode::Initialization,
            Mode::StepComplete,
            Mode::StepFailed,
            Mode::Terminated,
            Mode::Error,
        ]
        .into_iter()
        .filter(|&candidate| self.allowed(candidate))
        .map(name)
        .collect();
        let allowed = if allowed.is_empty() { "no mode".to_string() } else { allowed.join(", ") };
        let (function, mode) = (self.name(), name(mode));
        Err(Failure::refused(format!("{function} is not allowed in mode '{mode}', only in: {allowed}")))
    }
}
