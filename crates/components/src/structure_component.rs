//! The structure: rigid bodies with flexible members, driven by the load of a fluid.

mod check;
mod runtime;
mod table;

use crate::interface::{Matching, coordinate};
use crate::parameters::{HasSceneParameters, SceneParameters, same_model};
use crate::{ACCELERATION, Error, Interface, LOAD, POSITION, VELOCITY, conversion};
use fmi::{Component, Experiment, Failure, Logger, Model, Reference, Setup};
use frames::{Frame, Line, Series};
use kinematics::Motion;
use nalgebra::{DMatrix, DVector};
use runtime::Runtime;
use scene::{Scene, identifier};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use structure::AddedMass;

/// Name of the series of field frames.
const FIELD: &str = "structure";

/// Parameters of the FMU; zeros and empty texts mean "as the scene says".
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Parameters {
    common: SceneParameters,
    /// Of each member of the interface.
    youngs_moduli: Vec<f64>,
}

/// Values of the outputs at a communication point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Outputs {
    /// As many coordinates as the interface has.
    motion: Motion,
    /// Of the middle and the tip of each member of the interface.
    deflections: Vec<[f64; 2]>,
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
    /// One for each coordinate of the interface, as the accelerations below.
    load: Vec<f64>,
    load_acceleration: Vec<f64>,
    /// Row after row.
    added_mass: Vec<f64>,
    outputs: Outputs,
    progress: Option<Progress>,
}

/// The structure as a component.
pub struct StructureComponent {
    interface: Interface,
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
    if scene.body.is_empty() {
        return Ok((0, Vec::new()));
    }
    let runtime = Runtime::new(Arc::new(scene.clone()), &Interface::of(scene), None)?;
    let frame = runtime.frame(&runtime.bodies.at_rest());
    let lines = frame.lines.iter().map(|ends| ends.map(|end| frame.points[end as usize])).collect();
    Ok((scene.body.iter().map(|body| body.free.len() + body.modes()).sum(), lines))
}

impl StructureComponent {
    fn resolve_scene(&self) -> Result<Scene, Error> {
        let parameters = &self.state.parameters;
        let mut scene = parameters.common.find_scene(self.resources.as_deref())?;
        let names = self.interface.members().map(|(body, member)| (&body.name, &member.name));
        let given = names.zip(&parameters.youngs_moduli).filter(|(_, modulus)| **modulus > 0.0);
        for ((body, member), &modulus) in given {
            let bodies = scene.body.iter_mut().filter(|known| identifier(&known.name) == *body);
            let mut members = bodies.flat_map(|body| &mut body.member);
            let Some(known) = members.find(|known| identifier(&known.name) == *member) else {
                return Err(Error::Value {
                    key: format!("body.{body}.{member}.youngs_modulus"),
                    got: modulus.to_string(),
                    expected: "0: the scene has no such member".to_string(),
                });
            };
            known.youngs_modulus = modulus;
        }
        scene.validate(&parameters.common.scene)?;
        Ok(scene)
    }

    /// Sets an entry of the added mass, and the one across the diagonal.
    fn set_added_mass(&mut self, index: usize, value: f64) {
        let size = self.state.load.len();
        let (row, column) = (index / size, index % size);
        self.state.added_mass[row * size + column] = value;
        self.state.added_mass[column * size + row] = value;
    }

    fn prepare(&mut self, start: f64) -> Result<(), Error> {
        let scene = Arc::new(self.resolve_scene()?);
        let series = self.state.parameters.common.series(&scene, FIELD, start)?;
        let runtime = Runtime::new(Arc::clone(&scene), &self.interface, series)?;
        let mut state = runtime.solver.initial_state(&conversion::initial_modes(&scene))?;
        state.time = start;
        runtime.write_outputs(&state, &structure::Report::default(), &mut self.state.outputs);
        self.state.progress = Some(Progress { scene, start, state, last: None });
        self.runtime = Some(runtime);
        Ok(())
    }

