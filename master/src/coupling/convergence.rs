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
