//! The cell of one particle, but for its facets.

use nalgebra::Vector2;

/// Ratio of |S| to the length of the surface at and below which the surface counts as round.
const ROUND: f64 = 0.8;

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
