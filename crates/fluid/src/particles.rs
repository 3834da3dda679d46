//! What happens to particles in every discretisation: damping zones, and the loss of those that left the domain.

use crate::parallel::{self, CHUNK};
use crate::parameters::Parameters;
use crate::state::State;
use nalgebra::Vector2;
use rayon::prelude::*;

/// Slows the water in the damping zones.
pub fn slow(state: &mut State, parameters: &Parameters, duration: f64) {
    if parameters.damping.is_empty() {
        return;
    }
    let moved = state.velocities.par_iter_mut().zip(&state.positions).with_min_len(CHUNK);
    moved.for_each(|(velocity, place)| *velocity *= parameters.kept_velocity(place, duration));
}

fn is_inside(point: &Vector2<f64>, low: &Vector2<f64>, high: &Vector2<f64>) -> bool {
    point.x >= low.x && point.x <= high.x && point.y >= low.y && point.y <= high.y
}

/// Whether some particles left the domain.
pub fn some_left(state: &State, low: &Vector2<f64>, high: &Vector2<f64>) -> bool {
    !parallel::all(state.positions.len(), |i| is_inside(&state.positions[i], low, high))
}

/// Removes particles that left the domain and returns their number.
pub fn remove_lost(state: &mut State, low: &Vector2<f64>, high: &Vector2<f64>) -> usize {
    let keep: Vec<bool> = state.positions.iter().map(|point| is_inside(point, low, high)).collect();
    let before = keep.len();
    retain(&mut state.velocities, &keep);
    retain(&mut state.pressures, &keep);
    retain(&mut state.areas, &keep);
    retain(&mut state.area_rates, &keep);
    retain(&mut state.number_densities, &keep);
    retain(&mut state.surface, &keep);
    retain(&mut state.positions, &keep);
    before - state.positions.len()
}

fn retain<T>(values: &mut Vec<T>, keep: &[bool]) {
    let mut flags = keep.iter();
    values.retain(|_| flags.next().copied().unwrap_or(true));
}
