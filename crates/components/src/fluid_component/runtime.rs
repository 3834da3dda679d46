//! What follows from the scene and needs no saving: solver, scratch, field frames.

use super::instruments;
use crate::interface::Matching;
use crate::parameters::{SceneParameters, same_model};
use crate::{Error, Interface, conversion};
use digits::six;
use fmi::Failure;
use frames::{Field, Frame, Series, single, write_frame};
use kinematics::Motion;
use nalgebra::Vector2;
use scene::Scene;
use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

pub(super) struct Runtime {
    scene: Arc<Scene>,
    pub(super) solver: fluid::Solver,
    /// Where the variables of the FMU are in the scene.
    pub(super) matching: Matching,
    /// In a cell: figures are computed when they are read, and what they need serves the next step.
    pub(super) workspace: RefCell<fluid::Workspace>,
    /// Motion of the bodies at the end of a step.
    pub(super) end: Motion,
    series: Option<Series>,
    /// What is odd about the scene, and does not hinder a run.
    pub(super) warnings: Vec<String>,
}

impl Runtime {
    pub(super) fn new(
        scene: Arc<Scene>,
        interface: &Interface,
        parameters: &SceneParameters,
        start: f64,
    ) -> Result<Self, Error> {
        let matching = Matching::new(interface, &Interface::of(&scene))?;
        let SetUp { solver, walls, warnings } = solver(&scene)?;
        let series = parameters.series(&scene, "particles", start)?;
        if series.is_some() {
            write_frame(&Path::new(&parameters.output_directory).join("walls.vtu"), outline(&walls))?;
        }
        let (workspace, end) = (RefCell::new(solver.workspace()), solver.at_rest());
        Ok(Self { workspace, end, solver, matching, series, warnings, scene })
    }

    /// The scene that this was made for.
    pub(super) fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Whether this was made for a scene that is the same to the water.
    pub(super) fn fits(&self, scene: &Arc<Scene>) -> bool {
        same_model(&self.scene, scene).is_ok()
    }

    /// Takes the motion of the bodies at the end of a step from the variables of the FMU.
    pub(super) fn take(&mut self, motion: &Motion) {
        let Self { matching, end, .. } = self;
        for (own, of_scene) in matching.pairs() {
            end.position[of_scene] = motion.position[own];
            end.velocity[of_scene] = motion.velocity[own];
            end.acceleration[of_scene] = motion.acceleration[own];
        }
    }

    /// Takes up the frames of an earlier process that a state at `time` follows.
    pub(super) fn resume(&mut self, time: f64) -> Result<(), Failure> {
        let Some(series) = &mut self.series else { return Ok(()) };
        series.resume(time).map_err(|error| Failure::broken(error.to_string()))
    }

    /// Writes the frame that is due at the start of a step; adds the seconds that it took.
    pub(super) fn write_due(&mut self, state: &fluid::State, time: f64, seconds: &mut f64) -> Result<(), Failure> {
        let number = self.series.as_ref().and_then(|series| series.due(time));
        self.write(number, state, time, seconds)
    }

    /// Writes the last frame.
    pub(super) fn write_last(&mut self, state: &fluid::State, seconds: &mut f64) -> Result<(), Failure> {
        let number = self.series.as_ref().and_then(|series| series.due_at_end(state.time));
        self.write(number, state, state.time, seconds)
    }

    fn write(
        &mut self,
        number: Option<u64>,
        state: &fluid::State,
        time: f64,
        seconds: &mut f64,
    ) -> Result<(), Failure> {
        let (Some(number), Some(series)) = (number, &mut self.series) else { return Ok(()) };
        let clock = Instant::now();
        let result = series.write(number, time, particles(state));
        *seconds += clock.elapsed().as_secs_f64();
        result.map_err(|error| Failure::broken(error.to_string()))
    }
}

/// Refuses a state with far fewer particles than its scene asks for, before a solver is made for so many.
pub(super) fn check_count(scene: &Scene, state: &fluid::State) -> Result<(), Failure> {
    let Some(fluid) = &scene.fluid else { return Ok(()) };
    let area: f64 = fluid.water.iter().map(scene::Polygon::area).sum();
    let (expected, count) = (area / fluid.spacing.powi(2), state.positions.len());
    if expected <= 1000.0 + 2.0 * count.saturating_add(state.lost) as f64 {
        return Ok(());
    }
    let lost = state.lost;
    Err(Failure::refused(format!("{count} particles and {lost} lost ones: expected about {expected:.0} in {area} m2")))
}

/// What a scene became.
pub(super) struct SetUp {
    pub(super) solver: fluid::Solver,
    /// Fixed walls, corner by corner.
    walls: Vec<Vec<Vector2<f64>>>,
    /// What is odd about the scene, and does not hinder a run.
    pub(super) warnings: Vec<String>,
}

/// The solver of a scene.
pub(super) fn solver(scene: &Scene) -> Result<SetUp, Error> {
    crate::memory::check_water(scene)?;
    let (numbers, geometry) = conversion::fluid(scene)?;
    let walls = geometry.fixed_walls.clone();
    let solver = fluid::Solver::new(numbers, geometry)?;
    let warnings = [instruments::judge(scene, &solver)?, closed_gaps(&solver)].concat();
    Ok(SetUp { solver, walls, warnings })
}

/// What is said of gaps that the solver takes for closed.
fn closed_gaps(solver: &fluid::Solver) -> Vec<String> {
    let told = |(corner, width): (Vector2<f64>, f64)| {
        let (x, y, width, spacing) = (six(corner.x), six(corner.y), six(width), six(solver.effective_spacing()));
        format!(
            "the gap of {width} m at ({x}, {y}) is too narrow for particles of {spacing} m and counts as closed; \
             lower fluid.spacing to {width} m to let water through",
        )
    };
    solver.closed_gaps().map(told).collect()
}

fn particles(state: &fluid::State) -> Frame {
    let numbers = |values: &[f64]| values.iter().map(|&value| value as f32).collect();
    Frame {
        points: state.positions.iter().map(single).collect(),
        lines: Vec::new(),
        fields: vec![
            Field::Scalar("pressure", numbers(&state.pressures)),
            Field::Vector("velocity", state.velocities.iter().map(single).collect()),
            Field::Scalar("number_density", numbers(&state.number_densities)),
            Field::Flag("surface", state.surface.iter().map(|&surface| u8::from(surface)).collect()),
        ],
    }
}

fn outline(walls: &[Vec<Vector2<f64>>]) -> Frame {
    let mut frame = Frame::default();
    for wall in walls {
        let first = frame.points.len() as u64;
        frame.points.extend(wall.iter().map(single));
        frame.lines.extend((1..wall.len() as u64).map(|next| [first + next - 1, first + next]));
    }
    frame
}
