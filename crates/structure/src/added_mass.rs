//! A load that answers to the acceleration at once, for exchanges without iteration.
//!
//! The pressure of an incompressible fluid is affine in the acceleration of its walls: within a step the load is
//! Q(a) = Q_r - A (a - a_r), with A the added mass and Q_r the load that belongs to the acceleration a_r. A structure
//! that takes Q_r as it is diverges once A exceeds its own mass, however small the step. Here A is part of its
//! equations (Banks, Henshaw and Schwendeman 2014), with a the mean acceleration (v1 - v0)/H of the step:
//!
//!   F(Q) = Q - Q_r - A (a_r - a(Q)) = 0,      dF/dQ = I + A (dv1/dQ)/H,
//!
//! solved by Newton-Raphson around [`Solver::step`], whose derivative is exact: a linear structure takes one
//! correction.

use crate::{Error, Report, Sensitivity, Solver, State, Workspace};
use nalgebra::{DMatrix, DVector};

/// What the fluid answers to accelerations. Sizes 3 + N.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "Numbers", into = "Numbers")]
pub struct AddedMass {
    /// A; symmetric, positive semi-definite.
    pub matrix: DMatrix<f64>,
    /// a_r, the mean acceleration that the load belongs to.
    pub acceleration: DVector<f64>,
}

/// The form in saved states. A matrix that is read as such brings numbers of rows and columns whose product may wrap
/// around to the number of entries; here the accelerations say how large it is.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
struct Numbers {
    /// Column after column.
    matrix: Vec<f64>,
    acceleration: Vec<f64>,
}

impl From<AddedMass> for Numbers {
    fn from(added: AddedMass) -> Self {
        Self { matrix: added.matrix.as_slice().to_vec(), acceleration: added.acceleration.as_slice().to_vec() }
    }
}

impl TryFrom<Numbers> for AddedMass {
    type Error = String;

    fn try_from(numbers: Numbers) -> Result<Self, String> {
        let (size, entries) = (numbers.acceleration.len(), numbers.matrix.len());
        if size.checked_mul(size) != Some(entries) {
            return Err(format!("an added mass of {entries} entries for {size} coordinates"));
        }
        Ok(Self {
            matrix: DMatrix::from_vec(size, size, numbers.matrix),
            acceleration: DVector::from_vec(numbers.acceleration),
        })
    }
}

impl Solver {
    /// Like [`Solver::step`], under the load `load - A (a - a_r)` with a the mean acceleration of the step. Also
    /// returns the load that acted.
    ///
    /// # Errors
    /// Those of [`Solver::step`], and an iteration that does not converge.
    pub fn step_with_added_mass(
        &self,
        state: &mut State,
        load: &[f64],
        added: &AddedMass,
        duration: f64,
        workspace: &mut Workspace,
    ) -> Result<(Report, Vec<f64>), Error> {
        self.check(state, load, duration)?;
        self.check(state, added.acceleration.as_slice(), duration)?;
        let given = DVector::from_column_slice(load);
        let expected = &given + &added.matrix * &added.acceleration;
        let mut acting = given.clone();
        let (tolerance, maximum) = (self.parameters().tolerance, self.parameters().maximum_iterations);
        let mut iterations = 0;
        loop {
            let mut end = state.clone();
            let report = self.step(&mut end, acting.as_slice(), duration, workspace)?;
            let mean = (&end.motion.velocity - &state.motion.velocity) / duration;
            let answer = &added.matrix * &mean;
            let residual = &acting - &expected + &answer;
            let size = self.force_size(&given, workspace) + self.force_size(&answer, workspace);
            let relative = self.force_size(&residual, workspace) / size.max(f64::MIN_POSITIVE);
            if relative <= tolerance.max(1e-10) {
                *state = end;
                return Ok((
                    Report { iterations: report.iterations + iterations, ..report },
                    acting.as_slice().to_vec(),
                ));
            }
            if iterations == maximum || !relative.is_finite() {
                let time = state.time;
                return Err(Error::NotConverged { time, duration, iterations, residual: relative, tolerance });
            }
            let sensitivity = self.sensitivity(state, &end, acting.as_slice(), duration)?;
            acting -= self.resolve(&sensitivity.velocity, added, duration, state.time, residual)?;
            iterations += 1;
        }
    }

    /// (I + A S/H)^-1 r.
    fn resolve(
        &self,
        by_load: &DMatrix<f64>,
        added: &AddedMass,
        duration: f64,
        time: f64,
        right: DVector<f64>,
    ) -> Result<DVector<f64>, Error> {
        let size = right.len();
        let matrix = DMatrix::identity(size, size) + &added.matrix * by_load / duration;
        matrix.lu().solve(&right).ok_or(Error::Singular { matrix: "matrix of the added mass", size, time })
    }

    /// Size of a force in the measure of [`Solver::step`]'s residuals.
    fn force_size(&self, force: &DVector<f64>, workspace: &Workspace) -> f64 {
        self.free.force_norm(force, &workspace.mass)
    }
}

impl Sensitivity {
    /// The sensitivities to the given load of a step in which the added mass took part.
    pub fn with_added_mass(self, added: &AddedMass, duration: f64) -> Option<Self> {
        let size = added.acceleration.len();
        let answer = DMatrix::identity(size, size) + &added.matrix * &self.velocity / duration;
        let inverse = answer.try_inverse()?;
        Some(Self {
            position: self.position * &inverse,
            velocity: self.velocity * &inverse,
            acceleration: self.acceleration * &inverse,
        })
    }
}
