//! What changed the momentum of the water, by names.

use crate::parallel;
use crate::problem::Problem;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// Impulses that the water was given since the start, by what gave them \[N s/m\]. Together they are the change of its
/// momentum; those after `bodies` are the errors of the discretisation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Impulses {
    /// Gravity, attraction, shaking.
    pub forces: Vector2<f64>,
    /// Damping zones.
    pub damping: Vector2<f64>,
    /// Particles that left the domain, which take theirs with them.
    pub lost: Vector2<f64>,
    /// Pressure on fixed walls, and particles that they stopped; with the scheme `mps` in `projection`.
    pub walls: Vector2<f64>,
    /// Pressure on bodies, and particles that they stopped.
    pub bodies: Vector2<f64>,
    /// What the pressure gives beyond that: on facets that close a cell where no wall is, and to cells whose area is not that of
    /// their particle.
    pub projection: Vector2<f64>,
    /// Particles that collided, with each other or with walls, in the scheme `mps`.
    pub contacts: Vector2<f64>,
    /// Smoothing of the velocity.
    pub smoothing: Vector2<f64>,
    /// Velocities that follow particles that are shifted.
    pub shifting: Vector2<f64>,
}

impl Default for Impulses {
    fn default() -> Self {
        Self::from_terms([Vector2::zeros(); 9])
    }
}

impl Impulses {
    /// Names of the terms, and what they are.
    pub const NAMES: [(&'static str, &'static str); 9] = [
        ("forces", "gravity, attraction and shaking"),
        ("damping", "damping zones"),
        ("lost", "particles that left the domain"),
        ("walls", "fixed walls (scheme voronoi): pressure, and particles that they stopped"),
        ("bodies", "bodies: pressure, and particles that they stopped"),
        ("projection", "the pressure beyond that: closure facets, cells whose area is not their particle's"),
        ("contacts", "collisions (scheme mps)"),
        ("smoothing", "smoothing of the velocity"),
        ("shifting", "velocities that follow shifted particles"),
    ];

    /// The terms in the order of their names.
    pub fn terms(&self) -> [Vector2<f64>; 9] {
        let Self { forces, damping, lost, walls, bodies, projection, contacts, smoothing, shifting } = *self;
        [forces, damping, lost, walls, bodies, projection, contacts, smoothing, shifting]
    }

    fn from_terms(terms: [Vector2<f64>; 9]) -> Self {
        let [forces, damping, lost, walls, bodies, projection, contacts, smoothing, shifting] = terms;
        Self { forces, damping, lost, walls, bodies, projection, contacts, smoothing, shifting }
    }

    /// All together \[N s/m\].
    pub fn sum(&self) -> Vector2<f64> {
        self.terms().iter().sum()
    }
}

/// Momenta between the stages of a step \[N s/m\].
#[derive(Debug, Default)]
pub struct Momenta {
    last: Vector2<f64>,
    /// Scratch of sums.
    pub partial: Vec<[f64; 2]>,
}

impl Momenta {
    /// What happened to the momentum since the last call, which it starts from.
    pub fn since(&mut self, problem: &Problem, areas: &[f64], velocities: &[Vector2<f64>]) -> Vector2<f64> {
        let now = momentum(problem.parameters.density, areas, velocities, &mut self.partial);
        now - std::mem::replace(&mut self.last, now)
    }
}

/// Sum over the bodies of the forces among their loads \[N/m\].
pub fn force_of_load(problem: &Problem, load: &[f64]) -> Vector2<f64> {
    let layout = problem.geometry.bodies.layout();
    (0..layout.bodies()).map(|body| layout.rigid(body).start).map(|x| Vector2::new(load[x], load[x + 1])).sum()
}

/// Momentum of particles with these areas and velocities \[N s/m\]; `partial` is scratch.
pub fn momentum(density: f64, areas: &[f64], velocities: &[Vector2<f64>], partial: &mut Vec<[f64; 2]>) -> Vector2<f64> {
    let term = |i: usize| [areas[i] * velocities[i].x, areas[i] * velocities[i].y];
    let [x, y] = parallel::sums(velocities.len(), partial, term);
    Vector2::new(x, y) * density
}
