//! Neighbour lists with weights, built from cells; a wall between two particles hides them from each other.

use super::images::{self, Image};
use super::kernel::Kernel;
use super::neighbour::Neighbour;
use crate::grid::Grid;
use crate::parallel::Lists;
use crate::walls::{WallProximity, Walls};
use nalgebra::Vector2;

/// Everything that particles see around them: other particles, and images behind walls.
#[derive(Debug, Clone, Default)]
pub struct Neighbourhood {
    /// Cells of the search.
    pub grid: Grid,
    /// Particles within the effective radius.
    pub neighbours: Lists<Neighbour>,
    /// Images within the effective radius.
    pub images: Lists<Image>,
}

impl Neighbourhood {
    /// Searches the neighbours of all particles and mirrors them in the walls that they are attached to.
    pub fn build(
        &mut self,
        positions: &[Vector2<f64>],
        proximities: &Lists<WallProximity>,
        walls: &Walls,
        kernel: &Kernel,
    ) {
        self.grid.build(positions, kernel.radius);
        let squared_radius = kernel.radius * kernel.radius;
        let grid = &self.grid;
        self.neighbours.build(positions.len(), |i, out| {
            let here = positions[i];
            let near_wall = !walls.candidates(&here).is_empty();
            grid.for_each_near(&here, |j| {
                let squared = (positions[j] - here).norm_squared();
                if squared < squared_radius && j != i && !(near_wall && walls.separates(&here, &positions[j])) {
                    out.push(Neighbour { index: j as u32, weight: kernel.weight(squared) });
                }
            });
        });
        images::build(&mut self.images, positions, &self.neighbours, proximities, walls, kernel);
    }
}
