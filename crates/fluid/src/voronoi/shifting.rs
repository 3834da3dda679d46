//! What keeps particles well spread.

use super::facet::Facet;
use super::system::PressureSystem;
use crate::parallel::{self, CHUNK};
use crate::parameters::VoronoiParameters;
use crate::problem::Problem;
use crate::state::State;
use nalgebra::Vector2;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Distance in spacings below which particles crowd each other.
const CROWDED: f64 = 0.9;

/// A shift of all particles.
#[derive(Debug, Default)]
pub struct Shift {
    ways: Vec<Vector2<f64>>,
    /// Changes of the velocities, which follow \[m/s\].
    pub changes: Vec<Vector2<f64>>,
    some_are_close: bool,
}

impl Shift {
    /// Keeps particles well spread: towards the centroids of their cells, away from crowding ones, and to where there is
    /// more room. On the free surface they move along it only. Velocities move along the velocity field, and everything is
    /// in proportion to how much the water deforms in the step: a lattice in smooth flow is hardly touched.
    pub fn plan(
        &mut self,
        areas: &[f64],
        system: &PressureSystem,
        problem: &Problem,
        voronoi: &VoronoiParameters,
        time_step: f64,
    ) {
        let cells = &system.cells.cells;
        let close = AtomicBool::new(false);
        self.ways.resize(areas.len(), Vector2::zeros());
        self.changes.resize(areas.len(), Vector2::zeros());
        let way_of = |i: usize| {
            let cell = &cells[i];
            if system.cells.facets.of(i).iter().any(|facet| facet.height < TOO_CLOSE * problem.spacing) {
                close.store(true, Relaxed);
            }
            if cell.trust() == 0.0 {
                return Vector2::zeros();
            }
            let deformation = system.gradients[i].norm() * time_step;
            let share = |strength: f64, most: f64| (strength * deformation).min(most);
            let mut way = cell.centroid * share(voronoi.shifting, 0.5);
            way += away_from_crowds(system, i, problem.spacing) * share(voronoi.repulsion, 0.1);
            way += towards_room(system, areas, i, problem.spacing) * share(voronoi.spreading, 0.25);
            if cell.is_open() {
                let normal = cell.outward.try_normalize(0.0).unwrap_or_default();
                let along = (way - normal * way.dot(&normal)) * cell.flatness();
                way = way * (1.0 - cell.openness) + along * cell.openness;
            }
            way
        };
        let both = self.ways.par_iter_mut().zip(&mut self.changes).with_min_len(CHUNK).enumerate();
        both.for_each(|(i, (way, change))| {
            *way = way_of(i);
            *change = change_along(system, i, way);
        });
        self.some_are_close = close.into_inner();
    }

    /// Shifts particles and velocities. What was `taken` back of a velocity still moves the particle through the step: it
    /// belongs to the velocities without divergence that the pressure left.
    pub fn apply(
        &mut self,
        state: &mut State,
        system: &PressureSystem,
        spacing: f64,
        taken: &[Vector2<f64>],
        time_step: f64,
    ) {
        let moved = state.positions.par_iter_mut().zip(&mut state.velocities).with_min_len(CHUNK).enumerate();
        moved.for_each(|(i, (position, velocity))| {
            *position += self.ways[i] + taken[i] * time_step;
            *velocity += self.changes[i];
        });
        if self.some_are_close {
            part_pairs(state, system, spacing, &mut self.ways);
        }
    }
}

/// Change of the velocity field from particle i over `way`, which makes no new extremes: up to what its neighbours have
/// beyond it. A particle that is faster than all others tilts its own gradient; moved back along it again and again it
/// would get faster each time.
fn change_along(system: &PressureSystem, i: usize, way: &Vector2<f64>) -> Vector2<f64> {
    if *way == Vector2::zeros() {
        return Vector2::zeros();
    }
    let velocities = &system.velocities;
    let (mut low, mut high) = (Vector2::zeros(), Vector2::zeros());
    for facet in system.cells.facets.of(i) {
        let beyond = velocities[facet.neighbour as usize] - velocities[i];
        low = low.inf(&beyond);
        high = high.sup(&beyond);
    }
    (system.gradients[i] * way).sup(&low).inf(&high)
}

/// Distance in spacings below which two particles are parted whatever the flow does.
const TOO_CLOSE: f64 = 0.3;

/// Parts particles that nearly coincide, by half of what they lack of `TOO_CLOSE` each: their facet weighs its length
/// over their distance, beyond what the tolerance of the solver bears. In a jet one particle wide, where there is no
/// velocity gradient to shift by, nothing else keeps them apart.
fn part_pairs(state: &mut State, system: &PressureSystem, spacing: f64, scratch: &mut [Vector2<f64>]) {
    let least = TOO_CLOSE * spacing;
    let positions = &state.positions;
    parallel::fill(scratch, |i| {
        let close = system.cells.facets.of(i).iter().filter(|facet| facet.height < least);
        let part = |facet: &Facet| {
            let away = positions[i] - positions[facet.neighbour as usize];
            let distance = away.norm();
            let direction = if distance > 1e-3 * spacing { away / distance } else { -facet.normal };
            direction * (0.5 * (least - distance).max(0.0))
        };
        close.map(part).sum()
    });
    state.positions.par_iter_mut().zip(&*scratch).with_min_len(CHUNK).for_each(|(position, way)| *position += way);
}

/// Length in spacings of a facet that counts wholly in a crowd. A shorter one counts in proportion: with all of it for a
/// piece of no length two particles on either side of a solid's edge pushed each other from under it in turns, one step
/// each, and the load of a symmetric wedge swung by 9 per cent across its axis.
const COUNTED: f64 = 0.25;

/// Sum of the vectors away from particles and walls' images nearer than `CROWDED` spacings, as long as these are
/// nearer.
fn away_from_crowds(system: &PressureSystem, i: usize, spacing: f64) -> Vector2<f64> {
    let push = |facet: &Facet| {
        let share = (facet.length() / (COUNTED * spacing)).min(1.0);
        facet.normal * (share * (CROWDED * spacing - 2.0 * facet.height).max(0.0))
    };
    -system.cells.facets_and_walls(i).map(push).sum::<Vector2<f64>>()
}

/// Mean over the facets of the neighbours' room beyond the cell's own, as a share of a spacing.
fn towards_room(system: &PressureSystem, areas: &[f64], i: usize, spacing: f64) -> Vector2<f64> {
    let cells = &system.cells;
    let room = |j: usize| cells.cells[j].area / areas[j];
    let own = room(i);
    let (mut towards, mut around) = (Vector2::zeros(), 0.0);
    for facet in cells.facets.of(i) {
        let length = facet.length();
        towards += facet.normal * (length * (room(facet.neighbour as usize) - own));
        around += length;
    }
    if around > 0.0 { towards * (spacing / around) } else { towards }
}
