//! What the structure of a scene needs beside its state.

use super::Outputs;
use crate::interface::{COORDINATES, MotionValues};
use crate::parameters::same_model;
use crate::{Error, conversion};
use frames::{Field, Frame, Series, single};
use kinematics::{Beam, BodySet, Motion, SurfacePoint};
use scene::Scene;
use std::sync::Arc;

/// What follows from the scene and needs no saving.
pub(super) struct Runtime {
    pub(super) scene: Arc<Scene>,
    pub(super) bodies: BodySet,
    pub(super) solver: structure::Solver,
    pub(super) workspace: structure::Workspace,
    pub(super) series: Option<Series>,
}

impl Runtime {
    pub(super) fn new(scene: Arc<Scene>, limit: usize, series: Option<Series>) -> Result<Self, Error> {
        let modes = scene.modes();
        if modes > limit {
            let hint = "; pack the FMU with more modes or lower structure.beam.modes";
            return Err(Error::TooMany { what: "modes of the beam", got: modes, limit, hint });
        }
        let solver = structure::Solver::new(conversion::structure(&scene)?)?;
        let bodies = conversion::bodies(&scene)?;
        Ok(Self { bodies, workspace: solver.workspace(), solver, series, scene })
    }

    /// Whether this was made for a scene that is the same to the structure.
    pub(super) fn fits(&self, scene: &Arc<Scene>) -> bool {
        same_model(&self.scene, scene).is_ok()
    }

    /// Mean load of the step: what the fluid gives, and the constant load of the scene.
    pub(super) fn load(&self, input: &[f64; COORDINATES]) -> Vec<f64> {
        let mut load = input[..self.bodies.layout().size()].to_vec();
        let constant = self.scene.structure.as_ref().map_or(&[][..], |structure| &structure.constant_load);
        load.iter_mut().zip(constant).for_each(|(load, constant)| *load += constant);
        load
    }

    pub(super) fn outputs(&self, state: &structure::State, report: &structure::Report) -> Outputs {
        let length = self.bodies.bodies()[0].members.first().map_or(0.0, |beam| beam.modes.length());
        // The solver's eta is positive along -x of the body.
        let deflection = |station: f64| -self.solver.deflection(state, 0, 0, station);
        Outputs {
            motion: MotionValues::from_motion(&state.motion),
            middle: deflection(0.5 * length),
            tip: deflection(length),
            kinetic: self.solver.kinetic_energy(state),
            potential: self.solver.potential_energy(state),
            momentum: self.solver.linear_momentum(state).into(),
            unknowns: i32::try_from(report.unknowns).unwrap_or(i32::MAX),
            iterations: i32::try_from(report.iterations).unwrap_or(i32::MAX),
        }
    }

    /// The outline as it stands, with its displacement from the scene's pose.
    pub(super) fn frame(&self, motion: &Motion) -> Frame {
        let rest = self.bodies.at_rest();
        let (mut frame, mut displacement) = (Frame::default(), Vec::new());
        for (body, panel) in self.bodies.panels(self.longest_panel()) {
            let first = frame.points.len() as u64;
            frame.lines.push([first, first + 1]);
            for at in panel.ends.map(|point| SurfacePoint { body, point }) {
                let place = self.bodies.position(at, motion);
                frame.points.push(single(&place));
                displacement.push(single(&(place - self.bodies.position(at, &rest))));
            }
        }
        frame.fields.push(Field::Vector("displacement", displacement));
        frame
    }

    /// Panels of a beam are fine enough to show it bent; a long wall beside a thin beam is not cut into more than 1e5.
    pub(super) fn longest_panel(&self) -> f64 {
        let bodies = self.bodies.bodies();
        let pieces = bodies.iter().flat_map(|body| &body.walls).flat_map(|wall| wall.windows(2));
        let walls: f64 = pieces.map(|pair| (pair[1] - pair[0]).norm()).sum();
        let fine = |beam: &Beam| (0.25 * beam.thickness).max(beam.modes.length() / 100.0).max(1e-5 * walls);
        bodies.iter().flat_map(|body| &body.members).map(fine).fold(f64::INFINITY, f64::min)
    }
}
