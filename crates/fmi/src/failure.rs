//! Why a call was not carried out.

use digits::rounded;
use thiserror::Error;

/// How a call ended, or how grave a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// As wished.
    Ok,
    /// As wished, with something to look at.
    Warning,
    /// Not done; another value or a shorter step may do.
    Discard,
    /// Not done.
    Error,
}

/// A call that did not succeed, with the status that the caller sees and a message with numbers.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{message}")]
pub struct Failure {
    /// Status returned to the importer: discard or error.
    pub status: Status,
    /// What was expected, what came, what to change; numbers have six significant digits.
    pub message: String,
    /// Whether the instance is unusable afterwards, until a state is restored or the instance is reset.
    pub breaks_instance: bool,
}

impl Failure {
    /// A call that was refused; the instance is as before.
    pub fn refused(message: impl Into<String>) -> Self {
        Self { status: Status::Error, message: rounded(&message.into()), breaks_instance: false }
    }

    /// A call that failed and leaves the instance unusable.
    pub fn broken(message: impl Into<String>) -> Self {
        Self { status: Status::Error, message: rounded(&message.into()), breaks_instance: true }
    }

    /// A step or a value that this instance cannot take while another may do: a shorter step, a value in range.
    pub fn discard(message: impl Into<String>) -> Self {
        Self { status: Status::Discard, message: rounded(&message.into()), breaks_instance: false }
    }
}
