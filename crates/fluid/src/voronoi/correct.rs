//! What the pressure does: to particles, to the body, to what is recorded.

use super::system::PressureSystem;
use crate::parallel::{self, CHUNK};
use crate::problem::Problem;
use crate::state::State;
use crate::time_step::TimeStep;
use nalgebra::Vector2;
use rayon::prelude::*;

/// u = u* - dt grad p / rho; the particles stand where they are in the middle of the step.
pub fn kick(state: &mut State, system: &PressureSystem, problem: &Problem, time_step: f64) {
    state.positions.copy_from_slice(&system.positions);
    let mut velocities = std::mem::take(&mut state.velocities);
    let before = &*state;
    parallel::fill(&mut velocities, |i| system.velocities[i] + system.kick_of(problem, before, i, time_step));
    state.velocities = velocities;
}

/// r = r + u t.
pub fn drift(positions: &mut [Vector2<f64>], velocities: &[Vector2<f64>], duration: f64) {
    positions.par_iter_mut().zip(velocities).with_min_len(CHUNK).for_each(|(position, u)| *position += u * duration);
}

/// Adds the load on the bodies, and the impulses of the particles that they stopped, over the communication step of which
/// this is a `share`.
pub fn add_load(state: &mut State, system: &PressureSystem, step: TimeStep) {
    let rate = step.share / step.length;
    let of_step = system.body_load.iter().zip(&system.stopped);
    state
        .load
        .iter_mut()
        .zip(of_step)
        .for_each(|(load, (force, impulse))| *load += force * step.share + impulse * rate);
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
