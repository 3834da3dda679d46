//! What can go wrong in coupling.

use crate::Residual;
use crate::participant;
use digits::{rounded, six};
use thiserror::Error;

/// A coupled run that cannot go on.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A participant failed.
    #[error(transparent)]
    Participant(#[from] participant::Error),
    /// A participant gave a value that is no number.
    #[error("{participant}: variable '{variable}' is {value} at t = {} s", six(*time))]
    NotFinite {
        /// Name of the participant.
        participant: String,
        /// Name of the variable.
        variable: String,
        /// Value found.
        value: f64,
        /// Time at which it was read \[s\].
        time: f64,
    },
    /// No step size was found with which the step converges.
    #[error(
        "step refused at t = {} s: with the smallest step, {} s, there was no convergence after {iterations} iterations: \
         {}; raise coupling.maximum_iterations, lower coupling.smallest_step or loosen the tolerance",
        six(*time), six(*duration), list(residuals)
    )]
    NotConverged {
        /// Start of the step \[s\].
        time: f64,
        /// Smallest duration tried \[s\].
        duration: f64,
        /// Iterations made with it.
        iterations: usize,
        /// Residual and tolerance of every iterated quantity in the last iteration.
        residuals: Vec<Residual>,
    },
    /// A participant refused the step, down to the smallest size.
    #[error(
        "step refused at t = {} s by {participant}, last with {} s: {}",
        six(*time), six(*duration), rounded(reason)
    )]
    StepRefused {
        /// Start of the step \[s\].
        time: f64,
        /// Smallest duration tried \[s\].
        duration: f64,
        /// Name of the participant.
        participant: String,
        /// What it said.
        reason: String,
    },
    /// An error with its likely cause.
    #[error("{error}; {cause}")]
    Explained {
        /// What happened.
        error: Box<Error>,
        /// Why.
        cause: String,
    },
    /// A connection that cannot be made.
    #[error("connection {from} -> {to}: {reason}")]
    Connection {
        /// Source, `participant.variable`.
        from: String,
        /// Destination, `participant.variable`.
        to: String,
        /// Why not.
        reason: String,
    },
}

fn list(residuals: &[Residual]) -> String {
    residuals.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}
