//! Studies of many runs: benchmarks, ensembles, the paper's study again, comparisons, validation. What they need of the program that
//! makes the runs is [`Program`].

pub mod bench;
pub mod compare;
pub mod ensemble;
mod program;
pub mod reproduce;
pub mod validate;
mod watched;

pub use program::{Failure, FinishedRun, Measured, Program, Request};
pub use watched::watched;
