//! When an iterated quantity has converged: |r| <= relative |Q~| + absolute, for every quantity on its own.

use serde::Serialize;
use std::fmt;

/// Tolerance of one iterated quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Share of the quantity's own size.
    pub relative: f64,
    /// In the quantity's unit.
    pub absolute: f64,
}

/// Residual of one iterated quantity in one iteration, in its own unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Residual {
    /// Name of the quantity, `participant.variable`.
    pub name: String,
    /// Value that the pass gave, Q~.
    pub value: f64,
    /// Q~ - Q.
    pub residual: f64,
    /// Largest residual allowed.
    pub tolerance: f64,
}

impl Residual {
    /// Residual of a quantity that was guessed as `used` and came out as `produced`.
    pub fn new(name: &str, used: f64, produced: f64, tolerance: Tolerance) -> Self {
        Self {
            name: name.to_string(),
            value: produced,
            residual: produced - used,
            tolerance: tolerance.relative * produced.abs() + tolerance.absolute,
        }
    }

    /// Whether it is within tolerance; a residual that is no number is not.
    pub fn converged(&self) -> bool {
        self.residual.abs() <= self.tolerance
    }
}

impl fmt::Display for Residual {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let sign = if self.converged() { "<=" } else { ">" };
        let (residual, tolerance) = (self.residual.abs(), self.tolerance);
        write!(formatter, "{} residual {residual:.3e} {sign} tolerance {tolerance:.3e}", self.name)
    }
}

/// Iterations within which a quasi-Newton method must halve its residual: one that does not has met a jump of the
/// produced quantities, and a smaller step is the way out.
const PATIENCE: usize = 8;

/// Notices an iteration that no longer gets anywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Stall {
    best: f64,
    since: usize,
}

impl Default for Stall {
    fn default() -> Self {
        Self { best: f64::INFINITY, since: 0 }
    }
}

impl Stall {
    /// Takes the residuals of an iteration, counted from 1; true when the largest one, in units of its tolerance,
    /// was not halved for a while.
    pub fn update(&mut self, iteration: usize, residuals: &[Residual]) -> bool {
        let ratio = |residual: &Residual| residual.residual.abs() / residual.tolerance.max(f64::MIN_POSITIVE);
        let size = residuals.iter().map(ratio).fold(0.0, f64::max);
        if size < 0.5 * self.best {
            *self = Self { best: size, since: iteration };
        }
        iteration >= self.since + PATIENCE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn residual(size: f64) -> [Residual; 1] {
        [Residual::new("q", 0.0, size, Tolerance { relative: 0.0, absolute: 1e-6 })]
    }

    #[test]
    fn tolerance_follows_the_quantity() {
        let tolerance = Tolerance { relative: 1e-2, absolute: 0.5 };
        let residual = Residual::new("q", 100.0, 101.0, tolerance);
        assert_eq!((residual.residual, residual.tolerance), (1.0, 1.51));
        assert!(residual.converged() && !Residual::new("q", 98.0, 101.0, tolerance).converged());
        assert!(!Residual::new("q", 98.0, f64::NAN, tolerance).converged());
    }

    #[test]
    fn a_stall_is_eight_iterations_without_halving() {
        let mut stall = Stall::default();
        let stalled = |stall: &mut Stall, k: usize, size| stall.update(k, &residual(size));
        assert!((1..=9).all(|k| !stalled(&mut stall, k, 1.0 / (1 << k) as f64 / 1.1_f64.powi(k as i32))));
        let first = (10..).find(|k| stalled(&mut stall, *k, 0.3));
        assert_eq!(first, Some(17));
    }
}
