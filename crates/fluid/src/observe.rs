//! Figures that people look at, from a state.

use crate::fill::contains;
use crate::grid::{Grid, bounding_box};
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
    /// Potential energy in gravity above y = 0, and in the attraction \[J/m\].
    pub potential_energy: f64,
    /// Momentum \[kg/s\].
    pub momentum: Vector2<f64>,
    /// Centre of mass \[m\].
    pub centre: Vector2<f64>,
    /// Angular momentum about the origin \[kg m/s\].
    pub angular_momentum: f64,
    /// Lowest and highest x and y that water reaches \[m\].
    pub extent: [Vector2<f64>; 2],
    /// Largest distance of water from the origin \[m\].
    pub farthest: f64,
    /// Water level at each gauge \[m\]; minus infinity is never given: the lowest y of all water where there is none.
    pub levels: Vec<f64>,
    /// Area of the water \[m2\].
    pub area: f64,
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
        parameters: &setting.parameters,
        time: state.time,
        spacing: setting.spacing,
        walls: &walls,
    };
    let sum_of = |polygon: &Vec<Vector2<f64>>| {
        mass * state.positions.iter().filter(|position| contains(polygon, position)).count() as f64
    };
    let position_sum: Vector2<f64> = state.positions.iter().sum();
    let attraction = 0.5 * setting.parameters.attraction;
    let squared: f64 = state.positions.iter().map(|position| position.norm_squared()).sum();
    let potential = attraction * squared - setting.parameters.gravity.dot(&position_sum);
    let velocity_sum: Vector2<f64> = state.velocities.iter().sum();
    let squares: f64 = state.velocities.iter().map(|velocity| velocity.norm_squared()).sum();
    let company = 0.3 * setting.kernel.reference_density;
    let front = (0..count)
        .filter(|&i| state.number_densities[i] > company)
        .map(|i| state.positions[i].x)
        .fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = bounding_box(&state.positions);
    let extent = [low.add_scalar(-0.5 * setting.spacing), high.add_scalar(0.5 * setting.spacing)];
    Observables {
        probes: setting.geometry.probes.iter().map(|point| field.at_point(point)).collect(),
        region_masses: setting.geometry.regions.iter().map(sum_of).collect(),
        wall_force: fixed_wall_force(&field),
        front: if front.is_finite() { front + 0.5 * setting.spacing } else { 0.0 },
        kinetic_energy: 0.5 * mass * squares,
        potential_energy: mass * potential,
        momentum: velocity_sum * mass,
        centre: position_sum / count.max(1) as f64,
        angular_momentum: mass * state.positions.iter().zip(&state.velocities).map(|(r, u)| r.perp(u)).sum::<f64>(),
        extent,
        farthest: state.positions.iter().map(|place| place.norm()).fold(0.0, f64::max) + 0.5 * setting.spacing,
        levels: setting.geometry.gauges.iter().map(|&x| level(state, x, setting.spacing, extent[0].y)).collect(),
        area: count as f64 * setting.spacing * setting.spacing,
        maximum_speed: state.velocities.iter().map(|velocity| velocity.norm()).fold(0.0, f64::max),
        particles: count,
        lost: state.lost,
    }
}

/// Highest water within half a spacing of a vertical line.
fn level(state: &State, x: f64, spacing: f64, lowest: f64) -> f64 {
    let near = |place: &&Vector2<f64>| (place.x - x).abs() <= 0.75 * spacing;
    state.positions.iter().filter(near).map(|place| place.y + 0.5 * spacing).fold(lowest, f64::max)
}
