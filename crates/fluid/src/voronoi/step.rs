//! What happens to particles after the pressure.

use super::facet::Facet;
use super::operators;
use super::prepare::Prepared;
use crate::parallel::{self, CHUNK};
use crate::parameters::AccurateParameters;
use crate::prepare::Setting;
use crate::state::State;
use nalgebra::Vector2;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Smallest and largest area of a cell over its particle's own whose mass counts as that of the cell. A splinter
/// between two walls that close on it would be thrown out at any speed.
const SMALLEST: f64 = 0.5;
const LARGEST: f64 = 2.0;

/// u = u* - dt grad p / rho; the particles stand where they are in the middle of the step.
pub fn kick(state: &mut State, prepared: &Prepared, setting: &Setting, time_step: f64) {
    state.positions.copy_from_slice(&prepared.positions);
    let density = setting.parameters.density;
    let cells = &prepared.cells;
    let pressures = &state.pressures;
    let volumes = &state.volumes;
    parallel::fill(&mut state.velocities, |i| {
        let cell = &cells.cells[i];
        let sum = operators::pressure_difference(cells, i, pressures) + prepared.wall_difference(setting, i);
        let volume = volumes[i];
        let area = cell.filled.clamp(SMALLEST * volume, LARGEST * volume);
        prepared.velocities[i] - sum * (time_step / (density * area))
    });
}

/// r = r + u t.
pub fn drift(positions: &mut [Vector2<f64>], velocities: &[Vector2<f64>], duration: f64) {
    positions.par_iter_mut().zip(velocities).with_min_len(CHUNK).for_each(|(position, u)| *position += u * duration);
}

/// Adds the load of the pressure on the moving panels to `load`, times `share`, by virtual work. The pressure on a
/// facet is the one that stopped the water there, so that the water loses what the wall gains.
pub fn add_body_load(state: &mut State, prepared: &Prepared, setting: &Setting, share: f64) {
    for (facet, work) in prepared.responses.facets_with_work() {
        let i = facet.particle as usize;
        let slope = prepared.wall_slope(setting, facet, work);
        let pressure = state.pressures[i] + slope * facet.wall.facet.height;
        let force = pressure * facet.wall.facet.length() * share;
        for (load, work) in state.load.iter_mut().zip(work) {
            *load += force * work;
        }
    }
}

/// Distance in spacings below which particles crowd each other.
const CROWDED: f64 = 0.9;

/// Keeps particles well spread: towards the centroids of their cells, away from crowding ones, and to where there is
/// more room. On the free surface they move along it only. Velocities move along the velocity field, and everything is
/// in proportion to how much the water deforms in the step: a lattice in smooth flow is hardly touched.
pub fn shift(
    state: &mut State,
    prepared: &Prepared,
    setting: &Setting,
    accurate: &AccurateParameters,
    time_step: f64,
    scratch: &mut Vec<Vector2<f64>>,
) {
    scratch.resize(state.positions.len(), Vector2::zeros());
    let cells = &prepared.cells.cells;
    let volumes = &state.volumes;
    let close = AtomicBool::new(false);
    parallel::fill(scratch, |i| {
        let cell = &cells[i];
        if prepared.cells.facets.of(i).iter().any(|facet| facet.height < TOO_CLOSE * setting.spacing) {
            close.store(true, Relaxed);
        }
        if cell.trust() == 0.0 {
            return Vector2::zeros();
        }
        let deformation = prepared.gradients[i].norm() * time_step;
        let share = |strength: f64, most: f64| (strength * deformation).min(most);
        let mut way = cell.centroid * share(accurate.shifting, 0.5);
        way += away_from_crowds(prepared, i, setting.spacing) * share(accurate.repulsion, 0.1);
        way += towards_room(prepared, volumes, i, setting.spacing) * share(accurate.spreading, 0.25);
        if cell.is_open() {
            let normal = cell.outward.try_normalize(0.0).unwrap_or_default();
            let along = (way - normal * way.dot(&normal)) * cell.flatness();
            way = way * (1.0 - cell.openness) + along * cell.openness;
        }
        way
    });
    let moved =
        state.positions.par_iter_mut().zip(&mut state.velocities).zip(&*scratch).with_min_len(CHUNK).enumerate();
    moved.for_each(|(i, ((position, velocity), way))| {
        *position += way;
        *velocity += change_along(prepared, i, way);
    });
    if close.into_inner() {
        part_pairs(state, prepared, setting.spacing, scratch);
    }
}

/// Change of the velocity field from particle i over `way`, which makes no new extremes: up to what its neighbours have
/// beyond it. A particle that is faster than all others tilts its own gradient; moved back along it again and again it
/// would get faster each time.
fn change_along(prepared: &Prepared, i: usize, way: &Vector2<f64>) -> Vector2<f64> {
    if *way == Vector2::zeros() {
        return Vector2::zeros();
    }
    let velocities = &prepared.velocities;
    let (mut low, mut high) = (Vector2::zeros(), Vector2::zeros());
    for facet in prepared.cells.facets.of(i) {
        let beyond = velocities[facet.neighbour as usize] - velocities[i];
        low = low.inf(&beyond);
        high = high.sup(&beyond);
    }
    (prepared.gradients[i] * way).sup(&low).inf(&high)
}

/// Distance in spacings below which two particles are parted whatever the flow does.
const TOO_CLOSE: f64 = 0.3;

/// Parts particles that nearly coincide, by half of what they lack of `TOO_CLOSE` each: their facet weighs its length
/// over their distance, beyond what the tolerance of the solver bears. In a jet one particle wide, where there is no
/// velocity gradient to shift by, nothing else keeps them apart.
fn part_pairs(state: &mut State, prepared: &Prepared, spacing: f64, scratch: &mut [Vector2<f64>]) {
    let least = TOO_CLOSE * spacing;
    let positions = &state.positions;
    parallel::fill(scratch, |i| {
        let close = prepared.cells.facets.of(i).iter().filter(|facet| facet.height < least);
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
fn away_from_crowds(prepared: &Prepared, i: usize, spacing: f64) -> Vector2<f64> {
    let push = |facet: &Facet| {
        let share = (facet.length() / (COUNTED * spacing)).min(1.0);
        facet.normal * (share * (CROWDED * spacing - 2.0 * facet.height).max(0.0))
    };
    -prepared.cells.facets_and_walls(i).map(push).sum::<Vector2<f64>>()
}

/// Mean over the facets of the neighbours' room beyond the cell's own, as a share of a spacing.
fn towards_room(prepared: &Prepared, volumes: &[f64], i: usize, spacing: f64) -> Vector2<f64> {
    let cells = &prepared.cells;
    let room = |j: usize| cells.cells[j].area / volumes[j];
    let own = room(i);
    let (mut towards, mut around) = (Vector2::zeros(), 0.0);
    for facet in cells.facets.of(i) {
        let length = facet.length();
        towards += facet.normal * (length * (room(facet.neighbour as usize) - own));
        around += length;
    }
    if around > 0.0 { towards * (spacing / around) } else { towards }
}

/// Records what belongs to the state: free surface and how full cells are.
pub fn record(state: &mut State, prepared: &Prepared, reference_density: f64) {
    let cells = &prepared.cells.cells;
    let volumes = &state.volumes;
    let recorded = state.surface.par_iter_mut().zip(&mut state.number_densities).with_min_len(CHUNK).enumerate();
    recorded.for_each(|(i, (surface, density))| {
        *surface = cells[i].openness > 0.5;
        *density = reference_density * volumes[i] / cells[i].area.max(f64::MIN_POSITIVE);
    });
}
