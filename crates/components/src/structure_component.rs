//! The structure: a rigid cabin with an elastic beam, driven by the load of a fluid.

mod check;
mod runtime;
mod table;

use crate::interface::{COORDINATES, MotionValues, coordinate, mass_index};
use crate::parameters::{HasSceneParameters, SceneParameters, same_model};
use crate::{ACCELERATION, Error, LOAD, POSITION, VELOCITY, conversion};
use fmi2::{Component, Experiment, Failure, Logger, Model, Reference, Setup};
use frames::{Frame, Line, Series};
use kinematics::MAXIMUM_MODES;
use nalgebra::{DMatrix, DVector};
use runtime::Runtime;
use scene::Scene;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;
use structure::AddedMass;

/// Name of the series of field frames.
const FIELD: &str = "structure";

/// Parameters of the FMU; zeros and empty texts mean "as the scene says".
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Parameters {
    common: SceneParameters,
    youngs_modulus: f64,
}

/// Values of the outputs at a communication point.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Outputs {
    motion: MotionValues,
    middle: f64,
    tip: f64,
    kinetic: f64,
    potential: f64,
    momentum: [f64; 2],
    unknowns: i32,
    iterations: i32,
}

/// The last step, from which its sensitivities follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct LastStep {
    before: structure::State,
    /// Load that acted, the constant one of the scene included.
    load: Vec<f64>,
    added: Option<AddedMass>,
    duration: f64,
}

/// What the scene became and where it stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Progress {
    scene: Arc<Scene>,
    start: f64,
    state: structure::State,
    last: Option<LastStep>,
}

/// Everything that decides the next step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    parameters: Parameters,
    load: [f64; COORDINATES],
    load_acceleration: [f64; COORDINATES],
    /// Added mass of the largest interface, row after row.
    added_mass: Vec<f64>,
    outputs: Outputs,
    progress: Option<Progress>,
}

/// The structure as a component.
pub struct StructureComponent {
    modes: usize,
    resources: Option<PathBuf>,
    state: State,
    runtime: Option<Runtime>,
    /// Seconds spent in steps by this instance, repeated ones included.
    seconds: f64,
}

/// Coordinates that a scene's structure is solved for, and the lines of its outline \[m\], set up as a run would do it;
/// 0 and none without a structure.
///
/// # Errors
/// What a run would refuse before its first step.
pub fn structure_set_up(scene: &Scene) -> Result<(usize, Vec<Line>), Error> {
    let Some(structure) = &scene.structure else { return Ok((0, Vec::new())) };
    let runtime = Runtime::new(Arc::new(scene.clone()), MAXIMUM_MODES, None)?;
    let frame = runtime.frame(&runtime.bodies.at_rest());
    let lines = frame.lines.iter().map(|ends| ends.map(|end| frame.points[end as usize])).collect();
    Ok((structure.free.len() + scene.modes(), lines))
}

impl StructureComponent {
    fn resolve_scene(&self) -> Result<Scene, Error> {
        let parameters = &self.state.parameters;
        let mut scene = parameters.common.find_scene(self.resources.as_deref())?;
        if parameters.youngs_modulus > 0.0 {
            let beam = scene.structure.as_mut().and_then(|structure| structure.beam.as_mut());
            let Some(beam) = beam else {
                return Err(Error::Value {
                    key: "youngs_modulus".to_string(),
                    got: parameters.youngs_modulus.to_string(),
                    expected: "0: the scene has no beam".to_string(),
                });
            };
            beam.youngs_modulus = parameters.youngs_modulus;
            scene.validate(&parameters.common.scene)?;
        }
        Ok(scene)
    }

    fn prepare(&mut self, start: f64) -> Result<(), Error> {
        let scene = Arc::new(self.resolve_scene()?);
        let series = self.state.parameters.common.series(&scene, FIELD, start)?;
        let runtime = Runtime::new(Arc::clone(&scene), self.modes, series)?;
        let mut state = runtime.solver.initial_state(&conversion::initial_modes(&scene))?;
        state.time = start;
        self.state.outputs = runtime.outputs(&state, &structure::Report::default());
        self.state.progress = Some(Progress { scene, start, state, last: None });
        self.runtime = Some(runtime);
        Ok(())
    }

