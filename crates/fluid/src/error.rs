//! What can go wrong, with the numbers.

use digits::{rounded, six};
use nalgebra::Vector2;
use thiserror::Error;

/// An error of the fluid solver.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A parameter outside its range.
    #[error("fluid parameter {name} = {got}: expected {}", rounded(expected), got = six(*got))]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Value found.
        got: f64,
        /// What would be right.
        expected: String,
    },
    /// A geometry that cannot be simulated.
    #[error("geometry: {}: got {}, expected {}", rounded(what), rounded(got), rounded(expected))]
    Geometry {
        /// What is wrong and where.
        what: String,
        /// Value found.
        got: String,
        /// What would be right.
        expected: String,
    },
    /// An input that is not usable.
    #[error("input {name} = {} at t = {} s: expected {}", six(*got), six(*time), rounded(expected))]
    Input {
        /// Name of the input.
        name: String,
        /// Value found.
        got: f64,
        /// Time of the step's start \[s\].
        time: f64,
        /// What would be right.
        expected: String,
    },
    /// The body meets a fixed wall.
    #[error(
        "the body's surface passes through a fixed wall at ({}, {}) m at t = {} s; add [body.contact] to let it \
         rest there, end the run before, or give the body more room",
        six(*x), six(*y), six(*time)
    )]
    Contact {
        /// Place of the body's corner behind the wall \[m\].
        x: f64,
        /// Place of the body's corner behind the wall \[m\].
        y: f64,
        /// Time of the step's start \[s\].
        time: f64,
    },
    /// Two bodies stand in one another.
    #[error(
        "two bodies stand in one another at ({}, {}) m at t = {} s, and nothing holds them apart; end the run before, or give \
         them more room",
        six(*x), six(*y), six(*time)
    )]
    Overlap {
        /// Place of the surface of one in the other \[m\].
        x: f64,
        /// Place of the surface of one in the other \[m\].
        y: f64,
        /// Time of the step's start \[s\].
        time: f64,
    },
    /// The pressure solve did not converge.
    #[error(
        "pressure solve at t = {} s: relative residual {} after {iterations} iterations on {unknowns} unknowns, wanted \
         {}; a smaller time step or a larger fluid.solve.maximum_iterations may help",
        six(*time), six(*residual), six(*tolerance)
    )]
    Pressure {
        /// Time \[s\].
        time: f64,
        /// Iterations done.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
        /// Relative residual wanted.
        tolerance: f64,
        /// Size of the system.
        unknowns: usize,
    },
    /// A value that is not finite after a step.
    #[error(
        "{field} of particle {particle} is not finite at t = {} s, near ({}, {}); the step was not taken",
        six(*time), six(*x), six(*y)
    )]
    NotFinite {
        /// Field.
        field: &'static str,
        /// Index of the particle.
        particle: usize,
        /// Time \[s\].
        time: f64,
        /// Place before the step \[m\].
        x: f64,
        /// Place before the step \[m\].
        y: f64,
    },
    /// The time step became too small.
    #[error(
        "time step {} s at t = {} s is below {} s: the largest speed is {} m/s at spacing {} m; the flow is not \
         resolved or the wall moves too fast",
        six(*step), six(*time), six(*floor), six(*speed), six(*spacing)
    )]
    TimeStep {
        /// Time step wanted \[s\].
        step: f64,
        /// Smallest step allowed \[s\].
        floor: f64,
        /// Time \[s\].
        time: f64,
        /// Largest speed \[m/s\].
        speed: f64,
        /// Particle spacing \[m\].
        spacing: f64,
    },
    /// A communication step that would take too many internal steps.
    #[error(
        "the communication step has {} s left at t = {} s, which takes more than {} internal steps of at most {} s; use a \
         shorter communication step",
        six(*left), six(*time), six(*parts), six(*stable)
    )]
    CommunicationStep {
        /// Time left in the communication step \[s\].
        left: f64,
        /// Largest stable internal step \[s\].
        stable: f64,
        /// Internal steps allowed.
        parts: f64,
        /// Time \[s\].
        time: f64,
    },
    /// A state that does not belong to this scene, or that was damaged.
    #[error("state: {what} = {}: expected {}", rounded(got), rounded(expected))]
    State {
        /// What is wrong.
        what: String,
        /// Value found.
        got: String,
        /// What would be right.
        expected: String,
    },
    /// The thread pool could not be made.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// A place for messages.
pub(crate) fn place(point: &Vector2<f64>) -> String {
    format!("({}, {})", six(point.x), six(point.y))
}

impl From<keys::OutOfRange> for Error {
    fn from(keys::OutOfRange { key, got, .. }: keys::OutOfRange) -> Self {
        Self::Parameter { name: key.name, got, expected: format!("a number from {} to {}", key.low, key.high) }
    }
}
