//! Particles that conform to the outline of the water: Lloyd's iteration inside the polygons.

use super::cells::{Cells, Setup};
use crate::parallel::Lists;
use crate::parameters::Geometry;
use crate::setup::fill::{area, contains, signed_area};
use crate::setup::outline::outline;
use crate::walls::{WallLayout, Walls};
use nalgebra::Vector2;

/// Iterations; each takes a particle all the way to the centroid of its cell.
const ITERATIONS: usize = 60;

/// Whether a polygon is a box along the axes, which a lattice fills exactly.
fn is_box(polygon: &[Vector2<f64>]) -> bool {
    let (low, high) = crate::grid::bounding_box(polygon);
    let size = high - low;
    (area(polygon) - size.x * size.y).abs() < 1e-9 * size.x * size.y
}

/// Moves the particles of every polygon that is no box to the centroids of their cells within it, and returns the area
/// that each particle owns \[m2\]. `counts` are the numbers of particles of the polygons, in order.
pub fn relax(positions: &mut [Vector2<f64>], counts: &[usize], water: &[Vec<Vector2<f64>>], spacing: f64) -> Vec<f64> {
    let mut areas = Vec::with_capacity(positions.len());
    let mut rest = positions;
    for (polygon, &count) in water.iter().zip(counts) {
        let (own, others) = rest.split_at_mut(count);
        rest = others;
        if is_box(polygon) {
            areas.extend(std::iter::repeat_n(area(polygon) / count as f64, count));
        } else {
            areas.extend(settle(own, polygon, spacing));
        }
    }
    areas
}

fn settle(positions: &mut [Vector2<f64>], polygon: &[Vector2<f64>], spacing: f64) -> Vec<f64> {
    let mut corners = polygon.to_vec();
    if signed_area(&corners) < 0.0 {
        corners.reverse();
    }
    let geometry = Geometry { fixed_walls: outline(&corners, spacing), ..Geometry::default() };
    let mut walls = Walls::default();
    walls.place(&WallLayout::new(&geometry, spacing), None, 2.0 * Cells::reach(spacing), spacing);
    let areas = vec![area(polygon) / positions.len() as f64; positions.len()];
    let mut proximities = Lists::default();
    let mut cells = Cells::default();
    for iteration in 0..=ITERATIONS {
        proximities.build(positions.len(), |i, out| walls.attach(&positions[i], out));
        let setup = Setup { positions, areas: &areas, proximities: &proximities, walls: &walls, spacing };
        cells.build(&setup);
        if iteration == ITERATIONS {
            break;
        }
        for (position, cell) in positions.iter_mut().zip(&cells.cells) {
            let moved = *position + cell.centroid;
            if contains(polygon, &moved) {
                *position = moved;
            }
        }
    }
    let total: f64 = cells.cells.iter().map(|cell| cell.area).sum();
    cells.cells.iter().map(|cell| cell.area * area(polygon) / total).collect()
}
