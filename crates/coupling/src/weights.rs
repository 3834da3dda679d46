//! Weights that make quantities of different units comparable in one least-squares problem.

use serde::{Deserialize, Serialize};

/// Residual sums as in preCICE: each quantity is divided by the sum of its shares of the residuals of this step,
/// so that a quantity in large units does not drown the others.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ResidualSums {
    sums: Vec<f64>,
}

impl ResidualSums {
    /// Forgets the past step.
    pub fn reset(&mut self) {
        self.sums.clear();
    }

    /// Takes the residual of one iteration.
    pub fn add(&mut self, residual: &[f64]) {
        self.sums.resize(residual.len(), 0.0);
        let norm = residual.iter().map(|r| r * r).sum::<f64>().sqrt();
        if norm > 0.0 {
            self.sums.iter_mut().zip(residual).for_each(|(sum, r)| *sum += r.abs() / norm);
        }
    }

    /// One factor per quantity. A quantity without any residual counts like the largest.
    pub fn factors(&self) -> Vec<f64> {
        let largest = self.sums.iter().copied().fold(0.0, f64::max);
        let floor = 1e-10 * largest;
        self.sums.iter().map(|sum| if *sum > floor { 1.0 / sum } else { 1.0 / largest.max(1e-300) }).collect()
    }
}
