//! A model behind the Functional Mock-up Interface, whatever its version: what a model offers, its table of variables, one
//! instance of it with its states, and where its messages go.
//!
//! A model implements [`Component`] and describes itself by one table of [`Variable`]s, which yields getters, setters,
//! descriptions and documentation. [`Instance`] drives it and checks values and times; in which order a caller may call what
//! is the matter of a version of the standard, and of the crate that knows it.

mod component;
mod failure;
mod instance;
mod logger;
mod snapshot;
mod values;
mod variable;

pub use component::{Component, DefaultExperiment, Experiment, Model, Setup, SimpleType, Unit};
pub use failure::{Failure, Status};
pub use instance::{Instance, Mode};
pub use logger::{CATEGORIES, Logger};
pub use snapshot::Snapshot;
pub use variable::{Access, Causality, Initial, Variability, Variable};

/// Handle of a variable; unique within a model and type.
pub type Reference = u32;
