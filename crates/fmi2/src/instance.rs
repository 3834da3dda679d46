//! One instance of a model: call sequence, checks, messages, states. Usable with and without the C ABI.

use crate::{Component, Experiment, Failure, Function, Logger, Mode, Model, Setup, Snapshot, Status, describe};
use std::ffi::CString;
use std::path::PathBuf;
use uuid::Uuid;

/// An instance of the model `C`. Methods carry the names of the standard's functions and give their result; the
/// statuses of the C functions follow from it. There are no statics: instances do not know of each other.
pub struct Instance<C: Component> {
    pub(crate) component: C,
    pub(crate) model: Model<C>,
    pub(crate) logger: Logger,
    pub(crate) mode: Mode,
    /// Texts that the last fmi2GetString handed out.
    pub(crate) texts: Vec<CString>,
    setup: Setup<C::Interface>,
    guid: Uuid,
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
    /// An instance with this interface, for use in process.
    ///
    /// # Errors
    /// A table that makes no description.
    pub fn new(interface: C::Interface, resources: Option<PathBuf>, logger: Logger) -> Result<Self, Failure> {
        let model = C::model(&interface);
        let guid = describe::guid(&model)?;
        let setup = Setup { interface, resources };
        let component = C::new(&setup);
        let mut instance = Self {
            component,
            model,
            logger,
            mode: Mode::Instantiated,
            texts: Vec::new(),
            setup,
            guid,
            experiment: EXPERIMENT,
            time: 0.0,
            stale: false,
        };
        instance.set_start_values();
        Ok(instance)
    }

    /// The instance that this GUID asks for, with or without braces: that of the resources, or one without any.
    ///
    /// # Errors
    /// A GUID of another build or of other resources.
    pub fn with_guid(guid: &str, resources: Option<PathBuf>, logger: Logger) -> Result<Self, Failure> {
        let bare = guid.trim().trim_start_matches('{').trim_end_matches('}');
        let without = resources.is_none();
        let instance = Self::new(C::interface(resources.as_deref())?, resources, logger)?;
        if instance.guid.to_string().eq_ignore_ascii_case(bare) {
            return Ok(instance);
        }
        let of = if without {
            "that of this binary without resources: the importer gave no fmuResourceLocation, in which it would find for \
             which variables the FMU was packed, or modelDescription.xml and binary are not of the same build"
        } else {
            "that of this binary with these resources: modelDescription.xml, resources and binary are not of the same build"
        };
        Err(Failure::refused(format!("the GUID '{guid}' is not {}, {of}", instance.guid)))
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

    /// The component, to look at in tests.
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

    pub(crate) fn allow(&self, function: Function) -> Result<(), Failure> {
        function.check(self.mode)
    }

    /// fmi2SetDebugLogging.
    pub fn set_debug_logging(&mut self, on: bool, categories: &[String]) -> Result<(), Failure> {
        self.allow(Function::SetDebugLogging)?;
        self.logger.switch(on, categories);
        Ok(())
    }

    /// fmi2SetupExperiment; times in s.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<(), Failure> {
        self.allow(Function::SetupExperiment)?;
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

    /// fmi2EnterInitializationMode: builds the initial state.
    pub fn enter_initialization_mode(&mut self) -> Result<(), Failure> {
        self.allow(Function::EnterInitializationMode)?;
        self.mode = Mode::Initialization;
        self.stale = true;
        self.refresh()
    }

    /// Builds the initial state anew when parameters changed since.
    pub(crate) fn refresh(&mut self) -> Result<(), Failure> {
        if self.stale && self.mode == Mode::Initialization {
            let result = self.component.initialise(&self.experiment, &self.logger).map_err(broken);
            self.note(result)?;
            self.stale = false;
        }
        Ok(())
    }

    /// fmi2ExitInitializationMode.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Failure> {
        self.allow(Function::ExitInitializationMode)?;
        self.refresh()?;
        self.mode = Mode::StepComplete;
        Ok(())
    }

    /// fmi2Terminate.
    pub fn terminate(&mut self) -> Result<(), Failure> {
        self.allow(Function::Terminate)?;
        self.mode = Mode::Terminated;
        let result = self.component.terminate(&self.logger);
        self.note(result)
    }

    /// fmi2Reset: as after instantiation.
    pub fn reset(&mut self) -> Result<(), Failure> {
        self.allow(Function::Reset)?;
        self.component = C::new(&self.setup);
        self.set_start_values();
        self.mode = Mode::Instantiated;
        self.experiment = EXPERIMENT;
        self.time = 0.0;
        self.stale = false;
        Ok(())
    }

    /// fmi2DoStep from the communication point `time` over `step` \[s\].
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<(), Failure> {
        self.allow(Function::DoStep)?;
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
                self.mode = if failure.status == Status::DISCARD { Mode::StepFailed } else { Mode::Error };
                Err(failure)
            }
        }
    }

    /// fmi2GetFMUstate.
    pub fn get_state(&self) -> Result<Snapshot<C::State>, Failure> {
        self.allow(Function::GetFmuState)?;
        Ok(Snapshot {
            mode: self.mode,
            start: self.experiment.start,
            stop: self.experiment.stop,
            tolerance: self.experiment.tolerance,
            time: self.time,
            component: self.component.save(),
        })
    }

    /// fmi2GetFMUstate into the memory of an earlier state.
    pub fn get_state_into(&self, snapshot: &mut Snapshot<C::State>) -> Result<(), Failure> {
        self.allow(Function::GetFmuState)?;
        let Snapshot { mode, start, stop, tolerance, time, component } = snapshot;
        (*mode, *time) = (self.mode, self.time);
        (*start, *stop, *tolerance) = (self.experiment.start, self.experiment.stop, self.experiment.tolerance);
        self.component.save_into(component);
        Ok(())
    }

    /// fmi2SetFMUstate.
    pub fn set_state(&mut self, snapshot: &Snapshot<C::State>) -> Result<(), Failure> {
        self.allow(Function::SetFmuState)?;
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

    /// fmi2SerializeFMUstate.
    pub fn serialize(&self, snapshot: &Snapshot<C::State>) -> Result<Vec<u8>, Failure> {
        self.allow(Function::SerializeFmuState)?;
        snapshot.to_bytes(self.guid)
    }

    /// fmi2DeSerializeFMUstate.
    pub fn deserialize(&self, bytes: &[u8]) -> Result<Snapshot<C::State>, Failure> {
        self.allow(Function::DeSerializeFmuState)?;
        let snapshot = Snapshot::from_bytes(bytes, self.guid)?;
        snapshot.check_times()?;
        let refuse = |failure: Failure| Failure::refused(format!("serialised state: {}", failure.message));
        self.component.accept(&snapshot.component).map_err(refuse)?;
        self.component.check(&snapshot.component).map_err(refuse)?;
        Ok(snapshot)
    }
}
