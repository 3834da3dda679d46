//! From a geometry to particles, and the refusal of what cannot be simulated.

pub mod check;
pub mod fill;
pub mod outline;
pub mod places;
mod state_check;
