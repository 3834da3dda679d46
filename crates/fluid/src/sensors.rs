//! Pressure sensors: patches of finite size whose readings are means over time.
//!
//! The pressure at a point at an instant is a sample of a peak that may be as short as the step; what a sensor measures, and
//! what loads a structure, is force over area and impulse over time.

use crate::parameters::Probe;
use crate::pressure_field::PressureField;
use crate::problem::Problem;
use nalgebra::{DVector, Vector2};
use serde::{Deserialize, Serialize};

/// Distance in spacings within which a probe stands on a wall.
pub const ON_WALL: f64 = 0.25;

/// What a sensor has read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// Mean pressure over the last communication step \[Pa\].
    pub mean: f64,
    /// Largest pressure of an internal step in it \[Pa\].
    pub largest: f64,
    /// Impulse of the pressure beyond the threshold since the start \[Pa s\].
    pub impulse: f64,
}

impl Sensor {
    /// The same at the start of a communication step.
    pub fn begin(&mut self) {
        (self.mean, self.largest) = (0.0, f64::NEG_INFINITY);
    }

    /// Takes the reading of an internal step, which is a `share` of the communication step and lasts `duration` \[s\].
    pub fn add(&mut self, reading: f64, share: f64, duration: f64, threshold: f64) {
        self.mean += reading * share;
        self.largest = self.largest.max(reading);
        self.impulse += (reading - threshold).max(0.0) * duration;
    }

    /// Takes a reading for the mean and the largest.
    pub fn set(&mut self, reading: f64) {
        (self.mean, self.largest) = (reading, reading);
    }
}

/// Where a place of the scene's pose is with the bodies at `coordinates`.
pub fn stands(
    problem: &Problem,
    place: &Vector2<f64>,
    on_body: Option<usize>,
    coordinates: &DVector<f64>,
) -> Vector2<f64> {
    on_body.map_or(*place, |body| problem.geometry.bodies.carry(body, place, coordinates))
}

/// Pressure around a probe from the particles near it \[Pa\], with the bodies at `coordinates`.
pub fn read_in_water(problem: &Problem, field: &PressureField, probe: &Probe, coordinates: &DVector<f64>) -> f64 {
    let place = stands(problem, &probe.place, probe.on_body, coordinates);
    // A place on a wall is there only up to rounding, on the body up to its deflection.
    let front = field.walls.in_front(&place, ON_WALL * problem.spacing);
    let pressure = field.at_point(&front);
    // Where there is no water there is no slope either.
    if front == place || pressure == 0.0 {
        return pressure;
    }
    let slope = problem.parameters.body_force(&place, field.time) * problem.parameters.density;
    pressure + slope.dot(&(place - front))
}
