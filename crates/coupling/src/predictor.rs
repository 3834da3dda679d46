//! The guess that starts a step: extrapolation of the iterated quantities from the last accepted steps.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Extrapolates step means by a polynomial through the middles of the last steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Predictor {
    order: usize,
    initial: Vec<f64>,
    /// Middle of the step \[s\] and values, newest first.
    history: VecDeque<(f64, Vec<f64>)>,
}

impl Predictor {
    /// Polynomial order 0 to 2; `initial` are the values before the first step.
    pub fn new(order: usize, initial: Vec<f64>) -> Self {
        Self { order, initial, history: VecDeque::new() }
    }

    /// Takes the values of an accepted step from `time` of length `duration`.
    pub fn accept(&mut self, time: f64, duration: f64, values: &[f64]) {
        self.history.push_front((time + 0.5 * duration, values.to_vec()));
        self.history.truncate(self.order + 1);
    }

    /// Guess for the step from `time` of length `duration`: Lagrange's polynomial at its middle.
    pub fn predict(&self, time: f64, duration: f64) -> Vec<f64> {
        if self.history.is_empty() {
            return self.initial.clone();
        }
        let middle = time + 0.5 * duration;
        let mut guess = vec![0.0; self.initial.len()];
        for (i, (t_i, values)) in self.history.iter().enumerate() {
            let others = self.history.iter().enumerate().filter(|(j, _)| *j != i);
            let weight: f64 = others.map(|(_, (t_j, _))| (middle - t_j) / (t_i - t_j)).product();
            guess.iter_mut().zip(values).for_each(|(guess, value)| *guess += weight * value);
        }
        guess
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_two_is_exact_for_a_parabola_with_unequal_steps() {
        let parabola = |t: f64| 3.0 - 2.0 * t + 5.0 * t * t;
        let mut predictor = Predictor::new(2, vec![7.0]);
        assert_eq!(predictor.predict(0.0, 0.1), [7.0]);
        for (time, duration) in [(0.0, 0.1), (0.1, 0.2), (0.3, 0.05), (0.35, 0.1)] {
            predictor.accept(time, duration, &[parabola(time + 0.5 * duration)]);
        }
        let guess = predictor.predict(0.45, 0.2)[0];
        assert!((guess - parabola(0.55)).abs() < 1e-12, "{guess}");
    }

    #[test]
    fn order_zero_repeats_the_last_value() {
        let mut predictor = Predictor::new(0, vec![1.0]);
        predictor.accept(0.0, 1.0, &[4.0]);
        predictor.accept(1.0, 1.0, &[9.0]);
        assert_eq!(predictor.predict(2.0, 1.0), [9.0]);
    }
}