    fn advance(&mut self, time: f64, step: f64) -> Result<(), Failure> {
        let State { progress, outputs, load, load_acceleration, added_mass, .. } = &mut self.state;
        let (Some(runtime), Some(progress)) = (&mut self.runtime, progress) else {
            return Err(not_initialised());
        };
        if let Some(number) = runtime.series.as_ref().and_then(|series| series.due(time)) {
            let frame = runtime.frame(&progress.state.motion);
            write_frame(&mut runtime.series, number, time, frame)?;
        }
        let load = runtime.load(load);
        let added = in_the_scene(added_mass, load_acceleration, &runtime.matching);
        let mut state = progress.state.clone();
        state.time = time;
        let solver = &runtime.solver;
        let result = match &added {
            None => solver.step(&mut state, &load, step, &mut runtime.workspace).map(|report| (report, load)),
            Some(added) => solver.step_with_added_mass(&mut state, &load, added, step, &mut runtime.workspace),
        };
        let (report, load) = result.map_err(|error| Failure::discard(error.to_string()))?;
        state.time = time + step;
        runtime.write_outputs(&state, &report, outputs);
        let before = std::mem::replace(&mut progress.state, state);
        progress.last = Some(LastStep { before, load, added, duration: step });
        Ok(())
    }
}

/// What the fluid answers to accelerations, in the coordinates of the scene; none where no added mass is connected.
fn in_the_scene(added_mass: &[f64], acceleration: &[f64], matching: &Matching) -> Option<AddedMass> {
    if added_mass.iter().all(|&entry| entry == 0.0) {
        return None;
    }
    let (all, size) = (acceleration.len(), matching.pairs().count());
    let mut added = AddedMass { matrix: DMatrix::zeros(size, size), acceleration: DVector::zeros(size) };
    for (own, row) in matching.pairs() {
        added.acceleration[row] = acceleration[own];
        for (other, column) in matching.pairs() {
            added.matrix[(row, column)] = added_mass[own * all + other];
        }
    }
    Some(added)
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

    type Interface = Interface;

    fn interface(resources: Option<&Path>) -> Result<Interface, Failure> {
        Interface::of_resources(resources).map_err(|error| Failure::refused(error.to_string()))
    }

    fn model(interface: &Interface) -> Model<Self> {
        table::model(interface)
    }

    fn new(setup: &Setup<Interface>) -> Self {
        let (size, members) = (setup.interface.layout().size(), setup.interface.members().count());
        let parameters = Parameters { youngs_moduli: vec![0.0; members], ..Parameters::default() };
        let state = State {
            parameters,
            load: vec![0.0; size],
            load_acceleration: vec![0.0; size],
            added_mass: vec![0.0; size * size],
            outputs: Outputs::new(&setup.interface),
            progress: None,
        };
        Self {
            interface: setup.interface.clone(),
            resources: setup.resources.clone(),
            state,
            runtime: None,
            seconds: 0.0,
        }
    }

    fn initialise(&mut self, experiment: &Experiment, log: &Logger) -> Result<(), Failure> {
        let result = self.prepare(experiment.start);
        let wrong = |error: Error| error.in_scene(&self.state.parameters.common.scene_file());
        result.map_err(|error| Failure::broken(wrong(error).to_string()))?;
        if let Some(progress) = &self.state.progress {
            let bodies = progress.scene.body.len();
            log.event(&format!("structure of '{}' with {bodies} bodies is ready", progress.scene.title));
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
        state.check(&self.interface)?;
        let Some(progress) = &state.progress else { return Ok(()) };
        let refuse = |error: &dyn std::fmt::Display| Failure::refused(error.to_string());
        progress.scene.validate(&state.parameters.common.scene).map_err(|error| refuse(&error))?;
        match self.runtime.as_ref().filter(|runtime| runtime.fits(&progress.scene)) {
            Some(runtime) => progress.check(runtime),
            None => {
                let runtime = Runtime::new(Arc::clone(&progress.scene), &self.interface, None);
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
                    let runtime = fresh.and_then(|series| Runtime::new(scene, &self.interface, series));
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
        let size = self.state.load.len();
        let entry = |unknown: Reference, known: Reference| -> f64 {
            let (Some((family, row)), Some((LOAD, column))) = (coordinate(unknown, size), coordinate(known, size))
            else {
                return 0.0;
            };
            // Coordinates that the scene does not have answer to nothing.
            let pair = runtime.matching.coordinate(row).zip(runtime.matching.coordinate(column));
            let Some(pair) = pair else { return 0.0 };
            let matrix = match family {
                POSITION => &sensitivity.position,
                VELOCITY => &sensitivity.velocity,
                ACCELERATION => &sensitivity.acceleration,
                _ => return 0.0,
            };
            matrix[pair]
        };
        if let Some(&other) = unknowns.iter().find(|&&unknown| coordinate(unknown, size).is_none()) {
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
