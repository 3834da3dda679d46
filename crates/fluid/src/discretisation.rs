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

/// A discretisation with all that one needs: water that falls and feels nothing else.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Geometry, Parameters, Solver};

    #[derive(Debug, Default)]
    struct Falling {
        places: Vec<Vector2<f64>>,
    }

    impl Discretisation for Falling {
        fn fresh(&self) -> Box<dyn Discretisation> {
            Box::new(Self::default())
        }

        fn as_any(&self) -> &dyn Any {
            self
        }

        fn stability(&self) -> Stability {
            Stability { courant: 1.0, ordinary_courant: 1.0, ease: 1.0 }
        }

        fn tolerance(&self) -> f64 {
            1e-6
        }

        fn reach(&self) -> f64 {
            1.0
        }

        fn full_density(&self) -> f64 {
            1.0
        }

        fn has_added_mass(&self) -> bool {
            false
        }

        fn areas(
            &self,
            positions: &mut [Vector2<f64>],
            _counts: &[usize],
            _water: &[Vec<Vector2<f64>>],
            spacing: f64,
        ) -> Vec<f64> {
            vec![spacing * spacing; positions.len()]
        }

        fn step(
            &mut self,
            problem: &Problem,
            state: &mut State,
            step: TimeStep,
            _end: &Motion,
            _report: &mut Report,
        ) -> Result<(), Error> {
            let (time_step, gravity) = (step.length, problem.parameters.gravity);
            self.places.clone_from(&state.positions);
            for (position, velocity) in state.positions.iter_mut().zip(&mut state.velocities) {
                *position += (*velocity + 0.5 * time_step * gravity) * time_step;
                *velocity += gravity * time_step;
            }
            Ok(())
        }

        fn places(&self) -> &[Vector2<f64>] {
            &self.places
        }

        fn find_load(
            &mut self,
            _problem: &Problem,
            _state: &mut State,
            _step: TimeStep,
            _end: &Motion,
            _report: &mut Report,
        ) -> Result<(), Error> {
            Ok(())
        }

        fn observe(&mut self, _problem: &Problem, _state: &State) -> Observables {
            Observables::default()
        }
    }

    #[test]
    fn another_discretisation_needs_nothing_else() {
        let corners = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.0, 0.1)];
        let water = vec![corners.map(|(x, y)| Vector2::new(x, y)).to_vec()];
        let geometry = Geometry { water, ..Geometry::default() };
        let mut solver = Solver::new(Parameters { threads: 1, ..Parameters::default() }, geometry).unwrap();
        solver.discretisation = Box::new(Falling::default());
        let (mut state, end) = (solver.initial_state(), solver.at_rest());
        let start = state.positions.clone();
        solver.step(&mut state, &end, 0.05, &mut solver.workspace()).unwrap();
        // g t^2 / 2 and g t.
        let fall = Vector2::new(0.0, -0.5 * 9.81 * 0.05 * 0.05);
        for (position, start) in state.positions.iter().zip(&start) {
            assert!((position - start - fall).norm() < 1e-14, "{position:?}");
        }
        assert!(state.velocities.iter().all(|velocity| (velocity.y + 9.81 * 0.05).abs() < 1e-14));
    }
}
