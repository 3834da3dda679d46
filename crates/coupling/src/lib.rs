//! Implicit coupling: one communication step of several participants, iterated until what they exchange agrees.
//!
//! Participants step one after the other. A connection from an earlier to a later participant carries the value of
//! the same pass; a connection against that order carries an *iterated* quantity Q: it is guessed, the pass gives
//! Q~, and the residual Q~ - Q drives an accelerator until it is within tolerance for every quantity on its own.
//! Nothing here knows what the participants are or what the quantities mean: [`participant::Participant`] is all that is asked
//! of them.

mod acceleration;
mod clock;
mod convergence;
mod error;
mod iqn_ils;
mod jacobian;
mod newton;
pub mod participant;
mod predictor;
mod stepper;
mod system;
#[cfg(test)]
mod tests;
mod weights;

pub use acceleration::{Accelerator, Aitken};
pub use clock::{Clock, even_step};
pub use convergence::{Residual, Stall, Tolerance};
pub use error::Error;
pub use iqn_ils::IqnIls;
pub use newton::Newton;
pub use predictor::Predictor;
pub use stepper::{IterationRow, Memory, Parameters, StepReport, Stepper};
pub use system::{Connection, Pass, System};
