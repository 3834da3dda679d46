//! Everything that must survive a step.

use crate::balance::Gains;
use crate::gas::Gas;
use crate::parallel::CHUNK;
use crate::sensors::Sensor;
use kinematics::Motion;
use nalgebra::Vector2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// State of the fluid at one time. One entry per particle in each field.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
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
    /// Force on the fixed walls, mean over the last communication step \[N/m\]; zero with the scheme `mps`.
    pub wall_force: Vector2<f64>,
    /// Mean acceleration of the coordinates over the last communication step, which the load belongs to.
    pub acceleration: Vec<f64>,
    /// Added mass of the coordinates, row after row, mean over the last communication step; zero for coordinates that
    /// do not answer to the load, and with the scheme `mps`.
    pub added_mass: Vec<f64>,
    /// Positions \[m\].
    pub positions: Vec<Vector2<f64>>,
    /// Velocities \[m/s\].
    pub velocities: Vec<Vector2<f64>>,
    /// Pressures \[Pa\].
    pub pressures: Vec<f64>,
    /// Areas that the particles own \[m2\].
    pub areas: Vec<f64>,
    /// What the last step left of the rates of cells' areas; zero with the scheme `mps`.
    pub area_rates: Vec<AreaRate>,
    /// Number densities (dimensionless sums of weights).
    pub number_densities: Vec<f64>,
    /// Whether the particle lies on the free surface.
    pub surface: Vec<bool>,
    /// Particles that left the domain and were removed.
    pub lost: usize,
    /// Cells so far that changed faster than a step can follow; none with the scheme `mps`.
    pub jumps: u64,
    /// What the pressure probes read.
    pub sensors: Vec<Sensor>,
    /// What changed momentum, angular momentum and energy so far.
    pub gains: Gains,
    /// Gas in pockets; none where the parameters have none.
    pub gas: Gas,
}

/// What a step leaves of the rate of a cell's area, which the next one goes on from \[m2/s\].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct AreaRate {
    /// Rate with the velocities at the end of the step, in the middle of it.
    pub left: f64,
    /// Rate that the step asked for.
    pub asked: f64,
    /// Part of the difference that is still to be worked off.
    pub due: f64,
}

impl Clone for State {
    fn clone(&self) -> Self {
        let mut state = Self {
            time: 0.0,
            steps: 0,
            time_step: 0.0,
            motion: Motion::zeros(self.motion.size()),
            load: Vec::new(),
            wall_force: Vector2::zeros(),
            acceleration: Vec::new(),
            added_mass: Vec::new(),
            positions: Vec::new(),
            velocities: Vec::new(),
            pressures: Vec::new(),
            areas: Vec::new(),
            area_rates: Vec::new(),
            number_densities: Vec::new(),
            surface: Vec::new(),
            lost: 0,
            jumps: 0,
            sensors: Vec::new(),
            gains: Gains::default(),
            gas: Gas::default(),
        };
        state.clone_from(self);
        state
    }

    /// Keeps the memory: every step begins with a copy.
    fn clone_from(&mut self, source: &Self) {
        (self.time, self.steps, self.time_step) = (source.time, source.steps, source.time_step);
        (self.lost, self.jumps, self.gains) = (source.lost, source.jumps, source.gains);
        self.wall_force = source.wall_force;
        self.sensors.clone_from(&source.sensors);
        self.motion.clone_from(&source.motion);
        self.load.clone_from(&source.load);
        self.acceleration.clone_from(&source.acceleration);
        self.added_mass.clone_from(&source.added_mass);
        self.positions.clone_from(&source.positions);
        self.velocities.clone_from(&source.velocities);
        self.pressures.clone_from(&source.pressures);
        self.areas.clone_from(&source.areas);
        self.area_rates.clone_from(&source.area_rates);
        self.number_densities.clone_from(&source.number_densities);
        self.surface.clone_from(&source.surface);
        self.gas.clone_from(&source.gas);
    }
}

impl State {
    /// A number that tells states apart: a hash of time, motion and particles. `partial` is scratch.
    pub fn fingerprint(&self, partial: &mut Vec<u64>) -> u64 {
        let mut hash = Hash(SEED);
        hash.add(self.steps);
        hash.add(self.time.to_bits());
        hash.add(self.time_step.to_bits());
        for part in [&self.motion.position, &self.motion.velocity, &self.motion.acceleration] {
            part.iter().for_each(|value| hash.add(value.to_bits()));
        }
        for pocket in &self.gas.pockets {
            [pocket.volume, pocket.rate, pocket.pressure].iter().for_each(|value| hash.add(value.to_bits()));
        }
        partial.resize(self.positions.len().div_ceil(CHUNK), 0);
        let places = (self.positions.par_chunks(CHUNK), self.velocities.par_chunks(CHUNK));
        let numbers = (self.pressures.par_chunks(CHUNK), self.area_rates.par_chunks(CHUNK));
        (places.0, places.1, numbers.0, numbers.1, &mut *partial).into_par_iter().for_each(
            |(positions, velocities, pressures, rates, hash)| {
                let mut part = Hash(SEED);
                for vector in positions.iter().chain(velocities) {
                    part.add(vector.x.to_bits());
                    part.add(vector.y.to_bits());
                }
                pressures.iter().for_each(|value| part.add(value.to_bits()));
                let rates = rates.iter().flat_map(|rate| [rate.left, rate.asked, rate.due]);
                rates.for_each(|value| part.add(value.to_bits()));
                *hash = part.0;
            },
        );
        partial.iter().for_each(|&part| hash.add(part));
        hash.0
    }
}

/// What a hash begins with.
const SEED: u64 = 0xcbf2_9ce4_8422_2325;

struct Hash(u64);

impl Hash {
    /// Multiply and rotate: fast, and every bit of the input reaches every bit of the result within a few words.
    fn add(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 29;
    }
}
