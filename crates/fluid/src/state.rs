//! Everything that must survive a step.

use kinematics::Motion;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// State of the fluid at one time. One entry per particle in each field.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time \[s\].
    pub time: f64,
    /// Internal steps taken so far.
    pub steps: u64,
    /// Last internal time step \[s\]; 0 before the first.
    pub time_step: f64,
    /// Motion of the body at this time.
    pub motion: Motion,
    /// Load on the generalised coordinates, mean over the last communication step \[N/m, N m/m, modal\].
    pub load: Vec<f64>,
    /// Mean acceleration of the coordinates over the last communication step, which the load belongs to.
    pub acceleration: Vec<f64>,
    /// Added mass of the coordinates, row after row, mean over the last communication step; zero for coordinates that
    /// do not answer to the load, and with the scheme `paper`.
    pub added_mass: Vec<f64>,
    /// Positions \[m\].
    pub positions: Vec<Vector2<f64>>,
    /// Velocities \[m/s\].
    pub velocities: Vec<Vector2<f64>>,
    /// Pressures \[Pa\].
    pub pressures: Vec<f64>,
    /// Areas that the particles own \[m2\].
    pub volumes: Vec<f64>,
    /// Number densities (dimensionless sums of weights).
    pub number_densities: Vec<f64>,
    /// Whether the particle lies on the free surface.
    pub surface: Vec<bool>,
    /// Particles that left the domain and were removed.
    pub lost: usize,
}

impl State {
    /// A number that tells states apart: a hash of time, motion and particles.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = Hash(0xcbf2_9ce4_8422_2325);
        hash.add(self.steps);
        hash.add(self.time.to_bits());
        hash.add(self.time_step.to_bits());
        for part in [&self.motion.position, &self.motion.velocity, &self.motion.acceleration] {
            part.iter().for_each(|value| hash.add(value.to_bits()));
        }
        for vector in self.positions.iter().chain(&self.velocities) {
            hash.add(vector.x.to_bits());
            hash.add(vector.y.to_bits());
        }
        self.pressures.iter().for_each(|value| hash.add(value.to_bits()));
        hash.0
    }
}

struct Hash(u64);

impl Hash {
    /// Multiply and rotate: fast, and every bit of the input reaches every bit of the result within a few words.
    fn add(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 29;
    }
}
