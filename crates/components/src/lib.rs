//! The fluid and the structure as FMI components: what a scene means to them, their tables of variables, their field
//! frames. The numerics are in the crates `fluid`, `structure` and `kinematics`, which know neither FMI nor files.
//!
//! Used by the two FMU shells, and in process by whoever wants the same bits without the C ABI:
//! `fmi::Instance::<components::FluidComponent>::new(..)`.

pub mod conversion;
mod error;
mod fluid_component;
mod interface;
pub mod memory;
mod parameters;
mod quantities;
mod scenes;
mod structure_component;

pub use error::Error;
pub use fluid_component::{FluidComponent, fluid_set_up};
pub use interface::{ACCELERATION, INTERFACE_FILE, Interface, LOAD, POSITION, VELOCITY};
pub use scenes::{DEFAULT_SCENE, OWN_SCENE, default_scene, find_scene};
pub use structure_component::{StructureComponent, structure_set_up};
