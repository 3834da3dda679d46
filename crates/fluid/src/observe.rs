//! Figures that people look at, from a state.

use crate::fill::contains;
use crate::grid::Grid;
use crate::load::{PressureField, fixed_wall_force};
use crate::parameters::{Probe, Region, Scheme};
use crate::prepare::Setting;
use crate::state::State;
use crate::voronoi::cells::Cells;
use crate::voronoi::outline::Outline;
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

/// Distance in spacings within which a probe stands on a wall.
const ON_WALL: f64 = 0.25;

/// Computes the figures of `state`; `cells` are its cells if they are known.
pub fn observe(setting: &Setting, state: &State, cells: Option<&Cells>) -> Observables {
    let walls = setting.walls(&state.motion.position);
    let mut grid = Grid::default();
    if !setting.geometry.probes.is_empty() || matches!(setting.parameters.scheme, Scheme::Paper(_)) {
        grid.build(&state.positions, setting.kernel.radius);
    }
    let field = PressureField {
        grid: &grid,
        positions: &state.positions,
        pressures: &state.pressures,
        parameters: &setting.parameters,
        time: state.time,
        spacing: setting.spacing,
        walls: &walls,
    };
    let outline = Outline::new(setting, state, &walls, cells);
    let (extent, farthest) = outline.extent();
    let (front, wall_force) = match &setting.parameters.scheme {
        Scheme::Paper(_) => (particle_front(setting, state), fixed_wall_force(&field)),
        Scheme::Accurate(_) => (extent[1].x, outline.fixed_wall_force()),
    };
    let Sums { kinetic_energy, potential_energy, momentum, centre, angular_momentum } = sums(setting, state);
    Observables {
        probes: setting.geometry.probes.iter().map(|probe| read(setting, state, &field, probe)).collect(),
        region_masses: setting.geometry.regions.iter().map(|region| weigh(setting, state, region)).collect(),
        wall_force,
        front,
        kinetic_energy,
        potential_energy,
        momentum,
        centre,
        angular_momentum,
        levels: setting.geometry.gauges.iter().map(|&x| outline.level(x, extent[0].y)).collect(),
        area: outline.area(),
        extent,
        farthest,
        maximum_speed: state.velocities.iter().map(|velocity| velocity.norm()).fold(0.0, f64::max),
        particles: state.positions.len(),
        lost: state.lost,
    }
}

/// Sums over all particles, as in [`Observables`].
struct Sums {
    kinetic_energy: f64,
    potential_energy: f64,
    momentum: Vector2<f64>,
    centre: Vector2<f64>,
    angular_momentum: f64,
}

fn sums(setting: &Setting, state: &State) -> Sums {
    let parameters = &setting.parameters;
    let (places, velocities) = (&state.positions, &state.velocities);
    let all = 0..places.len();
    let mass = |i: usize| parameters.density * state.volumes[i];
    let total: f64 = parameters.density * state.volumes.iter().sum::<f64>();
    let moment: Vector2<f64> = all.clone().map(|i| places[i] * mass(i)).sum();
    let squared: f64 = all.clone().map(|i| places[i].norm_squared() * mass(i)).sum();
    Sums {
        kinetic_energy: 0.5 * all.clone().map(|i| velocities[i].norm_squared() * mass(i)).sum::<f64>(),
        potential_energy: 0.5 * parameters.attraction * squared - parameters.gravity.dot(&moment),
        momentum: all.clone().map(|i| velocities[i] * mass(i)).sum(),
        centre: if total > 0.0 { moment / total } else { moment },
        angular_momentum: all.map(|i| places[i].perp(&velocities[i]) * mass(i)).sum(),
    }
}

/// Where a place of the scene's pose is now.
fn stands(setting: &Setting, state: &State, place: &Vector2<f64>, on_body: bool) -> Vector2<f64> {
    match &setting.geometry.body {
        Some(body) if on_body => body.carry(place, &state.motion.position),
        _ => *place,
    }
}

/// Pressure at a probe \[Pa\].
fn read(setting: &Setting, state: &State, field: &PressureField, probe: &Probe) -> f64 {
    let place = stands(setting, state, &probe.place, probe.on_body);
    // A place on a wall is there only up to rounding, on the body up to its deflection.
    let front = field.walls.in_front(&place, ON_WALL * setting.spacing);
    let pressure = field.at_point(&front);
    // Where there is no water there is no slope either.
    if front == place || pressure == 0.0 {
        return pressure;
    }
    let slope = setting.parameters.body_force(&place, field.time) * setting.parameters.density;
    pressure + slope.dot(&(place - front))
}

/// Water in a region \[kg/m\].
fn weigh(setting: &Setting, state: &State, region: &Region) -> f64 {
    let polygon: Vec<_> = region.polygon.iter().map(|corner| stands(setting, state, corner, region.on_body)).collect();
    let inside = (0..state.positions.len()).filter(|&i| contains(&polygon, &state.positions[i]));
    // The sum of nothing is -0.
    0.0 + inside.map(|i| setting.parameters.density * state.volumes[i]).sum::<f64>()
}

/// Largest x of a particle that has company, and half a spacing \[m\].
fn particle_front(setting: &Setting, state: &State) -> f64 {
    let company = 0.3 * setting.kernel.reference_density;
    let has_company = |i: &usize| state.number_densities[*i] > company;
    let farthest = (0..state.positions.len()).filter(has_company).map(|i| state.positions[i].x);
    let front = farthest.fold(f64::NEG_INFINITY, f64::max);
    if front.is_finite() { front + 0.5 * setting.spacing } else { 0.0 }
}
