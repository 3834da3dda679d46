//! What happened during a step.

use crate::Error;
use crate::linear::Outcome;
use std::ops::AddAssign;
use std::time::Instant;

/// Wall-clock seconds by stage. They do not influence the result.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StageTimes {
    /// Prediction, wall geometry, neighbour search and mirror images.
    pub neighbours: f64,
    /// Number density, free surface, source term, matrix and preconditioner.
    pub assembly: f64,
    /// Pressure solve.
    pub solve: f64,
    /// Pressure gradient, correction, shifting and collisions.
    pub gradient: f64,
    /// Loads, checks, book-keeping.
    pub other: f64,
}

impl AddAssign for StageTimes {
    fn add_assign(&mut self, other: Self) {
        let Self { neighbours, assembly, solve, gradient, other: rest } = other;
        self.neighbours += neighbours;
        self.assembly += assembly;
        self.solve += solve;
        self.gradient += gradient;
        self.other += rest;
    }
}

/// What happened during one call of `step`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// Internal time steps.
    pub substeps: usize,
    /// Internal time steps whose geometry was still in the workspace from an earlier pass.
    pub reused: usize,
    /// Iterations of the pressure solver, summed over the internal steps.
    pub iterations: usize,
    /// Unit responses that the step rests on, one for each coordinate that answers to the load; a repeat finds them
    /// done.
    pub responses: usize,
    /// Largest relative residual left.
    pub residual: f64,
    /// Number of pressure unknowns in the last internal step.
    pub unknowns: usize,
    /// Time step that the stability limits would allow next \[s\].
    pub suggested_step: f64,
    /// Particles that touched a wall closer than the collision distance.
    pub contacts: usize,
    /// Seconds by stage.
    pub stages: StageTimes,
}

impl Report {
    /// Enters a solve for `unknowns` pressures at a time \[s\]; an error if it did not reach its tolerance.
    pub(crate) fn enter_solve(
        &mut self,
        outcome: Outcome,
        unknowns: usize,
        time: f64,
        tolerance: f64,
    ) -> Result<(), Error> {
        let Outcome { iterations, residual } = outcome;
        self.unknowns = unknowns;
        self.iterations += iterations;
        self.residual = self.residual.max(residual);
        if residual > tolerance || !residual.is_finite() {
            return Err(Error::Pressure { time, iterations, residual, tolerance, unknowns });
        }
        Ok(())
    }
}

/// A stop watch that adds laps to a stage.
pub(crate) struct Watch(Instant);

impl Watch {
    pub(crate) fn start() -> Self {
        Self(Instant::now())
    }

    /// Adds the time since the last lap to `stage`.
    pub(crate) fn lap(&mut self, stage: &mut f64) {
        let now = Instant::now();
        *stage += (now - self.0).as_secs_f64();
        self.0 = now;
    }
}
