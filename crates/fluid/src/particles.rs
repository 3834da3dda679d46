//! What happens to particles after the pressure: correction, shifting, collisions, walls.

use crate::free_surface::is_beside_surface;
use crate::parallel::{self, CHUNK, Lists};
use crate::parameters::Parameters;
use crate::prepare::{Prepared, Setting};
use crate::state::State;
use crate::walls::{Attachment, Walls};
use nalgebra::Vector2;
use rayon::prelude::*;

/// Corrects velocities and positions with the pressure gradient: u = u* - dt grad p / rho, r = r* + (u - u*) dt.
pub fn correct(
    state: &mut State,
    prepared: &Prepared,
    setting: &Setting,
    time_step: f64,
    scratch: &mut Vec<Vector2<f64>>,
) {
    let operators = prepared.operators(&setting.kernel);
    let density = setting.parameters.density;
    let least = if setting.paper.tension { f64::NEG_INFINITY } else { 0.0 };
    let pressure = |i: usize| state.pressures[i].max(least);
    scratch.resize(state.positions.len(), Vector2::zeros());
    parallel::fill(scratch, |i| {
        operators.pressure_gradient(i, pressure, |image| prepared.rise(setting, image)) * (-time_step / density)
    });
    for (i, change) in scratch.iter().enumerate() {
        let force = setting.parameters.body_force(&state.positions[i], prepared.time);
        state.velocities[i] += force * time_step + change;
        state.positions[i] = prepared.positions[i] + change * time_step;
    }
}

/// Slows the water in the damping zones.
pub fn slow(state: &mut State, parameters: &Parameters, duration: f64) {
    if parameters.damping.is_empty() {
        return;
    }
    let moved = state.velocities.par_iter_mut().zip(&state.positions).with_min_len(CHUNK);
    moved.for_each(|(velocity, place)| *velocity *= parameters.kept_velocity(place, duration));
}

/// Moves interior particles away from crowds, by `shifting` spacings for a full Courant step and a one-sided crowd.
/// Velocities stay: the shift is a small fraction of what a particle moves in the step.
pub fn shift(state: &mut State, prepared: &Prepared, setting: &Setting, time_step: f64, scratch: &mut [Vector2<f64>]) {
    if setting.paper.shifting == 0.0 {
        return;
    }
    let operators = prepared.operators(&setting.kernel);
    let velocities = &state.velocities;
    parallel::fill(scratch, |i| {
        if prepared.surface[i] || is_beside_surface(i, &prepared.around, &prepared.surface) {
            return Vector2::zeros();
        }
        let travel = velocities[i].norm() * time_step / (setting.paper.courant * setting.spacing);
        operators.crowding(i) * (-setting.paper.shifting * setting.spacing * travel.min(1.0))
    });
    add(&mut state.positions, scratch);
}

/// Collisions of pairs nearer than the collision distance: equal masses, coefficient of restitution e.
///
/// Each particle adds up the impulses of its own close neighbours; the pair's other half adds the opposite, so that
/// momentum is kept.
pub fn collide(state: &mut State, prepared: &Prepared, setting: &Setting, scratch: &mut [Vector2<f64>]) {
    let reach = setting.paper.collision_distance * setting.spacing;
    let strength = 0.5 * (1.0 + setting.paper.restitution);
    let (positions, velocities) = (&state.positions, &state.velocities);
    parallel::fill(scratch, |i| {
        let mut change = Vector2::zeros();
        for neighbour in prepared.around.neighbours.of(i) {
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
pub fn separate(state: &mut State, prepared: &Prepared, setting: &Setting, scratch: &mut [Vector2<f64>]) {
    let reach = 0.6 * setting.spacing;
    let positions = &state.positions;
    parallel::fill(scratch, |i| {
        let mut change = Vector2::zeros();
        for neighbour in prepared.around.neighbours.of(i) {
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

/// How particles touch walls; distances in metres.
#[derive(Debug, Clone, Copy)]
pub struct Contact {
    /// Distance below which an approaching particle collides.
    pub reach: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Distance that particles keep.
    pub least: f64,
    /// Particle spacing.
    pub spacing: f64,
}

impl Contact {
    /// Contact that takes away the closing velocity of particles nearer than a tenth of a spacing.
    pub fn inelastic(spacing: f64) -> Self {
        let least = 0.1 * spacing;
        Self { reach: least, restitution: 0.0, least, spacing }
    }
}

/// Keeps particles in front of walls as they stand at one instant; returns the number of contacts. `velocity_of` gives
/// the velocity of a place on a moving panel.
///
/// A particle nearer than half the collision distance (so that its image is a colliding neighbour) loses its
/// approaching velocity as in a collision, and none comes nearer than a tenth of a spacing.
pub fn stop_at_walls(
    (positions, velocities): (&mut [Vector2<f64>], &mut [Vector2<f64>]),
    attachments: &Lists<Attachment>,
    walls: &Walls,
    contact: &Contact,
    velocity_of: impl Fn(u32, f64) -> Vector2<f64> + Sync,
) -> usize {
    let particles = positions.par_iter_mut().zip(velocities).with_min_len(CHUNK).enumerate();
    let contacts = particles.map(|(i, (position, velocity))| {
        let mut contacts = 0;
        for entry in attachments.of(i) {
            // A strongly bent wall may have broken into other chains since the particle was attached.
            let Some(chain) = walls.chains.get(entry.chain as usize) else { continue };
            let near = walls.candidates(position).iter().map(|&index| &walls.segments[index as usize]);
            let Some(segment) = near
                .filter(|segment| segment.chain == entry.chain)
                .min_by(|a, b| a.squared_distance(position).total_cmp(&b.squared_distance(position)))
            else {
                continue;
            };
            let (distance, along) = segment.local(position);
            let farthest = -(0.5 * chain.depth).min(contact.spacing);
            let beside = (0.0..=chain.length).contains(&(segment.arc + along));
            if distance >= contact.reach || distance < farthest || !beside {
                continue;
            }
            contacts += 1;
            let fraction = (along / segment.length).clamp(0.0, 1.0);
            let relative = *velocity - velocity_of(segment.panel, fraction);
            let closing = relative.dot(&segment.normal);
            if closing > 0.0 {
                *velocity -= segment.normal * ((1.0 + contact.restitution) * closing);
            }
            if distance < contact.least {
                *position -= segment.normal * (contact.least - distance);
            }
        }
        contacts
    });
    contacts.sum()
}

/// Removes particles that left the domain and returns their number.
pub fn remove_lost(state: &mut State, low: &Vector2<f64>, high: &Vector2<f64>) -> usize {
    let inside = |point: &Vector2<f64>| point.x >= low.x && point.x <= high.x && point.y >= low.y && point.y <= high.y;
    if parallel::all(state.positions.len(), |i| inside(&state.positions[i])) {
        return 0;
    }
    let keep: Vec<bool> = state.positions.iter().map(inside).collect();
    let before = keep.len();
    retain(&mut state.velocities, &keep);
    retain(&mut state.pressures, &keep);
    retain(&mut state.volumes, &keep);
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
