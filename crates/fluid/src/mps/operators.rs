//! The particle operators (the paper's equations 3 and 4), each a gather over neighbours and images.

use super::kernel::Kernel;
use super::neighbourhood::Neighbourhood;
use crate::walls::PanelMotion;
use nalgebra::Vector2;

/// Number of space dimensions d.
pub const DIMENSIONS: f64 = 2.0;

/// What the operators look at.
#[derive(Clone, Copy)]
pub struct Operators<'a> {
    /// Positions \[m\].
    pub positions: &'a [Vector2<f64>],
    /// Neighbours and images.
    pub around: &'a Neighbourhood,
    /// Weight function.
    pub kernel: &'a Kernel,
    /// Motion of the walls.
    pub panels: &'a PanelMotion,
}

/// Sums that tell the interior from the free surface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Density {
    /// Number density n, the sum of weights (equation 4a).
    pub number_density: f64,
    /// Weighted mean of the vectors to the neighbours \[m\].
    pub centroid: Vector2<f64>,
    /// Neighbours and images.
    pub count: usize,
}

impl Operators<'_> {
    /// Number density, centroid and count of the neighbourhood of particle i.
    pub fn density(&self, i: usize) -> Density {
        let mut density = 0.0;
        let mut moment = Vector2::zeros();
        let neighbours = self.around.neighbours.of(i);
        for neighbour in neighbours {
            density += neighbour.weight;
            moment += (self.positions[neighbour.index as usize] - self.positions[i]) * neighbour.weight;
        }
        let images = self.around.images.of(i);
        for image in images {
            density += image.weight;
            moment += image.vector * image.weight;
        }
        let centroid = if density > 0.0 { moment / density } else { Vector2::zeros() };
        Density { number_density: density, centroid, count: neighbours.len() + images.len() }
    }

    /// Divergence of the velocity \[1/s\] (equation 3c).
    pub fn divergence(&self, i: usize, velocities: &[Vector2<f64>]) -> f64 {
        let mut sum = 0.0;
        for neighbour in self.around.neighbours.of(i) {
            let j = neighbour.index as usize;
            let vector = self.positions[j] - self.positions[i];
            sum += neighbour.weight * vector.dot(&(velocities[j] - velocities[i]))
                / vector.norm_squared().max(self.least());
        }
        for image in self.around.images.of(i) {
            let mirrored = image.velocity(&velocities[image.neighbour as usize], self.panels);
            sum += image.weight * image.vector.dot(&(mirrored - velocities[i]))
                / image.vector.norm_squared().max(self.least());
        }
        DIMENSIONS / self.kernel.reference_density * sum
    }

    /// Gradient of the pressure \[Pa/m\] against the smallest pressure around (equation 3a as corrected: the
    /// difference is p_j - p_hat_i, divided by the distance; the print has the gradient once more).
    ///
    /// `rise` is the pressure of an image above that of its particle \[Pa\].
    pub fn pressure_gradient(
        &self,
        i: usize,
        pressure: impl Fn(usize) -> f64,
        rise: impl Fn(&crate::Image) -> f64,
    ) -> Vector2<f64> {
        let neighbours = self.around.neighbours.of(i);
        let images = self.around.images.of(i);
        let mut least = pressure(i);
        for neighbour in neighbours {
            least = least.min(pressure(neighbour.index as usize));
        }
        for image in images {
            least = least.min(pressure(image.neighbour as usize) + rise(image));
        }
        let mut sum = Vector2::zeros();
        for neighbour in neighbours {
            let j = neighbour.index as usize;
            let vector = self.positions[j] - self.positions[i];
            sum += vector * ((pressure(j) - least) * neighbour.weight / vector.norm_squared().max(self.least()));
        }
        for image in images {
            let difference = pressure(image.neighbour as usize) + rise(image) - least;
            sum += image.vector * (difference * image.weight / image.vector.norm_squared().max(self.least()));
        }
        sum * (DIMENSIONS / self.kernel.reference_density)
    }

    /// Direction in which particles are crowded: the sum of w r_ij / |r_ij| over n0.
    pub fn crowding(&self, i: usize) -> Vector2<f64> {
        let mut sum = Vector2::zeros();
        for neighbour in self.around.neighbours.of(i) {
            let vector = self.positions[neighbour.index as usize] - self.positions[i];
            sum += vector * (neighbour.weight / vector.norm().max(self.kernel.floor));
        }
        for image in self.around.images.of(i) {
            sum += image.vector * (image.weight / image.vector.norm().max(self.kernel.floor));
        }
        sum / self.kernel.reference_density
    }

    /// Smallest squared distance that counts, where the weight stops growing too \[m2\].
    fn least(&self) -> f64 {
        self.kernel.floor * self.kernel.floor
    }
}
