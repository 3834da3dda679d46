//! The weight function and its lattice constants (the paper's equations 2 and 4).

use nalgebra::Vector2;

/// Weight w(r) = r_e / r - 1 with its constants on the full square lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernel {
    /// Effective radius r_e \[m\].
    pub radius: f64,
    /// Distance below which the weight grows no further \[m\], 0.3 spacings: a pair that got so close parts gently.
    pub floor: f64,
    /// Number density n0 of the lattice, the sum of w.
    pub reference_density: f64,
    /// lambda = sum w r^2 / sum w on the lattice \[m2\].
    pub lambda: f64,
    /// Number of neighbours on the lattice.
    pub reference_neighbours: usize,
}

impl Kernel {
    /// Kernel of radius `ratio` spacings on a lattice of rectangular cells `cell` \[m\]; the spacing is the side of a
    /// square of the same area.
    pub fn new(ratio: f64, cell: Vector2<f64>) -> Self {
        let spacing = (cell.x * cell.y).sqrt();
        let mut kernel = Self {
            radius: ratio * spacing,
            floor: 0.3 * spacing,
            reference_density: 0.0,
            lambda: 0.0,
            reference_neighbours: 0,
        };
        let reach = (kernel.radius / cell.min()).ceil() as i64;
        let mut second_moment = 0.0;
        for ix in -reach..=reach {
            for iy in -reach..=reach {
                let squared = (ix as f64 * cell.x).powi(2) + (iy as f64 * cell.y).powi(2);
                if squared > 0.0 && squared < kernel.radius * kernel.radius {
                    let weight = kernel.weight(squared);
                    kernel.reference_density += weight;
                    second_moment += weight * squared;
                    kernel.reference_neighbours += 1;
                }
            }
        }
        kernel.lambda = second_moment / kernel.reference_density;
        kernel
    }

    /// Weight at a squared distance \[m2\]; zero outside the radius.
    #[inline]
    pub fn weight(&self, squared_distance: f64) -> f64 {
        let distance = squared_distance.sqrt().max(self.floor);
        (self.radius / distance - 1.0).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_constants_by_hand() {
        // r_e = 2.1: neighbours at 1, sqrt 2, 2 spacings, four of each.
        let kernel = Kernel::new(2.1, Vector2::new(0.5, 0.5));
        let expected = 4.0 * (1.1 + (2.1 / 2f64.sqrt() - 1.0) + 0.05);
        assert!((kernel.reference_density - expected).abs() < 1e-12);
        assert_eq!(kernel.reference_neighbours, 12);
        let second = 4.0 * (1.1 + 2.0 * (2.1 / 2f64.sqrt() - 1.0) + 4.0 * 0.05) * 0.25;
        assert!((kernel.lambda - second / expected).abs() < 1e-12);
    }
}
