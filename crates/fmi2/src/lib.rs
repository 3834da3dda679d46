//! Export of a model as an FMI 2.0 co-simulation FMU (standard 2.0.5).
//!
//! A model implements [`Component`] and describes itself by one table of [`Variable`]s. The table yields the getters,
//! the setters, modelDescription.xml and the documentation. [`Instance`] adds the call sequence, the checks, the
//! logger and the states; it is usable in process, without the C ABI. [`export!`] puts the C functions of the
//! standard around it: use it in a `cdylib` shell and nowhere else, because two libraries that export the same
//! names and are linked into one program call each other's functions.

mod component;
pub mod describe;
pub mod entry;
mod export;
mod failure;
pub mod ffi;
mod instance;
mod logger;
pub mod resources;
mod sequence;
mod snapshot;
mod values;
mod variable;

pub use component::{Component, DefaultExperiment, Experiment, Model, Setup, SimpleType, Unit};
pub use failure::Failure;
pub use ffi::Status;
pub use instance::Instance;
pub use logger::{CATEGORIES, Logger};
pub use sequence::{Function, Mode};
pub use snapshot::Snapshot;
pub use variable::{Access, Causality, Initial, Variability, Variable};

/// Handle of a variable; unique within a model and type.
pub type Reference = u32;
