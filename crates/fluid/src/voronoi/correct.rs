//! What the pressure does: to particles, to the body, to what is recorded.

use super::operators;
use super::system::PressureSystem;
use crate::parallel::{self, CHUNK};
use crate::problem::Problem;
use crate::state::State;
use crate::time_step::TimeStep;
use nalgebra::Vector2;
use rayon::prelude::*;

/// Smallest and largest area of a cell over its particle's own whose mass counts as that of the cell. A splinter
/// between two walls that close on it would be thrown out at any speed.
const SMALLEST: f64 = 0.5;
const LARGEST: f64 = 2.0;

/// u = u* - dt grad p / rho; the particles stand where they are in the middle of the step.
pub fn kick(state: &mut State, system: &PressureSystem, problem: &Problem, time_step: f64) {
    state.positions.copy_from_slice(&system.positions);
    let density = problem.parameters.density;
    let cells = &system.cells;
    let pressures = &state.pressures;
    let areas = &state.areas;
    parallel::fill(&mut state.velocities, |i| {
        let cell = &cells.cells[i];
        let sum = operators::pressure_difference(cells, i, pressures) + system.wall_difference(problem, i);
        let volume = areas[i];
        let area = cell.filled.clamp(SMALLEST * volume, LARGEST * volume);
        system.velocities[i] - sum * (time_step / (density * area))
    });
}

/// r = r + u t.
pub fn drift(positions: &mut [Vector2<f64>], velocities: &[Vector2<f64>], duration: f64) {
    positions.par_iter_mut().zip(velocities).with_min_len(CHUNK).for_each(|(position, u)| *position += u * duration);
}

/// Adds the load of the pressure on the moving panels to `load`, times `share`, by virtual work. The pressure on a
/// facet is the one that stopped the water there, so that the water loses what the wall gains.
pub fn add_body_load(state: &mut State, system: &PressureSystem, problem: &Problem, share: f64) {
    for (facet, work) in system.unit_pressures.facets_with_work() {
        let i = facet.particle as usize;
        let slope = system.wall_slope(problem, facet, work);
        let pressure = state.pressures[i] + slope * facet.wall.facet.height;
        let force = pressure * facet.wall.facet.length() * share;
        for (load, work) in state.load.iter_mut().zip(work) {
            *load += force * work;
        }
    }
}

/// Adds the impulses of the particles that the bodies stopped, over the communication step of which this is a `share`.
pub fn add_stopped(state: &mut State, system: &PressureSystem, step: TimeStep) {
    let rate = step.share / step.length;
    state.load.iter_mut().zip(&system.stopped).for_each(|(load, impulse)| *load += impulse * rate);
}

/// Adds the added mass, times `share`.
pub fn add_added_mass(state: &mut State, system: &PressureSystem, share: f64) {
    for (sum, value) in state.added_mass.iter_mut().zip(&system.unit_pressures.added_mass) {
        *sum += value * share;
    }
}

/// Records what belongs to the state: free surface and how full cells are.
pub fn record(state: &mut State, system: &PressureSystem) {
    let cells = &system.cells.cells;
    let areas = &state.areas;
    let recorded = state.surface.par_iter_mut().zip(&mut state.number_densities).with_min_len(CHUNK).enumerate();
    recorded.for_each(|(i, (surface, density))| {
        *surface = cells[i].openness > 0.5;
        *density = areas[i] / cells[i].area.max(f64::MIN_POSITIVE);
    });
}
