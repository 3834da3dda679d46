//! Which particles lie on the free surface, and which water hangs together without one.

use crate::neighbours::Neighbourhood;
use crate::operators::Density;
use crate::parameters::PaperParameters;

/// Whether a particle lies on the free surface: few neighbours by weight, and those few on one side or few in number.
///
/// The number count catches close pairs of droplets, whose weight is large although nobody else is around.
pub fn is_surface(density: &Density, reference_density: f64, spacing: f64, paper: &PaperParameters) -> bool {
    if density.number_density >= paper.surface_density * reference_density {
        return false;
    }
    let one_sided = density.centroid.norm() >= paper.surface_deviation * spacing;
    let few = (density.count as f64) < 1.6 * paper.influence_radius * paper.influence_radius;
    one_sided || few
}

/// Smallest group of particles without a surface that is still solved for: smaller ones fly freely.
const SMALLEST_ENCLOSED: usize = 50;

/// Finds unknowns that hang together with no surface particle. A few become surface themselves; the return value says
/// whether many remain, whose pressure is then determined only up to a constant.
pub fn settle_enclosed(
    around: &Neighbourhood,
    surface: &mut [bool],
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
            if !reached[j] {
                reached[j] = true;
                queue.push(neighbour.index);
            }
        }
    }
    queue.extend((0..surface.len() as u32).filter(|&i| !reached[i as usize]));
    if queue.len() >= SMALLEST_ENCLOSED {
        return true;
    }
    queue.iter().for_each(|&i| surface[i as usize] = true);
    false
}
