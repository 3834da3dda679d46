//! The scheme `accurate`: Voronoi cells of the particles as weights.

pub mod added_mass;
pub mod cell;
pub mod cells;
pub mod cut;
pub mod enclosed;
pub mod facet;
pub mod notch;
pub mod operators;
pub mod outline;
pub mod polygon;
pub mod prepare;
pub mod relax;
pub mod shape;
pub mod source;
pub mod step;
pub mod surroundings;

#[cfg(test)]
mod verification;
