//! Newton-Raphson on the exact tangent for the end of a step.

use crate::{Error, Report, Solver, State, Workspace};
use nalgebra::{DMatrix, DVector};

impl Solver {
    /// Solves the step that [`Solver`] describes; leaves the result in `workspace.end`.
    pub(crate) fn iterate(
        &self,
        state: &State,
        start: &DVector<f64>,
        load: &DVector<f64>,
        duration: f64,
        workspace: &mut Workspace,
    ) -> Result<Report, Error> {
        let (tolerance, maximum) = (self.parameters().tolerance, self.parameters().maximum_iterations);
        self.scheme.predict(&state.motion, start, duration, &mut workspace.end);
        self.measure_start(state, start, load, workspace);
        let mut iterations = 0;
        loop {
            self.scheme.point(&state.motion, start, &workspace.end, &mut workspace.point);
            let residual = self.residual(load, workspace);
            if residual <= tolerance {
                return Ok(Report { unknowns: self.free.count(), iterations, residual });
            }
            if iterations == maximum || !residual.is_finite() {
                return Err(Error::NotConverged { time: state.time, duration, iterations, residual, tolerance });
            }
            self.correct(duration, state.time, workspace)?;
            iterations += 1;
        }
    }

    /// Sizes of the load and of the forces at the start of the step, whose mass matrix the workspace already holds.
    fn measure_start(&self, state: &State, start: &DVector<f64>, load: &DVector<f64>, workspace: &mut Workspace) {
        workspace.point.clone_from(&state.motion);
        workspace.point.acceleration.copy_from(start);
        let sizes = &mut workspace.sizes[0];
        sizes.zip_apply(load, |entry, value| *entry = value.abs());
        self.dynamics().add_force_sizes(&workspace.point, &workspace.mass, sizes);
    }

    /// Residual force at `workspace.point` into the workspace; returns its relative size.
    fn residual(&self, load: &DVector<f64>, workspace: &mut Workspace) -> f64 {
        let Workspace { mass, restoring, residual, sizes: [start_sizes, sizes], point, end, .. } = workspace;
        self.dynamics().mass_matrix(&point.position, mass);
        self.dynamics().restoring_force(&point.position, &point.velocity, restoring);
        residual.copy_from(restoring);
        *residual -= load;
        residual.gemv(1.0, mass, &point.acceleration, 1.0);
        let size = self.free.force_norm(residual, mass);
        if size == 0.0 {
            return 0.0;
        }
        sizes.copy_from(start_sizes);
        self.dynamics().add_force_sizes(end, mass, sizes);
        size / self.free.force_norm(sizes, mass)
    }

    /// One Newton correction of `workspace.end`.
    ///
    /// Position and velocity are corrected themselves, not computed anew from the acceleration: in a step that is long
    /// against a period the predictor is far larger than the result and would leave its rounding in it.
    fn correct(&self, duration: f64, time: f64, workspace: &mut Workspace) -> Result<(), Error> {
        let mut reduced = self.free.gather(&workspace.residual);
        if !self.tangent(duration, workspace).lu().solve_mut(&mut reduced) {
            return Err(Error::Singular { matrix: "tangent", size: self.free.count(), time });
        }
        let Workspace { residual: correction, end, .. } = workspace;
        self.free.scatter(&reduced, correction);
        end.position.axpy(-self.scheme.beta * duration * duration, correction, 1.0);
        end.velocity.axpy(-self.scheme.gamma * duration, correction, 1.0);
        end.acceleration -= &*correction;
        Ok(())
    }

    /// dr/da1 of the free coordinates at `workspace.point`, whose mass matrix the workspace already holds.
    pub(crate) fn tangent(&self, duration: f64, workspace: &mut Workspace) -> DMatrix<f64> {
        let Workspace { mass, stiffness, velocity_tangent, point, .. } = workspace;
        self.dynamics().stiffness(&point.position, &point.velocity, &point.acceleration, stiffness);
        self.dynamics().velocity_tangent(&point.position, &point.velocity, velocity_tangent);
        let scheme = &self.scheme;
        let by_velocity = (1.0 - scheme.alpha_f) * scheme.gamma * duration;
        let by_position = (1.0 - scheme.alpha_f) * scheme.beta * duration * duration;
        self.free.gather_with(|row, column| {
            let at = (row, column);
            (1.0 - scheme.alpha_m) * mass[at] + by_velocity * velocity_tangent[at] + by_position * stiffness[at]
        })
    }
}
