//! What keeps particles in front of walls.

use super::{FIXED, PanelMotion, WallProximity, Walls};
use crate::parallel::{CHUNK, Lists};
use crate::problem::Problem;
use crate::state::State;
use kinematics::Motion;
use nalgebra::Vector2;
use rayon::prelude::*;

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
    /// Whether particles lose their closing velocity; without it they are only kept in front.
    pub stops: bool,
}

/// What a moving panel took of the velocity of a particle, and how far any wall moved it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stop {
    /// Change of the particle's velocity \[m/s\]; zero for one that touched none.
    pub change: Vector2<f64>,
    /// The panel.
    pub panel: u32,
    /// Where on it, as a share of its length.
    pub fraction: f64,
    /// How far the particle was moved in front of walls \[m\].
    pub way: Vector2<f64>,
}

impl Contact {
    /// Contact that takes away the closing velocity of particles nearer than a tenth of a spacing.
    pub fn inelastic(spacing: f64) -> Self {
        let least = 0.1 * spacing;
        Self { reach: least, restitution: 0.0, least, spacing, stops: true }
    }
}

/// Keeps particles in front of walls as they stand at one instant; returns the number of contacts. `velocity_of` gives
/// the velocity of a place on a moving panel; `stops` says afterwards what moving panels took of each particle's velocity.
///
/// A particle nearer than half the collision distance (so that its image is a colliding neighbour) loses its
/// approaching velocity as in a collision, and none comes nearer than a tenth of a spacing.
pub fn stop_at_walls(
    (positions, velocities): (&mut [Vector2<f64>], &mut [Vector2<f64>]),
    proximities: &Lists<WallProximity>,
    walls: &Walls,
    contact: &Contact,
    velocity_of: impl Fn(u32, f64) -> Vector2<f64> + Sync,
    stops: &mut Vec<Stop>,
) -> usize {
    stops.resize(positions.len(), Stop::default());
    let particles = positions.par_iter_mut().zip(velocities).zip(stops).with_min_len(CHUNK).enumerate();
    let contacts = particles.map(|(i, ((position, velocity), stop))| {
        let mut contacts = 0;
        *stop = Stop::default();
        for entry in proximities.of(i) {
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
            if closing > 0.0 && contact.stops {
                let change = segment.normal * (-(1.0 + contact.restitution) * closing);
                *velocity += change;
                if segment.panel != FIXED {
                    *stop = Stop { change: stop.change + change, panel: segment.panel, fraction, ..*stop };
                }
            }
            if distance < contact.least {
                let way = segment.normal * (distance - contact.least);
                *position += way;
                stop.way += way;
            }
        }
        contacts
    });
    contacts.sum()
}

/// Walls where they stand at the end of a step.
#[derive(Debug, Default)]
pub struct EndWalls {
    walls: Walls,
    panels: PanelMotion,
    /// What walls did to each particle.
    pub stops: Vec<Stop>,
}

impl EndWalls {
    /// Keeps particles in front of the walls as these stand at the end of the step, with the body's motion `end` there;
    /// returns the number of contacts. `near` are the walls near each particle, and where these stood in the step.
    pub fn keep_in_front(
        &mut self,
        problem: &Problem,
        state: &mut State,
        end: &Motion,
        (proximities, walls): (&Lists<WallProximity>, &Walls),
        contact: &Contact,
    ) -> usize {
        let particles = (&mut state.positions[..], &mut state.velocities[..]);
        let bodies = &problem.geometry.bodies;
        if bodies.is_empty() {
            return stop_at_walls(particles, proximities, walls, contact, |_, _| Vector2::zeros(), &mut self.stops);
        }
        self.walls.place(&problem.layout, Some((bodies, &end.position)), problem.reach, problem.spacing);
        self.panels.set_start(&problem.layout.panels, bodies, end);
        let Self { walls, panels, stops } = self;
        let velocity_of = |panel, fraction| panels.velocity(panel, fraction);
        stop_at_walls(particles, proximities, walls, contact, velocity_of, stops)
    }
}
