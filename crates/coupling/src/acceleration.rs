//! Accelerators of the fixed-point iteration Q -> Q~.

use crate::{IqnIls, Newton};
use scene::Method;
use serde::{Deserialize, Serialize};

/// How the next guess follows from the last one and what it led to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Accelerator {
    /// Q + omega r with a fixed factor.
    Constant {
        /// The factor omega; 1 is the plain fixed-point iteration.
        relaxation: f64,
    },
    /// Aitken's factor.
    Aitken(Aitken),
    /// Quasi-Newton with least squares.
    IqnIls(IqnIls),
    /// Newton with the Jacobian from directional derivatives.
    Newton(Newton),
}

impl Accelerator {
    /// The accelerator of a method; none for the explicit one. `Auto` counts as `IqnIls`: who knows the participants
    /// has resolved it before. `relaxation` is the (first) factor and
    /// `reused_steps` the number of past steps whose columns the quasi-Newton method keeps.
    pub fn new(method: Method, relaxation: f64, reused_steps: usize) -> Option<Self> {
        match method {
            Method::Explicit => None,
            Method::Constant => Some(Self::Constant { relaxation }),
            Method::Aitken => Some(Self::Aitken(Aitken::new(relaxation))),
            Method::IqnIls | Method::Auto => Some(Self::IqnIls(IqnIls::new(relaxation, reused_steps))),
            Method::Newton => Some(Self::Newton(Newton::default())),
        }
    }

    /// Whether the method should converge fast or not at all.
    pub fn is_quasi_newton(&self) -> bool {
        matches!(self, Self::IqnIls(_) | Self::Newton(_))
    }

    /// Forgets what belongs to the last step alone.
    pub fn start_step(&mut self) {
        match self {
            Self::Constant { .. } => {}
            Self::Aitken(aitken) => aitken.start_step(),
            Self::IqnIls(quasi_newton) => quasi_newton.start_step(),
            Self::Newton(newton) => newton.start_step(),
        }
    }

    /// Next guess after the guess `used` gave `produced`.
    pub fn next(&mut self, used: &[f64], produced: &[f64]) -> Vec<f64> {
        match self {
            Self::Constant { relaxation } => relaxed(used, produced, *relaxation),
            Self::Aitken(aitken) => aitken.next(used, produced),
            Self::IqnIls(quasi_newton) => quasi_newton.next(used, produced),
            Self::Newton(newton) => newton.next(used, produced),
        }
    }

    /// The step has converged: what was learnt may be kept.
    pub fn accept(&mut self, used: &[f64], produced: &[f64]) {
        if let Self::IqnIls(quasi_newton) = self {
            quasi_newton.accept(used, produced);
        }
    }

    /// The step has failed: what was learnt is not trusted.
    pub fn reject(&mut self) {
        if let Self::IqnIls(quasi_newton) = self {
            quasi_newton.forget();
        }
    }
}

/// Q + factor (Q~ - Q).
pub(crate) fn relaxed(used: &[f64], produced: &[f64], factor: f64) -> Vec<f64> {
    used.iter().zip(produced).map(|(used, produced)| used + factor * (produced - used)).collect()
}

/// Aitken's dynamic relaxation (Irons and Tuck 1969; Kuettler and Wall 2008, equation 44):
/// omega_k = -omega_(k-1) r_(k-1).(r_k - r_(k-1)) / |r_k - r_(k-1)|^2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Aitken {
    first: f64,
    factor: f64,
    last: Option<Vec<f64>>,
}

impl Aitken {
    /// `first` bounds the factor of the first iteration of each step.
    pub fn new(first: f64) -> Self {
        Self { first, factor: first, last: None }
    }

    fn start_step(&mut self) {
        self.factor = self.factor.abs().min(self.first).copysign(self.factor);
        self.last = None;
    }

    fn next(&mut self, used: &[f64], produced: &[f64]) -> Vec<f64> {
        let residual: Vec<f64> = produced.iter().zip(used).map(|(produced, used)| produced - used).collect();
        if let Some(last) = &self.last {
            let (mut product, mut square) = (0.0, 0.0);
            for (r, old) in residual.iter().zip(last) {
                product += old * (r - old);
                square += (r - old) * (r - old);
            }
            if square > 0.0 {
                self.factor *= -product / square;
            }
        }
        self.last = Some(residual);
        relaxed(used, produced, self.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Q~ = 1 - 3 Q: fixed point 0.25, diverges without relaxation.
    fn produce(guess: &[f64]) -> Vec<f64> {
        vec![1.0 - 3.0 * guess[0]]
    }

    #[test]
    fn aitken_is_the_secant_method_for_one_unknown() {
        // A linear scalar problem is solved exactly by the second update.
        let mut aitken = Aitken::new(0.1);
        aitken.start_step();
        let first = aitken.next(&[0.0], &produce(&[0.0]));
        assert_eq!(first, [0.1]);
        let second = aitken.next(&first, &produce(&first));
        assert!((second[0] - 0.25).abs() < 1e-15, "{second:?}");
    }

    #[test]
    fn constant_relaxation_contracts_as_the_eigenvalue_says() {
        // Error factor 1 - omega (1 + 3) = 0.2 with omega = 0.2.
        let mut constant = Accelerator::new(Method::Constant, 0.2, 0).unwrap();
        constant.start_step();
        let next = constant.next(&[0.0], &produce(&[0.0]));
        assert!(((next[0] - 0.25) / -0.25 - 0.2).abs() < 1e-12);
        assert!(Accelerator::new(Method::Explicit, 0.2, 0).is_none());
    }
}
