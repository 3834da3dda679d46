//! The scene file: what is simulated, in which units, with which methods, and which figures are checked afterwards.
//!
//! A scene is one TOML file. It is parsed and validated once, here; every later stage may rely on it.
//! Lengths are in metres, everything else in SI units per metre of width.

mod body;
mod checks;
mod document;
mod error;
mod gas;
mod instruments;
mod lists;
mod names;
mod parse;
mod place;
mod quick;
mod sameness;
mod types;
mod validate;
mod validate_bodies;
mod validate_checks;
mod warnings;
mod words;

pub use body::{Body, Contact, Freedom, Integrator, Member, Support};
pub use checks::{Check, CheckKind};
pub use document::{check_file, file_name, from_toml, line_unless_set, name_of, read_file, read_text};
pub use error::Error;
pub use gas::{Chamber, Gas, Vent};
pub use instruments::{Gauge, Probe, Region};
pub use names::identifier;
pub use parse::parse_overrides;
pub use quick::{Quick, QuickCheck};
pub use types::*;
pub use validate_checks::validate_checks;
pub use words::nearest;