    fn advance(&mut self, time: f64, step: f64) -> Result<(), Failure> {
        let (Some(runtime), Some(progress)) = (&mut self.runtime, &mut self.state.progress) else {
            return Err(not_initialised());
        };
        if let Some(number) = runtime.series.as_ref().and_then(|series| series.due(time)) {
            let frame = runtime.frame(&progress.state.motion);
            write_frame(&mut runtime.series, number, time, frame)?;
        }
        let load = runtime.load(&self.state.load);
        let added = added_mass(&self.state.added_mass, &self.state.load_acceleration, load.len());
        let mut state = progress.state.clone();
        state.time = time;
        let solver = &runtime.solver;
        let result = match &added {
            None => solver.step(&mut state, &load, step, &mut runtime.workspace).map(|report| (report, load)),
            Some(added) => solver.step_with_added_mass(&mut state, &load, added, step, &mut runtime.workspace),
        };
        let (report, load) = result.map_err(|error| Failure::discard(error.to_string()))?;
        state.time = time + step;
        self.state.outputs = runtime.outputs(&state, &report);
        let before = std::mem::replace(&mut progress.state, state);
        progress.last = Some(LastStep { before, load, added, duration: step });
        Ok(())
    }
}

/// What the fluid answers to accelerations; none where no added mass is connected.
fn added_mass(matrix: &[f64], acceleration: &[f64], size: usize) -> Option<AddedMass> {
    if matrix.iter().all(|&entry| entry == 0.0) {
        return None;
    }
    Some(AddedMass {
        matrix: DMatrix::from_fn(size, size, |row, column| matrix[mass_index(row, column)]),
        acceleration: DVector::from_column_slice(&acceleration[..size]),
    })
}

fn not_initialised() -> Failure {
    Failure::broken("the structure is not initialised: call fmi2EnterInitializationMode before")
}

fn write_frame(series: &mut Option<Series>, number: u64, time: f64, frame: Frame) -> Result<(), Failure> {
    match series {
        Some(series) => series.write(number, time, frame).map_err(|error| Failure::broken(error.to_string())),
        None => Ok(()),
    }
}

impl HasSceneParameters for StructureComponent {
    fn common(&self) -> &SceneParameters {
        &self.state.parameters.common
    }

    fn common_mut(&mut self) -> &mut SceneParameters {
        &mut self.state.parameters.common
    }
}

impl Component for StructureComponent {
    type State = State;

    fn variants() -> RangeInclusive<usize> {
        0..=MAXIMUM_MODES
    }

    fn model(variant: usize) -> Model<Self> {
        table::model(variant)
    }

    fn new(setup: &Setup) -> Self {
        let state = State {
            parameters: Parameters::default(),
            load: [0.0; COORDINATES],
            load_acceleration: [0.0; COORDINATES],
            added_mass: vec![0.0; COORDINATES * COORDINATES],
            outputs: Outputs::default(),
            progress: None,
        };
        Self { modes: setup.variant, resources: setup.resources.clone(), state, runtime: None, seconds: 0.0 }
    }

    fn initialise(&mut self, experiment: &Experiment, log: &Logger) -> Result<(), Failure> {
        let result = self.prepare(experiment.start);
        let wrong = |error: Error| error.in_scene(&self.state.parameters.common.scene_file());
        result.map_err(|error| Failure::broken(wrong(error).to_string()))?;
        if let Some(progress) = &self.state.progress {
            let modes = progress.scene.modes();
            log.event(&format!("structure of '{}' with {modes} modes is ready", progress.scene.title));
        }
        Ok(())
    }

    fn do_step(&mut self, time: f64, step: f64, _log: &Logger) -> Result<(), Failure> {
        let clock = Instant::now();
        let result = self.advance(time, step);
        self.seconds += clock.elapsed().as_secs_f64();
        result
    }

    fn terminate(&mut self, _log: &Logger) -> Result<(), Failure> {
        let (Some(runtime), Some(progress)) = (&mut self.runtime, &self.state.progress) else { return Ok(()) };
        let time = progress.state.time;
        let Some(number) = runtime.series.as_ref().and_then(|series| series.due_at_end(time)) else { return Ok(()) };
        let frame = runtime.frame(&progress.state.motion);
        write_frame(&mut runtime.series, number, time, frame)
    }

