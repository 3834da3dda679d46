//! The cell of one particle, but for its facets.

use super::facet::Facet;
use super::unpaid::MOVED;
use nalgebra::{Matrix2, Vector2};

/// Ratio of |S| to the length of the surface at and below which the surface counts as round.
const ROUND: f64 = 0.8;
/// Length of a cell's surface, at least, over the straight line between its ends. These stand at the mean depth of two
/// cells, so that along a smooth surface the line is longer than the surface at the cell's own depth by a little: with
/// 1 a drop in a central field loses 1.5 per cent of its energy in five periods, with this 1.2.
const SHORTEST: f64 = 0.95;
/// How fast weights grow with what exceeds 1.
const STIFFENING: f64 = 4.0;

/// The rest of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Cell {
    /// Area \[m2\].
    pub area: f64,
    /// Area whose mass moves with the cell \[m2\]: the particle's own as far as the cell is open, that of the cell as far
    /// as it is closed.
    pub filled: f64,
    /// How open the cell is: 0 closed, 1 with a free surface; between them while a corner of it closes.
    pub openness: f64,
    /// From the particle to the centroid of its cell \[m\].
    pub centroid: Vector2<f64>,
    /// Distance of the free surface from the particle \[m\]; 0 for a cell without.
    pub depth: f64,
    /// Length of the free surface times the openness \[m\]; 0 for a cell without.
    pub surface: f64,
    /// Integral of the outward normal over the free surface \[m\].
    pub outward: Vector2<f64>,
    /// Weight of the particle's pressure in the force that the free surface puts on the cell \[m\].
    pub free_surface_gradient: Vector2<f64>,
    /// Whether its facets might not be those of its neighbours: beside walls and where corners may lie in empty space.
    pub asymmetric: bool,
    /// What the factor of the weights of its facets and its surface in the matrix of the pressure has beyond 1.
    pub stiffening: f64,
}

impl Cell {
    /// A cell without a free surface.
    pub fn closed(area: f64, centroid: Vector2<f64>) -> Self {
        Self { area, filled: area, centroid, ..Self::default() }
    }

    /// Whether the cell has a free surface.
    pub fn is_open(&self) -> bool {
        self.surface > 0.0
    }

    /// How the free surface ties the pressure of the particle to that of the gas outside.
    pub fn air_tie(&self) -> f64 {
        if self.is_open() { (1.0 + self.stiffening) * self.surface / self.depth } else { 0.0 }
    }

    /// What the free surface adds up to, from the facets that bound the rest.
    pub fn close_surface<'a>(&mut self, facets: impl Iterator<Item = &'a Facet>) {
        let (mut closed, mut moment) = (Vector2::zeros(), Matrix2::zeros());
        for facet in facets {
            let normal = facet.normal * facet.length();
            closed += normal;
            moment += facet.middle() * normal.transpose();
        }
        self.outward = -closed;
        // It is no shorter than the straight line between its ends, whatever became of these.
        self.surface = self.surface.max(SHORTEST * self.outward.norm());
        let rest = Matrix2::identity() * self.filled - moment;
        let exact = rest * self.outward / (self.surface * self.depth);
        // Beside the edge of a solid what is left of a surface may not bound the area at all: the exact weight was twice its
        // length there, and threw one particle out at 0.7 m/s.
        let beyond = exact - self.outward;
        let bound = self.surface / beyond.norm().max(self.surface);
        self.free_surface_gradient = self.outward + beyond * (bound * self.flatness());
    }

    /// Stiffening of the cell of a particle with the area `volume`. The kick G p moves areas by D G p / V; with the weights w
    /// of facets and surface in the matrix and the arms c that these have in G, what a cell's kick adds to
    /// p.D G p is at most sigma times what its weights are worth, with the largest eigenvalue sigma of sum w c c^T / V. At a
    /// lattice sigma is 1/2. In a column that is squeezed far below a spacing it exceeds 1: an error of the pressure came back
    /// larger, with the other sign, in the next step. There the weights grow with sigma, and the column is damped.
    pub fn stiffening_for(&self, facets: &[Facet], volume: f64) -> f64 {
        let mut moments = Matrix2::zeros();
        for facet in facets {
            let arm = facet.middle();
            moments += arm * arm.transpose() * facet.weight();
        }
        if self.is_open() {
            let weight = self.free_surface_gradient;
            moments += weight * weight.transpose() * (self.depth / self.surface);
        }
        let lean = 0.5 * (moments[(0, 0)] - moments[(1, 1)]);
        let largest = 0.5 * moments.trace() + lean.hypot(moments[(0, 1)]);
        (STIFFENING * (largest / self.filled.max(MOVED[0] * volume) - 1.0)).max(0.0)
    }

    /// 1 where the free surface is straight or there is none, 0 where it turns by a right angle or more.
    pub fn flatness(&self) -> f64 {
        if !self.is_open() {
            return 1.0;
        }
        ((self.outward.norm() / self.surface - ROUND) / (1.0 - ROUND)).clamp(0.0, 1.0)
    }

    /// How far the velocity gradient stands for the motion of all of the cell's outline: 1 for closed cells, the flatness
    /// of the surface for open ones.
    pub fn trust(&self) -> f64 {
        1.0 - self.openness * (1.0 - self.flatness())
    }
}
