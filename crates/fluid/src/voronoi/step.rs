//! What happens to particles after the pressure.

use super::operators;
use super::prepare::Prepared;
use crate::parallel;
use crate::parameters::AccurateParameters;
use crate::prepare::Setting;
use crate::state::State;
use crate::walls::FIXED;
use kinematics::{Body, MaterialPoint};
use nalgebra::Vector2;

/// u = u* - dt grad p / rho, r = r + dt u.
pub fn correct(state: &mut State, prepared: &Prepared, setting: &Setting, time_step: f64) {
    let density = setting.parameters.density;
    let cells = &prepared.cells;
    let pressures = &state.pressures;
    let volumes = &state.volumes;
    parallel::fill(&mut state.velocities, |i| {
        let cell = &cells.cells[i];
        let mut sum = operators::pressure_difference(cells, i, pressures);
        for wall in cells.walls.of(i) {
            let facet = &wall.facet;
            sum += facet.middle() * (facet.length() * prepared.wall_slope(setting, i, wall));
        }
        let area = if cell.is_open() { volumes[i] } else { cell.area };
        prepared.velocities[i] - sum * (time_step / (density * area))
    });
    let velocities = &state.velocities;
    for (position, velocity) in state.positions.iter_mut().zip(velocities) {
        *position += velocity * time_step;
    }
}

/// Adds the load of the pressure on the moving panels to `load`, times `share`, by virtual work. The pressure on a
/// facet is the one that stopped the water there, so that the water loses what the wall gains.
pub fn add_body_load(state: &mut State, prepared: &Prepared, setting: &Setting, body: &Body, share: f64) {
    let State { load, pressures, motion, .. } = state;
    for (i, pressure) in pressures.iter().enumerate() {
        for wall in prepared.cells.walls.of(i).iter().filter(|wall| wall.panel != FIXED) {
            let facet = &wall.facet;
            let on_wall = pressure + prepared.wall_slope(setting, i, wall) * facet.height;
            let [start, end] = setting.layout.panels[wall.panel as usize];
            if let Some(point) = MaterialPoint::between(start, end, wall.fraction) {
                let force = facet.normal * (on_wall * facet.length() * share);
                body.add_force(point, &motion.position, force, load);
            }
        }
    }
}

/// Distance in spacings below which particles crowd each other.
const CROWDED: f64 = 0.9;

/// Moves particles towards the centroids of their cells, and their velocities along the velocity field.
pub fn shift(
    state: &mut State,
    prepared: &Prepared,
    setting: &Setting,
    accurate: &AccurateParameters,
    time_step: f64,
    scratch: &mut Vec<Vector2<f64>>,
) {
    if accurate.shifting == 0.0 {
        return;
    }
    scratch.resize(state.positions.len(), Vector2::zeros());
    let cells = &prepared.cells;
    parallel::fill(scratch, |i| {
        let cell = &cells.cells[i];
        let rate = prepared.gradients[i].norm() * time_step;
        let mut way = cell.centroid * (accurate.shifting * rate).min(0.5);
        let spacing = setting.spacing;
        let mut apart = Vector2::zeros();
        for facet in cells.facets.of(i) {
            let distance = 2.0 * facet.height;
            apart -= facet.normal * (CROWDED * spacing - distance).max(0.0);
        }
        for wall in cells.walls.of(i) {
            let distance = 2.0 * wall.facet.height;
            apart -= wall.facet.normal * (CROWDED * spacing - distance).max(0.0);
        }
        way += apart * (accurate.repulsion * rate).min(0.1);
        if cell.is_open() {
            let length = cell.outward.norm();
            let flatness = cell.flatness();
            if flatness == 0.0 {
                return Vector2::zeros();
            }
            let normal = cell.outward / length;
            way = (way - normal * way.dot(&normal)) * flatness;
        }
        way
    });
    for (i, way) in scratch.iter().enumerate() {
        state.positions[i] += way;
        state.velocities[i] += prepared.gradients[i] * way;
    }
}

/// Records what belongs to the state: free surface and how full cells are.
pub fn record(state: &mut State, prepared: &Prepared, reference_density: f64) {
    let cells = &prepared.cells.cells;
    for (flag, cell) in state.surface.iter_mut().zip(cells) {
        *flag = cell.is_open();
    }
    for ((value, cell), volume) in state.number_densities.iter_mut().zip(cells).zip(&state.volumes) {
        *value = reference_density * volume / cell.area.max(f64::MIN_POSITIVE);
    }
}
