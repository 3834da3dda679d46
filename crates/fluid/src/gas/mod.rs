//! Gas: space without water that walls, bodies and water close off from the open air.
//!
//! A pocket is one more unknown of the pressure system, a cell that can be compressed (Goldade, Aanjaneya and Batty 2020).
//! `space` finds the pockets, `pocket` keeps the account of their gas; how they push on water and walls is the discretisation's
//! (`voronoi/gas.rs`).

mod pocket;
mod space;

pub use pocket::{Account, Gas, GasParameters, Pocket, Reading};
pub use space::{NOTHING, OPEN, Space};
