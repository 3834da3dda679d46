//! How the end of a step answers to the load held over it.

use crate::{Error, Sensitivity, Solver, State, Workspace};
use nalgebra::{DMatrix, DVector};

/// The sensitivities of the free coordinates.
struct Reduced {
    position: DMatrix<f64>,
    velocity: DMatrix<f64>,
    acceleration: DMatrix<f64>,
}

impl Solver {
    /// Derivatives by the load of the motion at the end of the step that led from `before` to `after` in `duration` s
    /// under `load`.
    ///
    /// The implicit function theorem on the equations of the step (see [`Solver`]), with everything that depends on the
    /// load in it: the start acceleration a0 where it is taken from equilibrium, the predictors, and the acceleration
    /// that goes out.
    ///
    /// # Errors
    /// As [`Solver::step`], for the same inputs.
    pub fn sensitivity(
        &self,
        before: &State,
        after: &State,
        load: &[f64],
        duration: f64,
    ) -> Result<Sensitivity, Error> {
        self.check(before, load, duration)?;
        self.check(after, load, duration)?;
        let full = if self.free.count() == 0 {
            let nothing = DMatrix::zeros(0, 0);
            Reduced { position: nothing.clone(), velocity: nothing.clone(), acceleration: nothing }
        } else {
            self.reduced_sensitivity(before, after, &DVector::from_column_slice(load), duration)?
        };
        Ok(Sensitivity {
            position: self.free.scatter_matrix(&full.position),
            velocity: self.free.scatter_matrix(&full.velocity),
            acceleration: self.free.scatter_matrix(&full.acceleration),
        })
    }

    fn reduced_sensitivity(
        &self,
        before: &State,
        after: &State,
        load: &DVector<f64>,
        duration: f64,
    ) -> Result<Reduced, Error> {
        let (scheme, workspace) = (&self.scheme, &mut self.workspace());
        let size = self.free.count();
        let singular = |matrix| Error::Singular { matrix, size, time: before.time };
        let mass = self.mass_at(&before.motion.position, before.time, workspace)?;
        let start = self.start_acceleration(before, load, &mass, workspace);
        let remembered = scheme.remembers && before.algorithmic_acceleration.is_some();
        let by_start = if remembered { DMatrix::zeros(size, size) } else { mass.inverse() };

        let memory = after.algorithmic_acceleration.as_ref().unwrap_or(&after.motion.acceleration);
        workspace.end.clone_from(&after.motion);
        workspace.end.acceleration.copy_from(memory);
        scheme.point(&before.motion, &start, &workspace.end, &mut workspace.point);
        self.dynamics().mass_matrix(&workspace.point.position, &mut workspace.mass);
        let tangent = self.tangent(duration, workspace);

        // Predictors: x1 = px + beta H^2 a1 and v1 = pv + gamma H a1.
        let square = duration * duration;
        let predicted_position = (0.5 - scheme.beta) * square * &by_start;
        let predicted_velocity = (1.0 - scheme.gamma) * duration * &by_start;
        let by_motion = self.free.gather_matrix(&workspace.stiffness) * &predicted_position
            + self.free.gather_matrix(&workspace.velocity_tangent) * &predicted_velocity;
        let inertial = scheme.alpha_m * self.free.gather_matrix(&workspace.mass) * &by_start;
        let right = DMatrix::identity(size, size) - (1.0 - scheme.alpha_f) * by_motion - inertial;
        let by_end = tangent.lu().solve(&right).ok_or_else(|| singular("tangent"))?;

        let position = predicted_position + scheme.beta * square * &by_end;
        let velocity = predicted_velocity + scheme.gamma * duration * &by_end;
        let acceleration =
            if scheme.remembers { self.end_sensitivity(after, &position, &velocity, workspace)? } else { by_end };
        Ok(Reduced { position, velocity, acceleration })
    }

    /// Derivative of the equilibrium acceleration at the end: M da = I - d(M a + f)/dx dx - df/dv dv.
    fn end_sensitivity(
        &self,
        after: &State,
        by_position: &DMatrix<f64>,
        by_velocity: &DMatrix<f64>,
        workspace: &mut Workspace,
    ) -> Result<DMatrix<f64>, Error> {
        let motion = &after.motion;
        let dynamics = self.dynamics();
        dynamics.stiffness(&motion.position, &motion.velocity, &motion.acceleration, &mut workspace.stiffness);
        dynamics.velocity_tangent(&motion.position, &motion.velocity, &mut workspace.velocity_tangent);
        let mass = self.mass_at(&motion.position, after.time, workspace)?;
        let size = self.free.count();
        let right = DMatrix::identity(size, size)
            - self.free.gather_matrix(&workspace.stiffness) * by_position
            - self.free.gather_matrix(&workspace.velocity_tangent) * by_velocity;
        Ok(mass.solve(&right))
    }
}
