//! Whether a state read from bytes can be one that a structure saved.

use super::{LastStep, Progress, Runtime, State};
use crate::Interface;
use crate::interface::{check_motion, finite, length};
use fmi::Failure;
use structure::{AddedMass, Solver};

fn sound(solver: &Solver, what: &str, state: &structure::State) -> Result<(), Failure> {
    finite(&format!("time of {what}"), &[state.time])?;
    solver.check_state(state).map_err(|error| Failure::refused(format!("{what}: {error}")))
}

impl State {
    /// What needs no scene: inputs and outputs.
    pub(super) fn check(&self, interface: &Interface) -> Result<(), Failure> {
        let (size, members) = (interface.layout().size(), interface.members().count());
        for (name, values, expected) in [
            ("load", &self.load, size),
            ("load_acceleration", &self.load_acceleration, size),
            ("added_mass", &self.added_mass, size * size),
            ("youngs_moduli", &self.parameters.youngs_moduli, members),
        ] {
            length(name, values.len(), expected)?;
            finite(name, values)?;
        }
        let outputs = &self.outputs;
        check_motion("motion", &outputs.motion, size)?;
        length("deflections", outputs.deflections.len(), members)?;
        finite("deflections", outputs.deflections.as_flattened())?;
        let [along_x, along_y] = outputs.momentum;
        finite("energies and momentum", &[outputs.kinetic, outputs.potential, along_x, along_y])
    }
}

impl Progress {
    /// What the scene says about sizes and locked coordinates.
    pub(super) fn check(&self, runtime: &Runtime) -> Result<(), Failure> {
        finite("start", &[self.start])?;
        sound(&runtime.solver, "the state", &self.state)?;
        let Some(LastStep { before, load, added, duration }) = &self.last else { return Ok(()) };
        sound(&runtime.solver, "the state before the last step", before)?;
        let size = self.state.motion.position.len();
        length("the load of the last step", load.len(), size)?;
        finite("load of the last step", load)?;
        if let Some(AddedMass { matrix, acceleration }) = added {
            length("the added mass of the last step, rows", matrix.nrows(), size)?;
            length("the added mass of the last step, columns", matrix.ncols(), size)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StructureComponent;
    use fmi::{Component, Setup};
    use nalgebra::{DMatrix, DVector};

    /// A plate that swung for a step, and its state.
    fn swung() -> (StructureComponent, State) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/free_decay.toml");
        let interface = Interface::of(&scene::Scene::from_file(&path).unwrap());
        let mut component = StructureComponent::new(&Setup { interface, resources: None });
        component.state.parameters.common.scene = path.display().to_string();
        component.prepare(0.0).unwrap();
        component.advance(0.0, 0.001).unwrap();
        let state = component.save();
        (component, state)
    }

    #[test]
    fn a_saved_state_is_taken_and_a_changed_one_refused() {
        let (component, saved) = swung();
        component.check(&saved).unwrap();
        let refused = |change: &dyn Fn(&mut State)| {
            let mut state = saved.clone();
            change(&mut state);
            component.check(&state).unwrap_err().message
        };
        fn last(state: &mut State) -> &mut LastStep {
            state.progress.as_mut().unwrap().last.as_mut().unwrap()
        }
        assert!(refused(&|state| state.load[0] = f64::NAN).contains("load"));
        assert!(refused(&|state| state.added_mass.truncate(3)).contains("length of added_mass = 3"));
        assert!(refused(&|state| last(state).load.push(0.0)).contains("the load of the last step"));
        assert!(refused(&|state| last(state).duration = -1.0).contains("duration of the last step = -1 s"));
        let added = |rows: usize, size: usize| AddedMass {
            matrix: DMatrix::zeros(rows, rows),
            acceleration: DVector::zeros(size),
        };
        let size = last(&mut saved.clone()).load.len();
        assert!(refused(&|state| last(state).added = Some(added(1, size))).contains("added mass of the last step"));
        assert!(refused(&|state| last(state).added = Some(added(size, 1))).contains("acceleration of the last step"));
        let motion = |state: &mut State| state.progress.as_mut().unwrap().state.motion.velocity[0] = 1.0;
        assert!(refused(&motion).contains("the state"), "a locked coordinate does not move");
    }
}
