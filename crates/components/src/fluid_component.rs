//! The fluid: water between fixed walls and around a body whose motion comes from outside.

mod gas;
mod instruments;
mod runtime;
mod table;

use crate::interface::{LOAD_ACCELERATION, Matching, check_motion, coordinate, finite};
use crate::parameters::{HasSceneParameters, SceneParameters, same_model};
use crate::{Error, Interface, LOAD, VELOCITY};
use fluid::{Gain, Observables, Sensor};
use fmi::{Component, Experiment, Failure, Logger, Model, Reference, Setup};
use kinematics::Motion;
use runtime::Runtime;
use scene::Scene;
use serde::{Deserialize, Serialize};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Parameters of the FMU; zeros and empty texts mean "as the scene says".
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Parameters {
    common: SceneParameters,
    particle_spacing: f64,
    threads: i32,
}

/// What the solver said of the last step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct StepReport {
    iterations: i32,
    responses: i32,
    substeps: i32,
    suggested_step: f64,
    duration: f64,
}

/// What the scene became and where it stands.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Progress {
    scene: Arc<Scene>,
    start: f64,
    state: fluid::State,
    report: StepReport,
}

impl Clone for Progress {
    fn clone(&self) -> Self {
        let Self { scene, start, state, report } = self;
        Self { scene: Arc::clone(scene), start: *start, state: state.clone(), report: report.clone() }
    }

    /// Keeps the memory of the particles.
    fn clone_from(&mut self, source: &Self) {
        let Self { scene, start, state, report } = self;
        if !Arc::ptr_eq(scene, &source.scene) {
            *scene = Arc::clone(&source.scene);
        }
        *start = source.start;
        state.clone_from(&source.state);
        report.clone_from(&source.report);
    }
}

/// Everything that decides the next step.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    parameters: Parameters,
    /// Motion of the bodies at the end of the step that follows, as many coordinates as the interface has.
    motion: Motion,
    progress: Option<Progress>,
}

impl Clone for State {
    fn clone(&self) -> Self {
        let Self { parameters, motion, progress } = self;
        Self { parameters: parameters.clone(), motion: motion.clone(), progress: progress.clone() }
    }

    /// Keeps the memory of the particles: states are saved and restored in every pass.
    fn clone_from(&mut self, source: &Self) {
        let Self { parameters, motion, progress } = self;
        if *parameters != source.parameters {
            parameters.clone_from(&source.parameters);
        }
        motion.clone_from(&source.motion);
        progress.clone_from(&source.progress);
    }
}

/// Seconds spent by this instance, repeated steps included.
#[derive(Debug, Clone, Copy, Default)]
struct Seconds {
    stages: fluid::StageTimes,
    output: f64,
}

/// The fluid as a component.
pub struct FluidComponent {
    interface: Interface,
    resources: Option<PathBuf>,
    state: State,
    runtime: Option<Runtime>,
    seconds: Seconds,
    /// Figures of the present state, computed when the first of them is read.
    observed: OnceCell<Observables>,
}

/// Places of the particles of a scene's water \[m\], set up as a run would do it, and what a run would warn of; none
/// without a fluid.
///
/// # Errors
/// What a run would refuse before its first step.
pub fn fluid_set_up(scene: &Scene) -> Result<(Vec<[f32; 2]>, Vec<String>), Error> {
    if scene.fluid.is_none() {
        return Ok((Vec::new(), Vec::new()));
    }
    let runtime = Runtime::new(Arc::new(scene.clone()), &Interface::of(scene), &SceneParameters::default(), 0.0)?;
    let particles = runtime.solver.initial_state().positions.iter().map(frames::single).collect();
    Ok((particles, runtime.warnings))
}

impl FluidComponent {
    fn resolve_scene(&self) -> Result<Scene, Error> {
        let parameters = &self.state.parameters;
        let mut scene = parameters.common.find_scene(self.resources.as_deref())?;
        let missing = || Error::MissingPart { title: scene.title.clone(), part: "[fluid]" };
        if scene.fluid.is_none() {
            return Err(missing());
        }
        if let Some(part) = &mut scene.fluid {
            if parameters.particle_spacing > 0.0 {
                part.spacing = parameters.particle_spacing;
            }
            if let Ok(threads @ 1..) = usize::try_from(parameters.threads) {
                part.threads = threads;
            }
        }
        scene.validate(&parameters.common.scene)?;
        Ok(scene)
    }

    fn prepare(&mut self, start: f64) -> Result<(), Error> {
        let scene = Arc::new(self.resolve_scene()?);
        let mut runtime = Runtime::new(Arc::clone(&scene), &self.interface, &self.state.parameters.common, start)?;
        let mut state = runtime.solver.initial_state();
        state.time = start;
        for (own, of_scene) in runtime.matching.pairs() {
            state.motion.position[of_scene] = self.state.motion.position[own];
        }
        runtime.solver.begin(&mut state, runtime.workspace.get_mut())?;
        self.observed = OnceCell::new();
        self.state.progress = Some(Progress { scene, start, state, report: StepReport::default() });
        self.runtime = Some(runtime);
        Ok(())
    }

