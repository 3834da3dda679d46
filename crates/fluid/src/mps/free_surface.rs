//! Which particles lie on the free surface, and which water hangs together without one.

use super::neighbourhood::Neighbourhood;
use super::operators::{Density, Operators};
use crate::parameters::MpsParameters;

/// How far a particle looks for something above it, in spacings: beyond, a gap counts as air.
pub const REACH: f64 = 1.8;
/// Cosine of the half-angle of the cone in which it looks.
const CONE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Whether a particle lies on the free surface: few neighbours, or neighbours on one side and nothing in a cone of 45
/// degrees on the other.
///
/// The count catches close pairs of droplets and drops on a wall: as unknowns they would make the matrix nearly
/// singular. The usual test of the number density, n < 0.97 n0, is left out: a film thinner than a spacing on a wall
/// stands so close to its own image that it passes for full water, and where it runs into a corner the solve answers
/// with a pressure that throws single particles out at several times their speed. The cone is the idea of Marrone et
/// al. (2010).
pub fn is_surface(
    i: usize,
    density: &Density,
    operators: &Operators,
    spacing: f64,
    parameters: &MpsParameters,
) -> bool {
    if (density.count as f64) < 1.6 * parameters.influence_radius * parameters.influence_radius {
        return true;
    }
    let deviation = density.centroid.norm();
    if deviation < parameters.surface_deviation * spacing {
        return false;
    }
    let open = -density.centroid / deviation;
    let squared_reach = (REACH * spacing).powi(2);
    let covers = |vector: &nalgebra::Vector2<f64>| {
        let squared = vector.norm_squared();
        squared < squared_reach && vector.dot(&open) > CONE * squared.sqrt()
    };
    let here = operators.positions[i];
    let mut direct = operators.around.neighbours.of(i).iter();
    let mut mirrored = operators.around.images.of(i).iter();
    !direct.any(|entry| covers(&(operators.positions[entry.index as usize] - here)))
        && !mirrored.any(|image| covers(&image.vector))
}

/// Whether a neighbour of particle i lies on the surface.
pub fn is_beside_surface(i: usize, around: &Neighbourhood, surface: &[bool]) -> bool {
    around.neighbours.of(i).iter().any(|entry| surface[entry.index as usize])
}

/// Smallest group of particles without a surface that is still solved for: smaller ones fly freely.
const SMALLEST_CLOSED: usize = 50;

/// Finds unknowns that hang together with no surface particle. A few become surface themselves; the return value says
/// whether many remain, whose pressure is then determined only up to a constant.
///
/// Only links of at least `strong` weight count: a group tied to the surface by a pair almost an effective radius apart
/// has a matrix so nearly singular that its pressure, and with it a load, is noise.
pub fn settle_closed(
    around: &Neighbourhood,
    surface: &mut [bool],
    strong: f64,
    reached: &mut Vec<bool>,
    queue: &mut Vec<u32>,
) -> bool {
    reached.clear();
    reached.extend_from_slice(surface);
    queue.clear();
    queue.extend((0..surface.len() as u32).filter(|&i| surface[i as usize]));
    while let Some(i) = queue.pop() {
        for neighbour in around.neighbours.of(i as usize) {
            let j = neighbour.index as usize;
            if !reached[j] && neighbour.weight >= strong {
                reached[j] = true;
                queue.push(neighbour.index);
            }
        }
    }
    queue.extend((0..surface.len() as u32).filter(|&i| !reached[i as usize]));
    if queue.len() >= SMALLEST_CLOSED {
        return true;
    }
    queue.iter().for_each(|&i| surface[i as usize] = true);
    false
}
