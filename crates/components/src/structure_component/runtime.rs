//! What the structure of a scene needs beside its state.

use super::Outputs;
use crate::interface::Matching;
use crate::parameters::same_model;
use crate::{Error, Interface, conversion};
use frames::{Field, Frame, Series, single};
use kinematics::{Beam, BodySet, Motion, SurfacePoint};
use scene::Scene;
use std::sync::Arc;

impl Outputs {
    /// All zero.
    pub(super) fn new(interface: &Interface) -> Self {
        Self {
            motion: Motion::zeros(interface.layout().size()),
            deflections: vec![[0.0; 2]; interface.members().count()],
            kinetic: 0.0,
            potential: 0.0,
            momentum: [0.0; 2],
            unknowns: 0,
            iterations: 0,
        }
    }
}

/// What follows from the scene and needs no saving.
pub(super) struct Runtime {
    pub(super) scene: Arc<Scene>,
    pub(super) bodies: BodySet,
    /// Where the variables of the FMU are in the scene.
    pub(super) matching: Matching,
    pub(super) solver: structure::Solver,
    pub(super) workspace: structure::Workspace,
    pub(super) series: Option<Series>,
}

impl Runtime {
    pub(super) fn new(scene: Arc<Scene>, interface: &Interface, series: Option<Series>) -> Result<Self, Error> {
        let matching = Matching::new(interface, &Interface::of(&scene).of_bodies())?;
        let solver = structure::Solver::new(conversion::structure(&scene)?)?;
        let bodies = conversion::bodies(&scene)?;
        Ok(Self { bodies, matching, workspace: solver.workspace(), solver, series, scene })
    }

    /// Whether this was made for a scene that is the same to the structure.
    pub(super) fn fits(&self, scene: &Arc<Scene>) -> bool {
        same_model(&self.scene, scene).is_ok()
    }

    /// Mean load of the step: what the fluid gives, and the constant load of the scene.
    pub(super) fn load(&self, input: &[f64]) -> Vec<f64> {
        let layout = self.bodies.layout();
        let mut load = vec![0.0; layout.size()];
        self.matching.pairs().for_each(|(own, of_scene)| load[of_scene] = input[own]);
        let mut add = |own: std::ops::Range<usize>, constant: &[f64]| {
            load[own].iter_mut().zip(constant).for_each(|(load, constant)| *load += constant);
        };
        for (index, body) in self.scene.body.iter().enumerate() {
            add(layout.rigid(index), &body.constant_load);
            for (member, part) in body.member.iter().enumerate() {
                add(layout.member(index, member), &part.constant_load);
            }
        }
        load
    }

    pub(super) fn write_outputs(&self, state: &structure::State, report: &structure::Report, outputs: &mut Outputs) {
        for (own, of_scene) in self.matching.pairs() {
            outputs.motion.position[own] = state.motion.position[of_scene];
            outputs.motion.velocity[own] = state.motion.velocity[of_scene];
            outputs.motion.acceleration[own] = state.motion.acceleration[of_scene];
        }
        for (deflections, of_scene) in outputs.deflections.iter_mut().zip(&self.matching.members) {
            let Some((body, member, length)) = of_scene.and_then(|index| self.members().nth(index)) else { continue };
            // The solver's eta is positive along -x of the body.
            *deflections = [0.5 * length, length].map(|station| -self.solver.deflection(state, body, member, station));
        }
        outputs.kinetic = self.solver.kinetic_energy(state);
        outputs.potential = self.solver.potential_energy(state);
        outputs.momentum = self.solver.linear_momentum(state).into();
        outputs.unknowns = i32::try_from(report.unknowns).unwrap_or(i32::MAX);
        outputs.iterations = i32::try_from(report.iterations).unwrap_or(i32::MAX);
    }

    /// Body, index there, and length of each member.
    fn members(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let bodies = self.bodies.bodies().iter().enumerate();
        bodies.flat_map(|(body, shape)| {
            shape.members.iter().enumerate().map(move |(member, beam)| (body, member, beam.modes.length()))
        })
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