    /// Figures of the present state; none before initialisation.
    fn observables(&self) -> Option<&Observables> {
        let (runtime, progress) = (self.runtime.as_ref()?, self.state.progress.as_ref()?);
        Some(
            self.observed
                .get_or_init(|| runtime.solver.observe_with(&progress.state, &mut runtime.workspace.borrow_mut())),
        )
    }

    /// Index in the scene of a coordinate of the interface, with the state of the water; none for one that the scene has not.
    fn of_scene(&self, index: usize) -> Option<(usize, &fluid::State)> {
        let (runtime, progress) = (self.runtime.as_ref()?, self.state.progress.as_ref()?);
        Some((runtime.matching.coordinate(index)?, &progress.state))
    }

    fn load(&self, index: usize) -> f64 {
        self.of_scene(index).map_or(0.0, |(index, state)| state.load[index])
    }

    fn load_acceleration(&self, index: usize) -> f64 {
        self.of_scene(index).map_or(0.0, |(index, state)| state.acceleration[index])
    }

    fn added_mass(&self, row: usize, column: usize) -> f64 {
        let entry = self.of_scene(row).zip(self.of_scene(column));
        entry.map_or(0.0, |((row, state), (column, _))| state.added_mass[row * state.acceleration.len() + column])
    }

    /// One of the gains that changed momentum and energy.
    fn gain(&self, index: usize) -> Gain {
        self.state.progress.as_ref().map_or_else(Gain::default, |progress| progress.state.gains.terms()[index])
    }

    /// What a sensor that the scene has read; zeros for others and before initialisation.
    fn sensor(&self, matching: fn(&Matching) -> &[Option<usize>], index: usize) -> Sensor {
        let index = self.runtime.as_ref().and_then(|runtime| matching(&runtime.matching)[index]);
        let sensors = self.state.progress.as_ref().map(|progress| &progress.state.sensors);
        let found = index.zip(sensors).and_then(|(index, sensors)| sensors.get(index));
        found.copied().unwrap_or_default()
    }

    /// A figure of a place that the scene has; 0 for others and before initialisation.
    fn figure_at(
        &self,
        matching: fn(&Matching) -> &[Option<usize>],
        values: fn(&Observables) -> &[f64],
        index: usize,
    ) -> f64 {
        let Some(of_scene) = self.runtime.as_ref().and_then(|runtime| matching(&runtime.matching)[index]) else {
            return 0.0;
        };
        self.observables().and_then(|seen| values(seen).get(of_scene)).copied().unwrap_or(0.0)
    }
}

fn not_initialised() -> Failure {
    Failure::broken("the fluid is not initialised: call fmi2EnterInitializationMode before")
}

impl HasSceneParameters for FluidComponent {
    fn common(&self) -> &SceneParameters {
        &self.state.parameters.common
    }

    fn common_mut(&mut self) -> &mut SceneParameters {
        &mut self.state.parameters.common
    }
}

impl Component for FluidComponent {
    type State = State;

    type Interface = Interface;

    fn interface(resources: Option<&Path>) -> Result<Interface, Failure> {
        Interface::of_resources(resources).map_err(|error| Failure::refused(error.to_string()))
    }

    fn model(interface: &Interface) -> Model<Self> {
        table::model(interface)
    }

    fn new(setup: &Setup<Interface>) -> Self {
        let motion = Motion::zeros(setup.interface.layout().size());
        Self {
            interface: setup.interface.clone(),
            resources: setup.resources.clone(),
            state: State { parameters: Parameters::default(), motion, progress: None },
            runtime: None,
            seconds: Seconds::default(),
            observed: OnceCell::new(),
        }
    }

    fn initialise(&mut self, experiment: &Experiment, log: &Logger) -> Result<(), Failure> {
        let result = self.prepare(experiment.start);
        let wrong = |error: Error| error.in_scene(&self.state.parameters.common.scene_file());
        result.map_err(|error| Failure::broken(wrong(error).to_string()))?;
        self.runtime.iter().flat_map(|runtime| &runtime.warnings).for_each(|warning| log.warning(warning));
        if let Some(progress) = &self.state.progress {
            let count = progress.state.positions.len();
            log.event(&format!("fluid of '{}' with {count} particles is ready", progress.scene.title));
        }
        Ok(())
    }

    fn do_step(&mut self, time: f64, step: f64, _log: &Logger) -> Result<(), Failure> {
        let (Some(runtime), Some(progress)) = (&mut self.runtime, &mut self.state.progress) else {
            return Err(not_initialised());
        };
        runtime.write_due(&progress.state, time, &mut self.seconds.output)?;
        runtime.take(&self.state.motion);
        progress.state.time = time;
        let report = runtime
            .solver
            .step(&mut progress.state, &runtime.end, step, runtime.workspace.get_mut())
            .map_err(|error| Failure::discard(error.to_string()))?;
        progress.state.time = time + step;
        progress.report = StepReport {
            iterations: i32::try_from(report.iterations).unwrap_or(i32::MAX),
            responses: i32::try_from(report.responses).unwrap_or(i32::MAX),
            substeps: i32::try_from(report.substeps).unwrap_or(i32::MAX),
            suggested_step: report.suggested_step,
            duration: step,
        };
        self.seconds.stages += report.stages;
        self.observed = OnceCell::new();
        Ok(())
    }

