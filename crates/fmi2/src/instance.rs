//! An instance as FMI 2.0 sees it: the call sequence around what it does, texts that outlive their call, states that belong to
//! a GUID.

use crate::{Function, describe};
use fmi::{Component, Failure, Logger, Mode, Model, Reference, Snapshot};
use std::ffi::CString;
use std::path::PathBuf;
use uuid::Uuid;

/// An instance of the model `C`. Methods carry the names of the standard's functions and give their result; the
/// statuses of the C functions follow from it. Usable with and without the C ABI.
pub struct Instance<C: Component> {
    inner: fmi::Instance<C>,
    guid: Uuid,
    /// Texts that the last fmi2GetString handed out.
    texts: Vec<CString>,
}

impl<C: Component> Instance<C> {
    /// An instance with this interface, for use in process.
    ///
    /// # Errors
    /// A table that makes no description.
    pub fn new(interface: C::Interface, resources: Option<PathBuf>, logger: Logger) -> Result<Self, Failure> {
        let inner = fmi::Instance::new(interface, resources, logger);
        let guid = describe::guid(inner.model())?;
        Ok(Self { inner, guid, texts: Vec::new() })
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

    /// The model's table and description.
    pub fn model(&self) -> &Model<C> {
        self.inner.model()
    }

    /// The component, to look at in tests.
    pub fn component(&self) -> &C {
        self.inner.component()
    }

    /// Mode of the state machine.
    pub fn mode(&self) -> Mode {
        self.inner.mode()
    }

    /// Time of the communication point \[s\].
    pub fn time(&self) -> f64 {
        self.inner.time()
    }

    /// Refuses a call that the standard does not allow in this mode.
    pub(crate) fn allow(&self, function: Function) -> Result<(), Failure> {
        function.check(self.mode())
    }

    /// What the calls are made on, where this one is allowed.
    fn calling(&mut self, function: Function) -> Result<&mut fmi::Instance<C>, Failure> {
        self.allow(function)?;
        Ok(&mut self.inner)
    }

    /// Sends the message of a call that failed, which may have broken the instance.
    pub(crate) fn tell(&mut self, failure: &Failure) {
        if failure.breaks_instance {
            self.inner.break_down();
        }
        self.inner.logger().send(failure.status, &failure.message);
    }

    /// fmi2SetDebugLogging.
    pub fn set_debug_logging(&mut self, on: bool, categories: &[String]) -> Result<(), Failure> {
        self.calling(Function::SetDebugLogging)?.logger().switch(on, categories);
        Ok(())
    }

    /// fmi2SetupExperiment; times in s.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<(), Failure> {
        self.calling(Function::SetupExperiment)?.setup_experiment(tolerance, start, stop)
    }

    /// fmi2EnterInitializationMode: builds the initial state.
    pub fn enter_initialization_mode(&mut self) -> Result<(), Failure> {
        self.calling(Function::EnterInitializationMode)?.enter_initialization()
    }

    /// fmi2ExitInitializationMode.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Failure> {
        self.calling(Function::ExitInitializationMode)?.exit_initialization()
    }

    /// fmi2Terminate.
    pub fn terminate(&mut self) -> Result<(), Failure> {
        self.calling(Function::Terminate)?.terminate()
    }

    /// fmi2Reset: as after instantiation.
    pub fn reset(&mut self) -> Result<(), Failure> {
        self.calling(Function::Reset)?.reset();
        Ok(())
    }

    /// fmi2DoStep from the communication point `time` over `step` \[s\].
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<(), Failure> {
        self.calling(Function::DoStep)?.do_step(time, step)
    }

    /// fmi2GetReal.
    pub fn get_real(&mut self, references: &[Reference], values: &mut [f64]) -> Result<(), Failure> {
        self.calling(Function::GetReal)?.get_real(references, values)
    }

    /// fmi2GetInteger.
    pub fn get_integer(&mut self, references: &[Reference], values: &mut [i32]) -> Result<(), Failure> {
        self.calling(Function::GetInteger)?.get_integer(references, values)
    }

    /// fmi2GetString; the texts live in the instance until the next call of it.
    pub fn get_string(&mut self, references: &[Reference]) -> Result<&[CString], Failure> {
        let texts = self.calling(Function::GetString)?.get_string(references)?;
        let text = |text: String| CString::new(text.replace('\0', " ")).unwrap_or_default();
        self.texts = texts.into_iter().map(text).collect();
        Ok(&self.texts)
    }

    /// fmi2SetReal. A value that is not a finite number breaks the instance; one out of range is discarded.
    pub fn set_real(&mut self, references: &[Reference], values: &[f64]) -> Result<(), Failure> {
        self.calling(Function::SetReal)?.set_real(references, values)
    }

    /// fmi2SetInteger. A value out of range is discarded.
    pub fn set_integer(&mut self, references: &[Reference], values: &[i32]) -> Result<(), Failure> {
        self.calling(Function::SetInteger)?.set_integer(references, values)
    }

    /// fmi2SetString.
    pub fn set_string(&mut self, references: &[Reference], values: &[&str]) -> Result<(), Failure> {
        self.calling(Function::SetString)?.set_string(references, values)
    }

    /// fmi2GetBoolean and fmi2SetBoolean: the table has no booleans, so any reference is unknown.
    pub fn no_boolean(&self, function: Function, references: &[Reference]) -> Result<(), Failure> {
        self.allow(function)?;
        match references.first() {
            None => Ok(()),
            Some(reference) => {
                Err(Failure::refused(format!("no boolean variable has the value reference {reference}")))
            }
        }
    }

    /// fmi2GetDirectionalDerivative: d unknown(t + H) / d known . seed, the known ones held over the last step.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seed: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        self.calling(Function::GetDirectionalDerivative)?.directional_derivative(unknowns, knowns, seed)
    }

    /// fmi2GetFMUstate.
    pub fn get_state(&self) -> Result<Snapshot<C::State>, Failure> {
        self.allow(Function::GetFmuState)?;
        Ok(self.inner.get_state())
    }

    /// fmi2GetFMUstate into the memory of an earlier state.
    pub fn get_state_into(&self, snapshot: &mut Snapshot<C::State>) -> Result<(), Failure> {
        self.allow(Function::GetFmuState)?;
        self.inner.get_state_into(snapshot);
        Ok(())
    }

    /// fmi2SetFMUstate.
    pub fn set_state(&mut self, snapshot: &Snapshot<C::State>) -> Result<(), Failure> {
        self.calling(Function::SetFmuState)?.set_state(snapshot)
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
        self.inner.check_state(&snapshot)?;
        Ok(snapshot)
    }
}
