//! The generalised coordinates and their rates.

use crate::layout::RIGID;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Generalised coordinates of one body or of several with their first and second time derivatives: which entry is what is
/// the matter of [`crate::CoordinateLayout`].
///
/// X, Y in m are the displacement of o_R from its place in the scene, theta in rad the counter-clockwise rotation from
/// the scene's pose, q in m sqrt(kg/m) (mass-normalised modes, per metre of width). Bodies at rest in
/// their scene have zeros throughout.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Coordinates.
    pub position: DVector<f64>,
    /// Rates, per second.
    pub velocity: DVector<f64>,
    /// Second derivatives, per second squared.
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
    /// The pose of the scene, at rest, for one body with this number of modes.
    pub fn at_rest(modes: usize) -> Self {
        Self::zeros(RIGID + modes)
    }

    /// The pose of the scene, at rest, for this number of coordinates.
    pub fn zeros(size: usize) -> Self {
        let zero = DVector::zeros(size);
        Self { position: zero.clone(), velocity: zero.clone(), acceleration: zero }
    }

    /// Number of coordinates.
    pub fn size(&self) -> usize {
        self.position.len()
    }

    /// Some of the coordinates.
    pub fn view(&self, range: Range<usize>) -> MotionView<'_> {
        MotionView {
            position: &self.position.as_slice()[range.clone()],
            velocity: &self.velocity.as_slice()[range.clone()],
            acceleration: &self.acceleration.as_slice()[range],
        }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        [&self.position, &self.velocity, &self.acceleration]
            .iter()
            .all(|part| part.iter().all(|value| value.is_finite()))
    }
}

/// Some of the coordinates of a motion: those of one body.
#[derive(Debug, Clone, Copy)]
pub struct MotionView<'a> {
    /// Coordinates.
    pub position: &'a [f64],
    /// Rates, per second.
    pub velocity: &'a [f64],
    /// Second derivatives, per second squared.
    pub acceleration: &'a [f64],
}

impl<'a> From<&'a Motion> for MotionView<'a> {
    fn from(motion: &'a Motion) -> Self {
        motion.view(0..motion.size())
    }
}