    fn terminate(&mut self, _log: &Logger) -> Result<(), Failure> {
        let (Some(runtime), Some(progress)) = (&mut self.runtime, &self.state.progress) else { return Ok(()) };
        runtime.write_last(&progress.state, &mut self.seconds.output)
    }

    fn save(&self) -> State {
        self.state.clone()
    }

    fn save_into(&self, copy: &mut State) {
        copy.clone_from(&self.state);
    }

    fn check(&self, state: &State) -> Result<(), Failure> {
        check_motion("motion", &state.motion, self.state.motion.size())?;
        let Some(progress) = &state.progress else { return Ok(()) };
        let StepReport { suggested_step, duration, .. } = progress.report;
        finite("start, suggested step, duration", &[progress.start, suggested_step, duration])?;
        let refuse = |error: &dyn std::fmt::Display| Failure::refused(error.to_string());
        progress.scene.validate(&state.parameters.common.scene).map_err(|error| refuse(&error))?;
        let checked = match self.runtime.as_ref().filter(|runtime| runtime.fits(&progress.scene)) {
            Some(runtime) => runtime.solver.check_state(&progress.state),
            None => {
                runtime::check_count(&progress.scene, &progress.state)?;
                let set_up = runtime::solver(&progress.scene).map_err(|error| refuse(&error))?;
                set_up.solver.check_state(&progress.state)
            }
        };
        checked.map_err(|error| refuse(&error))
    }

    fn accept(&self, state: &State) -> Result<(), Failure> {
        let (Some(runtime), Some(progress)) = (&self.runtime, &state.progress) else { return Ok(()) };
        same_model(runtime.scene(), &progress.scene)
    }

    fn restore(&mut self, state: &State) -> Result<(), Failure> {
        let common = state.parameters.common.restored(&self.state.parameters.common);
        // On how many threads an instance works is its own affair, once it has some.
        let own = self.runtime.as_ref().map(|_| self.state.parameters.threads);
        let threads = own.unwrap_or(state.parameters.threads);
        let parameters = Parameters { common, threads, ..state.parameters.clone() };
        match &state.progress {
            None => self.runtime = None,
            Some(progress) => {
                let same_output = self.state.parameters.common.same_output(&parameters.common);
                let kept = self.runtime.as_ref().filter(|runtime| runtime.fits(&progress.scene));
                if kept.is_none() || !same_output {
                    let scene = Arc::clone(kept.map_or(&progress.scene, Runtime::scene));
                    let runtime = Runtime::new(scene, &self.interface, &parameters.common, progress.start);
                    self.runtime = Some(runtime.map_err(|error| Failure::broken(error.to_string()))?);
                }
            }
        }
        if let (Some(runtime), Some(progress)) = (&mut self.runtime, &state.progress) {
            runtime.resume(progress.state.time)?;
        }
        self.observed = OnceCell::new();
        self.state.clone_from(state);
        self.state.parameters = parameters;
        if let (Some(runtime), Some(progress)) = (&self.runtime, &mut self.state.progress) {
            progress.scene = Arc::clone(runtime.scene());
        }
        Ok(())
    }

    fn derivatives(&mut self, unknowns: &[Reference], knowns: &[Reference]) -> Result<Vec<f64>, Failure> {
        let Some(progress) = &self.state.progress else { return Err(not_initialised()) };
        let duration = progress.report.duration;
        if duration <= 0.0 {
            return Err(Failure::refused("directional derivatives belong to a step, and none was done yet"));
        }
        if matches!(self.runtime.as_ref().map(|runtime| runtime.solver.has_added_mass()), Some(false)) {
            return Err(Failure::refused(
                "the scheme 'mps' has no added mass and so no directional derivatives: couple with iqn_ils or aitken",
            ));
        }
        // Within the step the water answers to the mean acceleration alone, and that follows from the end velocity.
        let size = self.state.motion.size();
        let entry = |unknown: Reference, known: Reference| -> f64 {
            let Some((VELOCITY, column)) = coordinate(known, size) else { return 0.0 };
            match coordinate(unknown, size) {
                Some((LOAD, row)) => -self.added_mass(row, column) / duration,
                Some((LOAD_ACCELERATION, row)) if row == column => 1.0 / duration,
                _ => 0.0,
            }
        };
        let pairs = unknowns.iter().flat_map(|&unknown| knowns.iter().map(move |&known| (unknown, known)));
        Ok(pairs.map(|(unknown, known)| entry(unknown, known)).collect())
    }
}
