//! Gas: space without water that walls, bodies and water close off from the open air.

mod space;

pub use space::Space;
