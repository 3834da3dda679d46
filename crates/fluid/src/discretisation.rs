//! What a discretisation of the water must do; everything else is common to all.

use crate::Error;
use crate::diagnostics::Observables;
use crate::problem::Problem;
use crate::report::Report;
use crate::state::State;
use crate::time_step::{Stability, TimeStep};
use kinematics::Motion;
use nalgebra::{DVector, Vector2};
use std::any::Any;

/// A discretisation of the water, with the scratch of its steps. It holds nothing that a step depends on: one that
/// was made anew gives the same bits.
pub trait Discretisation: std::fmt::Debug + Send + Sync {
    /// The same without scratch.
    fn fresh(&self) -> Box<dyn Discretisation>;

    /// For those who time the stages of one of them.
    fn as_any(&self) -> &dyn Any;

    /// Limits of its internal steps.
    fn stability(&self) -> Stability;

    /// Residual of the pressure that is small beside its other errors, over the right side.
    fn tolerance(&self) -> f64;

    /// Distance at which a particle may feel a wall, over the spacing.
    fn reach(&self) -> f64;

    /// Number density of a particle all around which there is water.
    fn full_density(&self) -> f64;

    /// Whether it says how the load answers to accelerations of the body.
    fn has_added_mass(&self) -> bool;

    /// Areas of the particles of `water` \[m2\], of which there are `counts` in each polygon; it may move them.
    fn areas(
        &self,
        positions: &mut [Vector2<f64>],
        counts: &[usize],
        water: &[Vec<Vector2<f64>>],
        spacing: f64,
    ) -> Vec<f64>;

    /// One internal step with the body's motion `end` at its end: moves the particles, finds their pressure, and adds the
    /// step's share of load and added mass. What does not depend on `end` is kept for a repeat from the same state.
    ///
    /// # Errors
    /// A pressure that was not found.
    fn step(
        &mut self,
        problem: &Problem,
        state: &mut State,
        step: TimeStep,
        end: &Motion,
        report: &mut Report,
    ) -> Result<(), Error>;

    /// Where the particles of the last step were before its pressure moved them \[m\].
    fn places(&self) -> &[Vector2<f64>];

    /// Pressure, load and added mass of a state at which nothing was stepped yet, as far as the discretisation knows them
    /// without a step that ends with the motion `end`.
    ///
    /// # Errors
    /// A pressure that was not found.
    fn find_load(
        &mut self,
        problem: &Problem,
        state: &mut State,
        step: TimeStep,
        end: &Motion,
        report: &mut Report,
    ) -> Result<(), Error>;

    /// Quantities of a state; what is found for them serves the next step.
    fn observe(&mut self, problem: &Problem, state: &State) -> Observables;
}

/// Mean accelerations of the coordinates from `start` to `end`.
pub fn mean_acceleration(end: &Motion, start: &Motion, duration: f64, out: &mut DVector<f64>) {
    kinematics::copy(&end.velocity, out);
    *out -= &start.velocity;
    *out /= duration;
}
