//! The generalised coordinates and their rates.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// Number of rigid coordinates: X, Y and theta.
pub const RIGID: usize = 3;

/// Largest number of modes that crosses the interface between the two components.
///
/// [`crate::BeamModes`] itself knows no limit.
pub const MAXIMUM_MODES: usize = 8;

/// Generalised coordinates `[X, Y, theta, q_1 .. q_N]` with their first and second time derivatives.
///
/// X, Y in m are the displacement of o_R from its place in the scene, theta in rad the counter-clockwise rotation from
/// the scene's pose, q in m sqrt(kg/m) (mass-normalised modes, per metre of width). A body at rest in its
/// scene has zeros throughout.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Coordinates, 3 + N.
    pub position: DVector<f64>,
    /// Rates, per second, 3 + N.
    pub velocity: DVector<f64>,
    /// Second derivatives, per second squared, 3 + N.
    pub acceleration: DVector<f64>,
}

impl Clone for Motion {
    fn clone(&self) -> Self {
        let Self { position, velocity, acceleration } = self;
        Self { position: position.clone(), velocity: velocity.clone(), acceleration: acceleration.clone() }
    }

    /// Keeps the memory: stepping clones motions all the time.
    fn clone_from(&mut self, source: &Self) {
        copy(&source.position, &mut self.position);
        copy(&source.velocity, &mut self.velocity);
        copy(&source.acceleration, &mut self.acceleration);
    }
}

/// Copies a vector into the memory of another of the same length.
pub fn copy(source: &DVector<f64>, target: &mut DVector<f64>) {
    if source.len() == target.len() {
        target.copy_from(source);
    } else {
        *target = source.clone();
    }
}

impl Motion {
    /// The pose of the scene, at rest, for a body with this number of modes.
    pub fn at_rest(modes: usize) -> Self {
        let zero = DVector::zeros(RIGID + modes);
        Self { position: zero.clone(), velocity: zero.clone(), acceleration: zero }
    }

    /// Number N of modes.
    pub fn modes(&self) -> usize {
        self.position.len() - RIGID
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        [&self.position, &self.velocity, &self.acceleration]
            .iter()
            .all(|part| part.iter().all(|value| value.is_finite()))
    }
}
