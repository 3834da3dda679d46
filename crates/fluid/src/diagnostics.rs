//! Quantities that people look at, from a state.

use crate::parameters::Region;
use crate::problem::Problem;
use crate::sensors::stands;
use crate::setup::fill::contains;
use crate::state::State;
use crate::voronoi::outline::Outline;
use nalgebra::Vector2;

/// Quantities of one state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Observables {
    /// Pressures at the probes, means over the last communication step \[Pa\].
    pub probes: Vec<f64>,
    /// Water in each region \[kg/m\].
    pub region_masses: Vec<f64>,
    /// Force of the water on the fixed walls \[N/m\], mean over the last communication step with the scheme `voronoi`.
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

/// Computes the quantities of `state`, those of its outline from that: the front is its farthest point.
pub fn observe(problem: &Problem, state: &State, outline: &Outline) -> Observables {
    let (extent, farthest) = outline.extent();
    let Sums { kinetic_energy, potential_energy, momentum, centre, angular_momentum } = sums(problem, state);
    Observables {
        probes: state.sensors.iter().map(|sensor| sensor.mean).collect(),
        region_masses: problem.geometry.regions.iter().map(|region| weigh(problem, state, region)).collect(),
        wall_force: state.wall_force,
        front: extent[1].x,
        kinetic_energy,
        potential_energy,
        momentum,
        centre,
        angular_momentum,
        levels: problem.geometry.gauges.iter().map(|&x| outline.level(x, extent[0].y)).collect(),
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

fn sums(problem: &Problem, state: &State) -> Sums {
    let parameters = &problem.parameters;
    let (places, velocities) = (&state.positions, &state.velocities);
    let all = 0..places.len();
    let mass = |i: usize| parameters.density * state.areas[i];
    let total: f64 = parameters.density * state.areas.iter().sum::<f64>();
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

/// Water in a region \[kg/m\].
fn weigh(problem: &Problem, state: &State, region: &Region) -> f64 {
    let polygon: Vec<_> =
        region.polygon.iter().map(|corner| stands(problem, corner, region.on_body, &state.motion.position)).collect();
    let inside = (0..state.positions.len()).filter(|&i| contains(&polygon, &state.positions[i]));
    // The sum of nothing is -0.
    0.0 + inside.map(|i| problem.parameters.density * state.areas[i]).sum::<f64>()
}
