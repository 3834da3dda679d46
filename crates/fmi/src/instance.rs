//! One instance of a model: checks, messages, states. In which order it may be called is not its matter.

use crate::{Component, Experiment, Failure, Logger, Model, Setup, Snapshot, Status};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Where an instance is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// As made, or reset.
    Instantiated,
    /// While start values are set.
    Initialization,
    /// At a communication point.
    StepComplete,
    /// After a step that was discarded.
    StepFailed,
    /// After the end of the run.
    Terminated,
    /// After an error of a step, of the initialisation, or a value that is not finite.
    Error,
}

/// An instance of the model `C`. There are no statics: instances do not know of each other.
pub struct Instance<C: Component> {
    pub(crate) component: C,
    pub(crate) model: Model<C>,
    logger: Logger,
    pub(crate) mode: Mode,
    setup: Setup<C::Interface>,
    experiment: Experiment,
    time: f64,
    /// A parameter was changed after the initial state was built.
    pub(crate) stale: bool,
}

fn broken(failure: Failure) -> Failure {
    Failure::broken(failure.message)
}

const EXPERIMENT: Experiment = Experiment { start: 0.0, stop: None, tolerance: None };

impl<C: Component> Instance<C> {
    /// An instance with this interface and these resources, a folder.
    pub fn new(interface: C::Interface, resources: Option<PathBuf>, logger: Logger) -> Self {
        let model = C::model(&interface);
        let setup = Setup { interface, resources };
        let component = C::new(&setup);
        let mut instance = Self {
            component,
            model,
            logger,
            mode: Mode::Instantiated,
            setup,
            experiment: EXPERIMENT,
            time: 0.0,
            stale: false,
        };
        instance.set_start_values();
        instance
    }

    fn set_start_values(&mut self) {
        use crate::Access::{Integer, Real, Text};
        for variable in &self.model.variables {
            match variable.access {
                Real { set: Some(set), start: Some(value), .. } => set(&mut self.component, variable.index, value),
                Integer { set: Some(set), start: Some(value), .. } => set(&mut self.component, variable.index, value),
                Text { set: Some(set), start: Some(value), .. } => set(&mut self.component, variable.index, value),
                _ => {}
            }
        }
    }

    /// The model's table and description.
    pub fn model(&self) -> &Model<C> {
        &self.model
    }

    /// The component, to look at.
    pub fn component(&self) -> &C {
        &self.component
    }

    /// Mode of the state machine.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Time of the communication point \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Puts the instance into the error mode when a call broke it.
    pub(crate) fn note<T>(&mut self, result: Result<T, Failure>) -> Result<T, Failure> {
        if result.as_ref().is_err_and(|failure| failure.breaks_instance) {
            self.mode = Mode::Error;
        }
        result
    }

    /// Where its messages go.
    pub fn logger(&mut self) -> &mut Logger {
        &mut self.logger
    }

    /// Notes that a call broke it, by a panic for example: it is in the error mode then.
    pub fn break_down(&mut self) {
        self.mode = Mode::Error;
    }

