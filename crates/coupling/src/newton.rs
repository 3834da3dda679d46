//! Newton's method on the iterated quantities, with the Jacobian of a whole pass from directional derivatives.

use crate::acceleration::relaxed;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Share of a change of the produced quantities that a Jacobian may miss when it is first checked.
const MISSED: f64 = 0.2;

/// Share of the largest quantity below which others may be noise of a solver.
const NOISE: f64 = 1e-6;

/// Q + (I - J)^-1 (Q~ - Q) with J = dQ~/dQ (interface-Jacobian co-simulation, Sicklinger et al. 2014).
///
/// Derivatives of foreign participants may be wrong or mean something else (FMI 2.0 leaves open what a derivative at a
/// communication point is): the first change that the method makes is compared with what the Jacobian foretold.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Newton {
    jacobian: Option<DMatrix<f64>>,
    /// Guess and produced quantities of the last iteration of this step.
    last: Option<(Vec<f64>, Vec<f64>)>,
    trusted: bool,
}

impl Newton {
    /// Starts a step: the Jacobian of the last one is not used again.
    pub fn start_step(&mut self) {
        self.jacobian = None;
        self.last = None;
    }

    /// Whether the method needs the Jacobian of the pass that was just made.
    pub fn needs_jacobian(&self) -> bool {
        self.jacobian.is_none()
    }

    /// Takes dQ~/dQ of the last pass.
    pub fn set_jacobian(&mut self, jacobian: DMatrix<f64>) {
        self.jacobian = Some(jacobian);
    }

    /// Next guess after the guess `used` gave `produced`; the guess that was produced where I - J is singular.
    pub fn next(&mut self, used: &[f64], produced: &[f64]) -> Vec<f64> {
        self.last = Some((used.to_vec(), produced.to_vec()));
        let residual = DVector::from_iterator(used.len(), produced.iter().zip(used).map(|(p, u)| p - u));
        let change = self.jacobian.as_ref().and_then(|jacobian| {
            let size = residual.len();
            (DMatrix::identity(size, size) - jacobian).lu().solve(&residual)
        });
        match change {
            Some(change) => used.iter().zip(change.iter()).map(|(used, change)| used + change).collect(),
            None => relaxed(used, produced, 1.0),
        }
    }

    /// How much of the first change of the produced quantities the Jacobian missed, as a share of it, if that is too
    /// much; asked after the pass with the guess `used`. Once it was right it is not asked again.
    pub fn missed(&mut self, used: &[f64], produced: &[f64]) -> Option<f64> {
        let (Some((old_used, old_produced)), Some(jacobian)) = (&self.last, &self.jacobian) else { return None };
        if self.trusted {
            return None;
        }
        let difference =
            |new: &[f64], old: &[f64]| DVector::from_iterator(new.len(), new.iter().zip(old).map(|(a, b)| a - b));
        let actual = difference(produced, old_produced);
        let foretold = jacobian * difference(used, old_used);
        // Every quantity counts in units of its own size, as far as it is more than rounding of the largest.
        let own = |k: usize| produced[k].abs().max(old_produced[k].abs());
        let floor = NOISE * (0..produced.len()).map(own).fold(f64::MIN_POSITIVE, f64::max);
        let scale = |k: usize| own(k).max(floor);
        let size =
            |vector: &DVector<f64>| vector.iter().enumerate().map(|(k, v)| (v / scale(k)).powi(2)).sum::<f64>().sqrt();
        let (change, miss) = (size(&actual).max(size(&foretold)), size(&(&actual - &foretold)));
        // Changes near rounding say nothing.
        if change < 1e-6 {
            return None;
        }
        self.trusted = miss <= MISSED * change;
        (!self.trusted).then(|| miss / change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Q~ = c + J Q with an eigenvalue of -9.
    fn produce(guess: &[f64]) -> Vec<f64> {
        vec![1.0 - 3.0 * guess[0] + 2.0 * guess[1], 2.0 - 9.0 * guess[1]]
    }

    fn jacobian() -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &[-3.0, 2.0, 0.0, -9.0])
    }

    #[test]
    fn a_linear_problem_takes_one_correction() {
        let mut newton = Newton::default();
        newton.start_step();
        let first = vec![0.0, 0.0];
        newton.set_jacobian(jacobian());
        let second = newton.next(&first, &produce(&first));
        assert!((second[1] - 0.2).abs() < 1e-15 && (second[0] - 0.35).abs() < 1e-15, "{second:?}");
        assert_eq!(newton.missed(&second, &produce(&second)), None);
        assert!(newton.trusted);
    }

    #[test]
    fn a_wrong_jacobian_is_noticed() {
        let mut newton = Newton::default();
        newton.start_step();
        let first = vec![0.0, 0.0];
        newton.set_jacobian(jacobian() * -0.5);
        let second = newton.next(&first, &produce(&first));
        let missed = newton.missed(&second, &produce(&second)).unwrap();
        assert!(missed > 1.0, "missed {missed}");
    }
}
