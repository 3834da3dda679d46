//! Figures that people look at, from a state.

use crate::fill::contains;
use crate::grid::Grid;
use crate::load::{PressureField, fixed_wall_force};
use crate::prepare::Setting;
use crate::state::State;
use crate::walls::Walls;
use nalgebra::Vector2;

/// Figures of one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Observables {
    /// Pressures at the probes \[Pa\].
    pub probes: Vec<f64>,
    /// Water in each region \[kg/m\].
    pub region_masses: Vec<f64>,
    /// Force of the water on the fixed walls \[N/m\].
    pub wall_force: Vector2<f64>,
    /// Largest x that water reaches, half a spacing beyond the outermost particle that has company \[m\].
    pub front: f64,
    /// Kinetic energy \[J/m\].
    pub kinetic_energy: f64,
    /// Potential energy above y = 0 \[J/m\].
    pub potential_energy: f64,
    /// Momentum \[kg/s\].
    pub momentum: Vector2<f64>,
    /// Centre of mass \[m\].
    pub centre: Vector2<f64>,
    /// Largest speed \[m/s\].
    pub maximum_speed: f64,
    /// Particles.
    pub particles: usize,
    /// Particles lost so far.
    pub lost: usize,
}

/// Computes the figures of `state`.
pub fn observe(setting: &Setting, state: &State) -> Observables {
    let density = setting.parameters.density;
    let mass = density * setting.spacing * setting.spacing;
    let gravity = setting.parameters.gravity;
    let count = state.positions.len();
    let mut walls = Walls::default();
    let body = setting.geometry.body.as_ref().map(|body| (body, &state.motion.position));
    walls.place(&setting.layout, body, setting.kernel.radius, setting.spacing);
    let mut grid = Grid::default();
    grid.build(&state.positions, setting.kernel.radius);
    let field = PressureField {
        grid: &grid,
        positions: &state.positions,
        pressures: &state.pressures,
        density,
        gravity,
        spacing: setting.spacing,
        walls: &walls,
    };
    let sum_of = |polygon: &Vec<Vector2<f64>>| {
        mass * state.positions.iter().filter(|position| contains(polygon, position)).count() as f64
    };
    let position_sum: Vector2<f64> = state.positions.iter().sum();
    let velocity_sum: Vector2<f64> = state.velocities.iter().sum();
    let squares: f64 = state.velocities.iter().map(|velocity| velocity.norm_squared()).sum();
    let company = 0.3 * setting.kernel.reference_density;
    let front = (0..count)
        .filter(|&i| state.number_densities[i] > company)
        .map(|i| state.positions[i].x)
        .fold(f64::NEG_INFINITY, f64::max);
    Observables {
        probes: setting.geometry.probes.iter().map(|point| field.at_point(point)).collect(),
        region_masses: setting.geometry.regions.iter().map(sum_of).collect(),
        wall_force: fixed_wall_force(&field),
        front: if front.is_finite() { front + 0.5 * setting.spacing } else { 0.0 },
        kinetic_energy: 0.5 * mass * squares,
        potential_energy: -mass * gravity.dot(&position_sum),
        momentum: velocity_sum * mass,
        centre: position_sum / count.max(1) as f64,
        maximum_speed: state.velocities.iter().map(|velocity| velocity.norm()).fold(0.0, f64::max),
        particles: count,
        lost: state.lost,
    }
}
