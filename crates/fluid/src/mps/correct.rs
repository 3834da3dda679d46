//! What happens to particles after the pressure: correction, shifting, collisions.

use super::Method;
use super::free_surface::is_beside_surface;
use super::system::PressureSystem;
use crate::parallel;
use crate::problem::Problem;
use crate::state::State;
use nalgebra::Vector2;

/// Corrects velocities and positions with the pressure gradient: u = u* - dt grad p / rho, r = r* + (u - u*) dt.
pub fn correct(
    state: &mut State,
    system: &PressureSystem,
    problem: &Problem,
    method: &Method,
    time_step: f64,
    scratch: &mut Vec<Vector2<f64>>,
) {
    let operators = system.operators(&method.kernel);
    let density = problem.parameters.density;
    let least = if method.parameters.tension { f64::NEG_INFINITY } else { 0.0 };
    let pressure = |i: usize| state.pressures[i].max(least);
    scratch.resize(state.positions.len(), Vector2::zeros());
    parallel::fill(scratch, |i| {
        operators.pressure_gradient(i, pressure, |image| system.rise(problem, image)) * (-time_step / density)
    });
    for (i, change) in scratch.iter().enumerate() {
        let force = problem.parameters.body_force(&state.positions[i], system.time);
        state.velocities[i] += force * time_step + change;
        state.positions[i] = system.positions[i] + change * time_step;
    }
}

/// Moves interior particles away from crowds, by `shifting` spacings for a full Courant step and a one-sided crowd.
/// Velocities stay: the shift is a small fraction of what a particle moves in the step.
pub fn shift(
    state: &mut State,
    system: &PressureSystem,
    problem: &Problem,
    method: &Method,
    time_step: f64,
    scratch: &mut [Vector2<f64>],
) {
    if method.parameters.shifting == 0.0 {
        return;
    }
    let operators = system.operators(&method.kernel);
    let velocities = &state.velocities;
    parallel::fill(scratch, |i| {
        if system.surface[i] || is_beside_surface(i, &system.around, &system.surface) {
            return Vector2::zeros();
        }
        let travel = velocities[i].norm() * time_step / (method.parameters.courant * problem.spacing);
        operators.crowding(i) * (-method.parameters.shifting * problem.spacing * travel.min(1.0))
    });
    add(&mut state.positions, scratch);
}

/// Collisions of pairs nearer than the collision distance: equal masses, coefficient of restitution e.
///
/// Each particle adds up the impulses of its own close neighbours; the pair's other half adds the opposite, so that
/// momentum is kept.
pub fn collide(
    state: &mut State,
    system: &PressureSystem,
    problem: &Problem,
    method: &Method,
    scratch: &mut [Vector2<f64>],
) {
    let reach = method.parameters.collision_distance * problem.spacing;
    let strength = 0.5 * (1.0 + method.parameters.restitution);
    let (positions, velocities) = (&state.positions, &state.velocities);
    parallel::fill(scratch, |i| {
        let mut change = Vector2::zeros();
        for neighbour in system.around.neighbours.of(i) {
            let j = neighbour.index as usize;
            let between = positions[j] - positions[i];
            let squared = between.norm_squared();
            if squared >= reach * reach || squared == 0.0 {
                continue;
            }
            let closing = (velocities[i] - velocities[j]).dot(&between) / squared;
            if closing > 0.0 {
                change -= between * (strength * closing);
            }
        }
        change
    });
    add(&mut state.velocities, scratch);
}

/// Moves pairs apart that are nearer than 0.6 spacings, by a tenth of what is missing, half each.
///
/// Surface particles have p = 0 and nothing else keeps them apart: two that drift together end as one of double weight,
/// which then passes for full water and is thrown out. Velocities stay.
pub fn separate(state: &mut State, system: &PressureSystem, problem: &Problem, scratch: &mut [Vector2<f64>]) {
    let reach = 0.6 * problem.spacing;
    let positions = &state.positions;
    parallel::fill(scratch, |i| {
        let mut change = Vector2::zeros();
        for neighbour in system.around.neighbours.of(i) {
            let between = positions[neighbour.index as usize] - positions[i];
            let distance = between.norm();
            if distance < reach && distance > 0.0 {
                change -= between * (0.05 * (reach - distance) / distance);
            }
        }
        change
    });
    add(&mut state.positions, scratch);
}

fn add(values: &mut [Vector2<f64>], changes: &[Vector2<f64>]) {
    values.iter_mut().zip(changes).for_each(|(value, change)| *value += change);
}
