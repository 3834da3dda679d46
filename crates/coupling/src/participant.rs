//! What the coupling needs of a simulator: variables by name, a step, and saved states.
//!
//! Whether it is reached through the C ABI of an FMU or held in process, the coupling sees this trait alone.

use digits::{rounded, six};
use std::fmt;
use thiserror::Error;

/// Type of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// 64-bit floating point.
    Real,
    /// 32-bit integer; enumerations too.
    Integer,
    /// True or false.
    Boolean,
    /// UTF-8 text.
    String,
}

impl Kind {
    /// What a variable of this type takes, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Real => "a number",
            Self::Integer => "a whole number below 2^31",
            Self::Boolean => "true or false",
            Self::String => "a text",
        }
    }
}

/// A value with its type.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// 64-bit floating point.
    Real(f64),
    /// 32-bit integer; enumerations too.
    Integer(i32),
    /// True or false.
    Boolean(bool),
    /// UTF-8 text.
    String(String),
}

impl Value {
    /// The number for a results table; booleans are 0 or 1, text has none.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Real(value) => Some(*value),
            Self::Integer(value) => Some(f64::from(*value)),
            Self::Boolean(value) => Some(f64::from(u8::from(*value))),
            Self::String(_) => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Real(value) => write!(formatter, "{}", six(*value)),
            Self::Integer(value) => write!(formatter, "{value}"),
            Self::Boolean(value) => write!(formatter, "{value}"),
            Self::String(value) => write!(formatter, "'{value}'"),
        }
    }
}

/// Role of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set before the run.
    Parameter,
    /// Set before each step.
    Input,
    /// Read after each step.
    Output,
    /// Anything else (local, calculated parameter, independent).
    Other,
}

impl Causality {
    /// Its name in the standard.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parameter => "parameter",
            Self::Input => "input",
            Self::Output => "output",
            Self::Other => "local",
        }
    }
}

/// One variable of a participant.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Unique name.
    pub name: String,
    /// Value reference, unique within its type only.
    pub reference: u32,
    /// Type.
    pub kind: Kind,
    /// Role.
    pub causality: Causality,
    /// Unit as the participant writes it; empty when it has none.
    pub unit: String,
    /// What it is.
    pub description: String,
    /// Smallest and largest value that the participant declares; without limits infinite.
    pub range: [f64; 2],
}

/// The range of a variable without limits.
pub const UNLIMITED: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// What a participant offers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Description {
    /// All variables in the order of the participant.
    pub variables: Vec<Variable>,
    /// Whether a state can be saved and restored.
    pub saves_states: bool,
    /// Whether a state can be written as bytes.
    pub serialises_states: bool,
    /// Whether the communication step may change during a run.
    pub variable_step: bool,
    /// Whether directional derivatives are available.
    pub derivatives: bool,
}

impl Description {
    /// The variable called `name`; the error names the nearest known one.
    pub fn variable(&self, participant: &str, name: &str) -> Result<&Variable, Error> {
        self.variables.iter().find(|variable| variable.name == name).ok_or_else(|| Error::UnknownVariable {
            participant: participant.to_string(),
            variable: name.to_string(),
            hint: scene::nearest(name, self.variables.iter().map(|variable| variable.name.as_str()))
                .map_or_else(String::new, |known| format!("; did you mean '{known}'?")),
        })
    }
}

/// How a step ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The step was done.
    Done,
    /// The participant could not do this step; a smaller one from the saved state may succeed.
    Refused {
        /// What the participant said.
        reason: String,
    },
}

