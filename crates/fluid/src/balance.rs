//! What changed the momentum, the angular momentum and the energy of the water, by names.

use crate::parallel;
use crate::problem::Problem;
use crate::state::State;
use kinematics::BodySet;
use nalgebra::{DVector, Vector2};
use serde::{Deserialize, Serialize};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// What the water was given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// Momentum \[N s/m\].
    pub impulse: Vector2<f64>,
    /// Angular momentum about the origin of the scene, counter-clockwise \[N m s/m\].
    pub angular: f64,
    /// Kinetic energy and potential energy in gravity and attraction \[J/m\].
    pub energy: f64,
}

impl Gain {
    /// From momentum along X and Y, angular momentum and energy per density.
    pub fn from_sums(density: f64, [x, y, angular, energy]: [f64; 4]) -> Self {
        Self { impulse: Vector2::new(x, y), angular, energy } * density
    }

    /// What the water has.
    pub fn of_water(problem: &Problem, state: &State, partial: &mut Vec<[f64; 4]>) -> Self {
        let parameters = &problem.parameters;
        let term = |i: usize| {
            let (place, velocity) = (&state.positions[i], &state.velocities[i]);
            let energy = 0.5 * velocity.norm_squared() + parameters.potential(place);
            [velocity.x, velocity.y, place.perp(velocity), energy].map(|value| value * state.areas[i])
        };
        Self::from_sums(parameters.density, parallel::sums(state.positions.len(), partial, term))
    }

    /// What a generalised impulse on bodies that stand at `coordinates` and move with these mean `rates` gives them.
    pub fn of_bodies(
        bodies: &BodySet,
        impulse: &[f64],
        coordinates: &DVector<f64>,
        rates: impl Iterator<Item = f64>,
    ) -> Self {
        let layout = bodies.layout();
        let of_body = |(index, body): (usize, &kinematics::Body)| {
            let x = layout.rigid(index).start;
            let force = Vector2::new(impulse[x], impulse[x + 1]);
            let place = body.origin + Vector2::new(coordinates[x], coordinates[x + 1]);
            Self { impulse: force, angular: impulse[x + 2] + place.perp(&force), energy: 0.0 }
        };
        let sum: Self = bodies.bodies().iter().enumerate().map(of_body).sum();
        Self { energy: impulse.iter().zip(rates).map(|(impulse, rate)| impulse * rate).sum(), ..sum }
    }

    /// Its numbers.
    pub fn numbers(&self) -> [f64; 4] {
        [self.impulse.x, self.impulse.y, self.angular, self.energy]
    }
}

impl Add for Gain {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            impulse: self.impulse + other.impulse,
            angular: self.angular + other.angular,
            energy: self.energy + other.energy,
        }
    }
}

impl Mul<f64> for Gain {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { impulse: self.impulse * factor, angular: self.angular * factor, energy: self.energy * factor }
    }
}

impl Neg for Gain {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for Gain {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl AddAssign for Gain {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for Gain {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::default(), Add::add)
    }
}

/// What the water was given since the start, by what gave it: together the change of its momentum, angular momentum and
/// energy.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// Gravity, attraction, shaking. Energy: of shaking, and of attraction what the step leaves.
    pub forces: Gain,
    /// Damping zones.
    pub damping: Gain,
    /// Particles that left the domain, which take theirs with them.
    pub lost: Gain,
    /// Fixed walls: pressure, and particles that they stopped. Energy: of all that was stopped, and kept in front. With the
    /// scheme `mps` in `projection`.
    pub walls: Gain,
    /// Bodies: pressure, and particles that they stopped. Energy: the work of the load.
    pub bodies: Gain,
    /// What the pressure gives beyond that. Energy: what is lost where water meets water or a wall at once, and the errors of
    /// space and time.
    pub projection: Gain,
    /// Particles that collided, with each other or with walls, in the scheme `mps`.
    pub contacts: Gain,
    /// Smoothing of the velocity.
    pub smoothing: Gain,
    /// Particles that are shifted, and their velocities that follow.
    pub shifting: Gain,
    /// Gas in pockets that pushes on the surface. Energy: its work there.
    pub gas: Gain,
}

impl Gains {
    /// Names of the terms, and what they are.
    pub const NAMES: [(&'static str, &'static str); 10] = [
        ("forces", "gravity, attraction and shaking"),
        ("damping", "damping zones"),
        ("lost", "particles that left the domain"),
        ("walls", "fixed walls (scheme voronoi): pressure, and particles that they stopped"),
        ("bodies", "bodies: pressure, and particles that they stopped"),
        ("projection", "the pressure beyond that: losses of impacts, errors of the discretisation"),
        ("contacts", "collisions (scheme mps)"),
        ("smoothing", "smoothing of the velocity"),
        ("shifting", "shifted particles, whose velocities follow"),
        ("gas", "gas in pockets (scheme voronoi): its pressure on the surface"),
    ];

    /// The terms in the order of their names.
    pub fn terms(&self) -> [Gain; 10] {
        let Self { forces, damping, lost, walls, bodies, projection, contacts, smoothing, shifting, gas } = *self;
        [forces, damping, lost, walls, bodies, projection, contacts, smoothing, shifting, gas]
    }

    /// All together.
    pub fn sum(&self) -> Gain {
        self.terms().into_iter().sum()
    }
}

/// What the water has between the stages of a step.
#[derive(Debug, Default)]
pub struct Tally {
    last: Gain,
    partial: Vec<[f64; 4]>,
}

impl Tally {
    /// What it got since the last call, which it starts from.
    pub fn since(&mut self, problem: &Problem, state: &State) -> Gain {
        let now = Gain::of_water(problem, state, &mut self.partial);
        now - std::mem::replace(&mut self.last, now)
    }
}
