//! What a model has to offer to become an FMU.

use crate::{Failure, Logger, Reference, Variable};
use serde::{Serialize, de::DeserializeOwned};
use std::path::{Path, PathBuf};

/// A unit and its SI exponents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Name in the XML.
    pub name: &'static str,
    /// Exponents of kg, m, s and rad; none for a unit with fractional exponents.
    pub exponents: Option<[i8; 4]>,
}

/// A quantity with its unit, referred to by variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimpleType {
    /// Name in the XML.
    pub name: &'static str,
    /// Physical quantity.
    pub quantity: &'static str,
    /// Name of a unit of the model.
    pub unit: &'static str,
    /// Meaning.
    pub description: &'static str,
}

/// Proposal for a run \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DefaultExperiment {
    /// End; the start is 0.
    pub stop: f64,
    /// Communication step.
    pub step: f64,
}

/// A model's description of itself.
pub struct Model<C> {
    /// Identifier: file name of the binary.
    pub identifier: &'static str,
    /// Name shown to a user.
    pub name: &'static str,
    /// One sentence.
    pub description: &'static str,
    /// Units used.
    pub units: Vec<Unit>,
    /// Types used.
    pub types: Vec<SimpleType>,
    /// All variables, in the order of the XML.
    pub variables: Vec<Variable<C>>,
    /// Proposal for a run.
    pub experiment: DefaultExperiment,
    /// Whether directional derivatives are given.
    pub directional_derivatives: bool,
    /// Name and text of vendor annotations.
    pub annotations: Vec<(&'static str, &'static str)>,
}

/// What an instance is given at instantiation.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup<I> {
    /// What decides its variables.
    pub interface: I,
    /// Folder of the FMU's resources; none when the importer did not say.
    pub resources: Option<PathBuf>,
}

/// The experiment that the importer set up \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experiment {
    /// Start time.
    pub start: f64,
    /// Stop time, if defined.
    pub stop: Option<f64>,
    /// Relative tolerance, if defined.
    pub tolerance: Option<f64>,
}

/// A model behind an FMU. It knows its physics and its table; [`crate::Instance`] drives it.
pub trait Component: Sized + 'static {
    /// Everything that must survive a step or decides its result: parameters, inputs, outputs, solver state. Scratch
    /// space does not belong to it.
    type State: Clone + Serialize + DeserializeOwned;

    /// What decides which variables the model has: the names in a scene, for example.
    type Interface: Clone;

    /// The interface of the FMU that has these resources, a folder; that of an FMU without any where none are given.
    ///
    /// # Errors
    /// Resources that cannot be read.
    fn interface(resources: Option<&Path>) -> Result<Self::Interface, Failure>;

    /// Description and table for one interface.
    fn model(interface: &Self::Interface) -> Model<Self>;

    /// A new component. The start values of the table are set right afterwards.
    fn new(setup: &Setup<Self::Interface>) -> Self;

    /// Builds the initial state from the parameters. Called at the start of the initialisation mode, and again
    /// whenever a parameter was changed there.
    fn initialise(&mut self, experiment: &Experiment, log: &Logger) -> Result<(), Failure>;

    /// Advances from `time` to `time + step` \[s\]. After a failure with discard the component is as before.
    fn do_step(&mut self, time: f64, step: f64, log: &Logger) -> Result<(), Failure>;

    /// Finishes the run: last output.
    fn terminate(&mut self, log: &Logger) -> Result<(), Failure>;

    /// A copy of the state.
    fn save(&self) -> Self::State;

    /// The same into the memory of an earlier copy: coupling saves in every pass.
    fn save_into(&self, copy: &mut Self::State) {
        *copy = self.save();
    }

    /// Refuses a state read from bytes that no instance of this model can have saved. A checksum says that the bytes
    /// are those that somebody wrote, not that a model wrote them: lengths, ranges and whatever steps and getters rely
    /// on belong here.
    fn check(&self, _state: &Self::State) -> Result<(), Failure> {
        Ok(())
    }

    /// Refuses a state of another model, which another instance may have saved: one of another scene, for example.
    fn accept(&self, _state: &Self::State) -> Result<(), Failure> {
        Ok(())
    }

    /// Goes back to a saved state, which may come from another instance or process. After a failure the component is as
    /// before.
    fn restore(&mut self, state: &Self::State) -> Result<(), Failure>;

    /// Matrix of d unknown(t + H) / d known, the known ones held over the last step, row by row.
    fn derivatives(&mut self, unknowns: &[Reference], knowns: &[Reference]) -> Result<Vec<f64>, Failure>;
}