    fn save(&self) -> State {
        self.state.clone()
    }

    fn check(&self, state: &State) -> Result<(), Failure> {
        state.check()?;
        let Some(progress) = &state.progress else { return Ok(()) };
        let refuse = |error: &dyn std::fmt::Display| Failure::refused(error.to_string());
        progress.scene.validate(&state.parameters.common.scene).map_err(|error| refuse(&error))?;
        match self.runtime.as_ref().filter(|runtime| runtime.fits(&progress.scene)) {
            Some(runtime) => progress.check(runtime),
            None => {
                let runtime = Runtime::new(Arc::clone(&progress.scene), self.modes, None);
                progress.check(&runtime.map_err(|error| refuse(&error))?)
            }
        }
    }

    fn accept(&self, state: &State) -> Result<(), Failure> {
        let (Some(runtime), Some(progress)) = (&self.runtime, &state.progress) else { return Ok(()) };
        same_model(&runtime.scene, &progress.scene)
    }

    fn restore(&mut self, state: &State) -> Result<(), Failure> {
        let common = state.parameters.common.restored(&self.state.parameters.common);
        let parameters = Parameters { common, ..state.parameters.clone() };
        match &state.progress {
            None => self.runtime = None,
            Some(progress) => {
                let same_output = self.state.parameters.common.same_output(&parameters.common);
                let kept = self.runtime.as_ref().filter(|runtime| runtime.fits(&progress.scene));
                if kept.is_none() || !same_output {
                    let scene = Arc::clone(kept.map_or(&progress.scene, |runtime| &runtime.scene));
                    let fresh = parameters.common.series(&scene, FIELD, progress.start);
                    let runtime = fresh.and_then(|series| Runtime::new(scene, self.modes, series));
                    self.runtime = Some(runtime.map_err(|error| Failure::broken(error.to_string()))?);
                }
            }
        }
        let series = self.runtime.as_mut().and_then(|runtime| runtime.series.as_mut());
        if let (Some(series), Some(progress)) = (series, &state.progress) {
            series.resume(progress.state.time).map_err(|error| Failure::broken(error.to_string()))?;
        }
        self.state.clone_from(state);
        self.state.parameters = parameters;
        if let (Some(runtime), Some(progress)) = (&self.runtime, &mut self.state.progress) {
            progress.scene = Arc::clone(&runtime.scene);
        }
        Ok(())
    }

    fn derivatives(&mut self, unknowns: &[Reference], knowns: &[Reference]) -> Result<Vec<f64>, Failure> {
        let (Some(runtime), Some(progress)) = (&self.runtime, &self.state.progress) else {
            return Err(not_initialised());
        };
        let Some(last) = &progress.last else {
            return Err(Failure::refused("directional derivatives belong to a step, and none was done yet"));
        };
        let sensitivity = runtime
            .solver
            .sensitivity(&last.before, &progress.state, &last.load, last.duration)
            .map_err(|error| Failure::refused(error.to_string()))?;
        let sensitivity = match &last.added {
            None => sensitivity,
            Some(added) => sensitivity
                .with_added_mass(added, last.duration)
                .ok_or_else(|| Failure::refused("the added mass is no positive matrix: the step has no derivative"))?,
        };
        let entry = |unknown: Reference, known: Reference| -> f64 {
            let (Some((family, row)), Some((LOAD, column))) = (coordinate(unknown), coordinate(known)) else {
                return 0.0;
            };
            let matrix = match family {
                POSITION => &sensitivity.position,
                VELOCITY => &sensitivity.velocity,
                ACCELERATION => &sensitivity.acceleration,
                _ => return 0.0,
            };
            // Coordinates that the scene does not have answer to nothing.
            matrix.get((row, column)).copied().unwrap_or(0.0)
        };
        if let Some(&other) = unknowns.iter().find(|&&unknown| coordinate(unknown).is_none()) {
            return Err(Failure::refused(format!(
                "directional derivatives are given of the motion only, not of the value reference {other}"
            )));
        }
        Ok(unknowns
            .iter()
            .flat_map(|&unknown| knowns.iter().map(move |&known| (unknown, known)))
            .map(|(unknown, known)| entry(unknown, known))
            .collect())
    }
}