/// What can go wrong in a participant. Every message names the participant.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A call did not return OK.
    #[error("{participant}: {action} at t = {} s returned {status}{}", six(*time), rounded(message))]
    Call {
        /// Name of the participant.
        participant: String,
        /// Function and what it was called with.
        action: String,
        /// Time of the call \[s\].
        time: f64,
        /// Returned status.
        status: String,
        /// The participant's own message, with a leading separator.
        message: String,
    },
    /// There is no such variable.
    #[error("{participant}: there is no variable '{variable}'{hint}")]
    UnknownVariable {
        /// Name of the participant.
        participant: String,
        /// Name asked for.
        variable: String,
        /// The nearest known name.
        hint: String,
    },
    /// A value of the wrong type.
    #[error("{participant}: variable '{variable}' takes {}, got {}", expected.words(), rounded(got))]
    WrongType {
        /// Name of the participant.
        participant: String,
        /// Name of the variable.
        variable: String,
        /// Its type.
        expected: Kind,
        /// Value given.
        got: String,
    },
    /// A value outside the range that the participant declares.
    #[error("{participant}: variable '{variable}' = {}: expected {}", six(*got), words_of(*range))]
    OutOfRange {
        /// Name of the participant.
        participant: String,
        /// Name of the variable.
        variable: String,
        /// Value given.
        got: f64,
        /// Smallest and largest value allowed.
        range: [f64; 2],
    },
    /// The participant lacks a capability that was asked for.
    #[error("{participant}: {capability} is needed, but the description does not offer it{hint}")]
    Unsupported {
        /// Name of the participant.
        participant: String,
        /// What was asked.
        capability: String,
        /// What to change.
        hint: String,
    },
}

/// A range in words.
fn words_of([low, high]: [f64; 2]) -> String {
    match (low.is_finite(), high.is_finite()) {
        (true, false) => format!("at least {}, as its description declares", six(low)),
        (false, true) => format!("at most {}, as its description declares", six(high)),
        _ => format!("{} to {}, as its description declares", six(low), six(high)),
    }
}

impl Variable {
    /// Refuses a number outside the declared range.
    pub fn allow(&self, participant: &str, value: &Value) -> Result<(), Error> {
        let [low, high] = self.range;
        match value.number() {
            // What is no number is refused by the participant itself, which knows better what it takes.
            Some(got) if got < low || got > high => Err(Error::OutOfRange {
                participant: participant.to_string(),
                variable: self.name.clone(),
                got,
                range: self.range,
            }),
            _ => Ok(()),
        }
    }
}

/// A simulator that can be stepped. Values are SI; times in seconds.
///
/// States live in numbered slots of the participant: saving into a slot overwrites it, [`Participant::release`] frees
/// all of them, and so does dropping the participant.
pub trait Participant {
    /// Name in the case.
    fn name(&self) -> &str;
    /// Variables and capabilities.
    fn description(&self) -> &Description;
    /// Sets one variable of any type.
    fn set(&mut self, variable: &Variable, value: &Value) -> Result<(), Error>;
    /// Reads one variable of any type.
    fn get(&mut self, variable: &Variable) -> Result<Value, Error>;
    /// Sets real variables by reference; both slices have the same length.
    fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), Error>;
    /// Reads real variables by reference; both slices have the same length.
    fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Error>;
    /// Enters initialisation; parameters are set before, start values of inputs after.
    fn enter_initialisation(&mut self, start: f64, stop: f64) -> Result<(), Error>;
    /// Ends initialisation; steps may follow.
    fn exit_initialisation(&mut self) -> Result<(), Error>;
    /// Steps from `time` to `time + duration`.
    fn step(&mut self, time: f64, duration: f64) -> Result<Outcome, Error>;
    /// Saves the state into a slot.
    fn save(&mut self, slot: usize) -> Result<(), Error>;
    /// Restores the state of a slot, which stays valid.
    fn restore(&mut self, slot: usize) -> Result<(), Error>;
    /// The present state as bytes, for [`Participant::deserialise`] in any process.
    fn serialise(&mut self) -> Result<Vec<u8>, Error>;
    /// Takes a state from bytes; the participant is initialised.
    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), Error>;
    /// Frees the states of all slots.
    fn release(&mut self) -> Result<(), Error>;
    /// Derivative of `unknowns` in the direction `seed` of `knowns`, as of the last step; `sensitivity` has the
    /// length of `unknowns`.
    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Error>;
    /// Ends the run; outputs can still be read.
    fn terminate(&mut self) -> Result<(), Error>;
}