    /// Says what run this will be; times in s.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<(), Failure> {
        if !start.is_finite() {
            return Err(Failure::refused(format!("start time {start}: expected a finite number")));
        }
        if let Some(stop) = stop.filter(|&stop| stop.is_nan() || stop < start) {
            return Err(Failure::refused(format!("stop time {stop} s: expected a number from the start {start} s on")));
        }
        self.experiment = Experiment { start, stop, tolerance };
        self.time = start;
        Ok(())
    }

    /// Begins the initialisation: builds the initial state.
    pub fn enter_initialization(&mut self) -> Result<(), Failure> {
        self.mode = Mode::Initialization;
        self.stale = true;
        self.refresh()
    }

    /// Builds the initial state anew when parameters changed since: what is read must be that of the present ones.
    ///
    /// # Errors
    /// Parameters that cannot be.
    pub fn refresh(&mut self) -> Result<(), Failure> {
        if self.stale && self.mode == Mode::Initialization {
            let result = self.component.initialise(&self.experiment, &self.logger).map_err(broken);
            self.note(result)?;
            self.stale = false;
        }
        Ok(())
    }

    /// Ends the initialisation.
    pub fn exit_initialization(&mut self) -> Result<(), Failure> {
        self.refresh()?;
        self.mode = Mode::StepComplete;
        Ok(())
    }

    /// Ends the run.
    pub fn terminate(&mut self) -> Result<(), Failure> {
        self.mode = Mode::Terminated;
        let result = self.component.terminate(&self.logger);
        self.note(result)
    }

    /// As after instantiation.
    pub fn reset(&mut self) {
        self.component = C::new(&self.setup);
        self.set_start_values();
        self.mode = Mode::Instantiated;
        self.experiment = EXPERIMENT;
        self.time = 0.0;
        self.stale = false;
    }

    /// A step from the communication point `time` over `step` \[s\].
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<(), Failure> {
        if !(step.is_finite() && step > 0.0) {
            return Err(Failure::refused(format!("communication step {step} s: expected a positive, finite number")));
        }
        // Importers add up or multiply their time, so it may differ in the last digits.
        let allowance = 1e-6 * step + 8.0 * f64::EPSILON * self.time.abs();
        let distance = (time - self.time).abs();
        if distance.is_nan() || distance > allowance {
            return Err(Failure::refused(format!(
                "communication point {time} s: expected {} s, where the last step ended, which is {distance:e} s away; \
                 restore a state to go back",
                self.time
            )));
        }
        let end = time + step;
        if let Some(stop) = self.experiment.stop.filter(|&stop| end > stop + allowance) {
            return Err(Failure::refused(format!(
                "a step to {end} s passes the stop time {stop} s by {:e} s",
                end - stop
            )));
        }
        match self.component.do_step(time, step, &self.logger) {
            Ok(()) => {
                self.time = end;
                Ok(())
            }
            Err(failure) => {
                self.mode = if failure.status == Status::Discard { Mode::StepFailed } else { Mode::Error };
                Err(failure)
            }
        }
    }

    /// The present state.
    pub fn get_state(&self) -> Snapshot<C::State> {
        Snapshot {
            mode: self.mode,
            start: self.experiment.start,
            stop: self.experiment.stop,
            tolerance: self.experiment.tolerance,
            time: self.time,
            component: self.component.save(),
        }
    }

    /// The present state into the memory of an earlier one.
    pub fn get_state_into(&self, snapshot: &mut Snapshot<C::State>) {
        let Snapshot { mode, start, stop, tolerance, time, component } = snapshot;
        (*mode, *time) = (self.mode, self.time);
        (*start, *stop, *tolerance) = (self.experiment.start, self.experiment.stop, self.experiment.tolerance);
        self.component.save_into(component);
    }

    /// Goes back to a saved state, its own or that of another instance.
    ///
    /// # Errors
    /// A state of another model.
    pub fn set_state(&mut self, snapshot: &Snapshot<C::State>) -> Result<(), Failure> {
        self.component.accept(&snapshot.component)?;
        let result = self.component.restore(&snapshot.component).map_err(broken);
        self.note(result)?;
        self.mode = snapshot.mode;
        // How long it lasts is the importer's to say: one that goes on from an earlier run may go on for longer.
        let stop = match (self.experiment.stop, snapshot.stop) {
            (Some(own), Some(its)) => Some(own.max(its)),
            (None, its) => its,
            (Some(_), None) => None,
        };
        self.experiment = Experiment { start: snapshot.start, stop, tolerance: snapshot.tolerance };
        self.time = snapshot.time;
        self.stale = snapshot.mode == Mode::Initialization;
        Ok(())
    }

    /// Refuses a state read from bytes that no instance of this model can have saved.
    ///
    /// # Errors
    /// What of it cannot be.
    pub fn check_state(&self, snapshot: &Snapshot<C::State>) -> Result<(), Failure> {
        snapshot.check_times()?;
        let refuse = |failure: Failure| Failure::refused(format!("serialised state: {}", failure.message));
        self.component.accept(&snapshot.component).map_err(refuse)?;
        self.component.check(&snapshot.component).map_err(refuse)
    }
}
