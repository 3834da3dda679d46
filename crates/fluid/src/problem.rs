//! What is solved: parameters and geometry, with what follows from them.

use crate::parameters::{Geometry, Parameters};
use crate::walls::gaps::{self, ClosedGap};
use crate::walls::{BodyContact, WallLayout, Walls};
use nalgebra::DVector;

/// What stays the same over all internal steps of a solver.
#[derive(Debug, Clone)]
pub struct Problem {
    pub parameters: Parameters,
    pub geometry: Geometry,
    /// Walls with narrow gaps closed.
    pub layout: WallLayout,
    /// The gaps that were closed.
    pub gaps: Vec<ClosedGap>,
    /// Side of the square of a particle's area \[m\].
    pub spacing: f64,
    /// Distance at which a particle may feel a wall \[m\].
    pub reach: f64,
}

impl Problem {
    /// What follows from parameters and geometry, with particles of the given spacing, which feel walls within `reach`.
    pub fn new(parameters: Parameters, geometry: Geometry, spacing: f64, reach: f64) -> Self {
        let layout = WallLayout::new(&geometry, spacing);
        let mut problem = Self { parameters, geometry, layout, gaps: Vec::new(), spacing, reach };
        let walls = problem.walls(&problem.geometry.bodies.at_rest().position);
        (problem.layout, problem.gaps) = gaps::close(&problem.layout, &walls, spacing);
        problem
    }

    /// Number of coordinates of all bodies.
    pub fn coordinates(&self) -> usize {
        self.geometry.bodies.layout().size()
    }

    /// Walls at the start as they are drawn, and what of the bodies must not meet the fixed ones.
    pub fn drawn(&self) -> (Walls, BodyContact) {
        let layout = WallLayout::new(&self.geometry, self.spacing);
        let walls = self.place(&layout, &self.geometry.bodies.at_rest().position);
        let contact = BodyContact::new(&layout.panels, &self.geometry.bodies, &walls, self.spacing);
        (walls, contact)
    }

    /// Walls with the bodies at `coordinates`.
    pub fn walls(&self, coordinates: &DVector<f64>) -> Walls {
        self.place(&self.layout, coordinates)
    }

    fn place(&self, layout: &WallLayout, coordinates: &DVector<f64>) -> Walls {
        let mut walls = Walls::default();
        let bodies = &self.geometry.bodies;
        let at = (!bodies.is_empty()).then_some((bodies, coordinates));
        walls.place(layout, at, self.reach, self.spacing);
        walls
    }
}
