//! Whether a state read from bytes can be one that a structure saved.

use super::{LastStep, Machinery, Progress, State};
use crate::interface::{COORDINATES, finite};
use fmi2::Failure;
use structure::{AddedMass, Solver};

fn length(what: &str, got: usize, expected: usize) -> Result<(), Failure> {
    if got == expected {
        Ok(())
    } else {
        Err(Failure::refused(format!("length of {what} = {got}: expected {expected}")))
    }
}

fn sound(solver: &Solver, what: &str, state: &structure::State) -> Result<(), Failure> {
    finite(&format!("time of {what}"), &[state.time])?;
    solver.check_state(state).map_err(|error| Failure::refused(format!("{what}: {error}")))
}

impl State {
    /// What needs no scene: inputs and outputs.
    pub(super) fn check(&self) -> Result<(), Failure> {
        finite("load", &self.load)?;
        finite("load_acceleration", &self.load_acceleration)?;
        length("added_mass", self.added_mass.len(), COORDINATES * COORDINATES)?;
        finite("added_mass", &self.added_mass)?;
        let outputs = &self.outputs;
        outputs.motion.check("motion")?;
        let [along_x, along_y] = outputs.momentum;
        let others = [outputs.middle, outputs.tip, outputs.kinetic, outputs.potential, along_x, along_y];
        finite("deflections, energies and momentum", &others)
    }
}

impl Progress {
    /// What the scene says about sizes and locked coordinates.
    pub(super) fn check(&self, machinery: &Machinery) -> Result<(), Failure> {
        finite("start", &[self.start])?;
        sound(&machinery.solver, "the state", &self.state)?;
        let Some(LastStep { before, load, added, duration }) = &self.last else { return Ok(()) };
        sound(&machinery.solver, "the state before the last step", before)?;
        let size = self.state.motion.position.len();
        length("the load of the last step", load.len(), size)?;
        finite("load of the last step", load)?;
        if let Some(AddedMass { matrix, acceleration }) = added {
            length("the acceleration of the last step", acceleration.len(), size)?;
            finite("acceleration of the last step", acceleration.as_slice())?;
            finite("added mass of the last step", matrix.as_slice())?;
        }
        if duration.is_finite() && *duration > 0.0 {
            return Ok(());
        }
        Err(Failure::refused(format!("duration of the last step = {duration} s: expected a finite number above 0")))
    }
}
