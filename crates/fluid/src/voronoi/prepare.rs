//! What an internal step needs that depends on the state alone.

use super::added_mass::{MovingFacet, Responses};
use super::cells::{Cells, Setup};
use super::source::Asked;
use super::{operators, step};
use crate::matrix::Matrix;
use crate::motion::foretell;
use crate::multigrid::Multigrid;
use crate::panel_motion::PanelMotion;
use crate::parallel::{self, Lists};
use crate::parameters::AccurateParameters;
use crate::particles::{self, Contact};
use crate::prepare::{Pace, Setting};
use crate::report::{StageTimes, Watch};
use crate::state::State;
use crate::walls::{Attachment, FIXED, Walls};
use kinematics::Motion;
use nalgebra::{DVector, Matrix2, Vector2};

/// Everything prepared for one internal step.
#[derive(Debug, Clone)]
pub struct Prepared {
    key: Option<(u64, u64)>,
    partial: Vec<u64>,
    /// Time in the middle of the step \[s\].
    pub time: f64,
    /// Foretold motion of the body in the middle of the step, where its walls stand during it, as the particles do: the
    /// load on the walls is then that of the middle of the step over which it is held. A load of the start would feed
    /// every oscillation of frequency w with a negative damping of w^2 dt / 4.
    pub middle: Motion,
    /// Walls at those coordinates.
    pub walls: Walls,
    walls_placed: bool,
    panels: PanelMotion,
    /// Particles stopped at walls on the way to the middle of the step.
    pub contacts: usize,
    /// Positions in the middle of the step \[m\].
    pub positions: Vec<Vector2<f64>>,
    /// Velocities at the start of the step, of particles that the walls let pass \[m/s\].
    pub before: Vec<Vector2<f64>>,
    /// Rates of the body's coordinates at the start of the step.
    pub rates: DVector<f64>,
    /// Mean accelerations of the body's coordinates over the step.
    pub accelerations: DVector<f64>,
    /// Walls near each particle.
    pub attachments: Lists<Attachment>,
    /// Cells in the middle of the step.
    pub cells: Cells,
    /// Body force of each particle \[m/s2\].
    pub forces: Vec<Vector2<f64>>,
    /// Predicted velocities u* \[m/s\].
    pub velocities: Vec<Vector2<f64>>,
    smoothed: Vec<Vector2<f64>>,
    /// Gradients of the predicted velocity \[1/s\].
    pub gradients: Vec<Matrix2<f64>>,
    /// What the areas of cells ask for in this step.
    pub(super) asked: Vec<Asked>,
    /// Right side without the accelerations of moving walls \[Pa\].
    pub source: Vec<f64>,
    /// Matrix of the pressure.
    pub matrix: Matrix,
    /// Preconditioner.
    pub multigrid: Multigrid,
    /// Facets on moving walls, and what the water answers to their acceleration.
    pub responses: Responses,
    /// Pressure with the body accelerating as at the end of the last step \[Pa\].
    pub base: Vec<f64>,
}

impl Default for Prepared {
    fn default() -> Self {
        Self {
            key: None,
            partial: Vec::new(),
            time: 0.0,
            middle: Motion::at_rest(0),
            walls: Walls::default(),
            walls_placed: false,
            panels: PanelMotion::default(),
            contacts: 0,
            positions: Vec::new(),
            before: Vec::new(),
            rates: DVector::zeros(0),
            accelerations: DVector::zeros(0),
            attachments: Lists::default(),
            cells: Cells::default(),
            forces: Vec::new(),
            velocities: Vec::new(),
            smoothed: Vec::new(),
            gradients: Vec::new(),
            asked: Vec::new(),
            source: Vec::new(),
            matrix: Matrix::default(),
            multigrid: Multigrid::default(),
            responses: Responses::default(),
            base: Vec::new(),
        }
    }
}

impl Prepared {
    /// Prepares the step from `state`; returns false when the workspace held it already.
    pub fn update(
        &mut self,
        setting: &Setting,
        accurate: &AccurateParameters,
        state: &State,
        pace: Pace,
        stages: &mut StageTimes,
    ) -> bool {
        let mut watch = Watch::start();
        let fingerprint = state.fingerprint(&mut self.partial);
        let key = Some((fingerprint, pace.time_step.to_bits()));
        if self.key == key {
            return false;
        }
        self.key = None;
        self.find_geometry(setting, state, pace);
        watch.lap(&mut stages.neighbours);
        self.assemble(setting, accurate, state, pace);
        self.key = key;
        watch.lap(&mut stages.assembly);
        true
    }

    /// Particles, walls, cells and facets on moving walls in the middle of the step.
    fn find_geometry(&mut self, setting: &Setting, state: &State, pace: Pace) {
        let half = 0.5 * pace.time_step;
        self.time = state.time + half;
        foretell(&state.motion, half, &mut self.middle);
        kinematics::copy(&state.motion.velocity, &mut self.rates);
        self.drift(setting, state, half);
        self.build_cells(setting, state);
        if let Some(body) = &setting.geometry.body {
            self.responses.collect(&self.cells, &setting.layout, body, &self.middle.position);
        }
    }

    /// The same, whatever is there already.
    pub fn make_cells(&mut self, setting: &Setting, state: &State, pace: Pace) {
        self.key = None;
        self.find_geometry(setting, state, pace);
    }

    /// Predicted velocities, right side, matrix and preconditioner.
    pub fn assemble(&mut self, setting: &Setting, accurate: &AccurateParameters, state: &State, pace: Pace) {
        self.predict(setting, pace.time_step);
        self.smooth(accurate, pace.time_step);
        self.ask(accurate, state, pace);
        self.build_source(setting, pace.time_step);
        self.matrix.assemble_cells(&self.cells, &state.volumes);
        self.multigrid.set_up(&self.matrix, &self.positions, setting.spacing, setting.spacing * setting.spacing);
    }

    /// Brings the particles to the middle of the step, in front of the walls as they stand there.
    fn drift(&mut self, setting: &Setting, state: &State, half: f64) {
        self.place_walls(setting);
        self.positions.clone_from(&state.positions);
        self.before.clone_from(&state.velocities);
        step::drift(&mut self.positions, &self.before, half);
        self.attach();
        if let Some(body) = &setting.geometry.body {
            self.panels.set_start(&setting.layout.panels, body, &self.middle);
        }
        let panels = &self.panels;
        let moved = (&mut self.positions[..], &mut self.before[..]);
        let contact = Contact::inelastic(setting.spacing);
        self.contacts = particles::stop_at_walls(moved, &self.attachments, &self.walls, &contact, |panel, fraction| {
            panels.velocity(panel, fraction)
        });
        if self.contacts > 0 {
            self.attach();
        }
    }

    fn attach(&mut self) {
        let (walls, positions) = (&self.walls, &self.positions);
        self.attachments.build(positions.len(), |i, out| walls.attach(&positions[i], out));
    }

    fn build_cells(&mut self, setting: &Setting, state: &State) {
        self.cells.build(&Setup {
            positions: &self.positions,
            volumes: &state.volumes,
            attachments: &self.attachments,
            walls: &self.walls,
            spacing: setting.spacing,
        });
    }

    /// Cells of a state, for looking at them; what was prepared for a step is lost.
    pub fn cells_of(&mut self, setting: &Setting, state: &State) -> &Cells {
        self.key = None;
        self.middle.clone_from(&state.motion);
        self.place_walls(setting);
        self.positions.clone_from(&state.positions);
        self.attach();
        self.build_cells(setting, state);
        &self.cells
    }

    /// Walls with the body as in the middle of the step.
    fn place_walls(&mut self, setting: &Setting) {
        let body = setting.geometry.body.as_ref();
        if body.is_some() || !self.walls_placed {
            let at = body.map(|body| (body, &self.middle.position));
            self.walls.place(&setting.layout, at, 2.0 * Cells::reach(setting.spacing), setting.spacing);
            self.walls_placed = true;
        }
    }

    /// u* = u + f dt, and its gradient.
    fn predict(&mut self, setting: &Setting, time_step: f64) {
        let count = self.positions.len();
        self.forces.resize(count, Vector2::zeros());
        self.velocities.resize(count, Vector2::zeros());
        self.gradients.resize(count, Matrix2::zeros());
        let (positions, before) = (&self.positions, &self.before);
        parallel::fill(&mut self.forces, |i| setting.parameters.body_force(&positions[i], self.time));
        let forces = &self.forces;
        parallel::fill(&mut self.velocities, |i| before[i] + forces[i] * time_step);
        let (cells, velocities) = (&self.cells, &self.velocities);
        parallel::fill(&mut self.gradients, |i| {
            let gradient = operators::velocity_gradient(cells, i, positions, velocities);
            gradient * (STEEPEST / (gradient.norm() * time_step).max(STEEPEST))
        });
    }

    /// Takes out of u* what its neighbours' linear fields do not explain: noise of the wave length of a cell. A linear
    /// field stays as it is, a potential flow nearly, and the momentum exactly.
    fn smooth(&mut self, accurate: &AccurateParameters, time_step: f64) {
        if accurate.smoothing == 0.0 {
            return;
        }
        let (cells, velocities, gradients, positions) =
            (&self.cells, &self.velocities, &self.gradients, &self.positions);
        let strength = 0.25 * accurate.smoothing * time_step;
        let mut smoothed = std::mem::take(&mut self.smoothed);
        smoothed.resize(velocities.len(), Vector2::zeros());
        parallel::fill(&mut smoothed, |i| {
            let mut change = Vector2::zeros();
            for facet in cells.facets.of(i) {
                let j = facet.neighbour as usize;
                let mean = (gradients[i] + gradients[j]) * 0.5;
                let away = positions[j] - positions[i];
                let unexplained = velocities[j] - velocities[i] - mean * away;
                let rate = (strength * mean.norm()).min(0.05);
                change += unexplained * (facet.weight().min(2.0) * rate);
            }
            velocities[i] + change
        });
        std::mem::swap(&mut self.velocities, &mut smoothed);
        self.smoothed = smoothed;
    }

    /// Sum over the wall facets of cell i of their pressure slope times length and arm: what walls add to G p \[N/m\].
    pub fn wall_difference(&self, setting: &Setting, i: usize) -> Vector2<f64> {
        if self.cells.is_lone(i) {
            return Vector2::zeros();
        }
        let force = self.forces[i] * setting.parameters.density;
        let fixed = self.cells.walls.of(i).iter().filter(|wall| wall.panel == FIXED);
        let fixed = fixed.map(|wall| wall.facet.middle() * (wall.facet.length() * force.dot(&wall.facet.normal)));
        let moving = self.responses.of(i).map(|(moving, work)| {
            let facet = &moving.wall.facet;
            facet.middle() * (facet.length() * self.wall_slope(setting, moving, work))
        });
        fixed.sum::<Vector2<f64>>() + moving.sum::<Vector2<f64>>()
    }

    /// Normal pressure gradient on a moving facet \[Pa/m\], with the wall's mean acceleration over the step.
    pub fn wall_slope(&self, setting: &Setting, moving: &MovingFacet, work: &[f64]) -> f64 {
        let acceleration = Responses::normal_rate(work, &self.accelerations);
        let force = self.forces[moving.particle as usize].dot(&moving.wall.facet.normal);
        setting.parameters.density * (force - acceleration)
    }

    /// The part of the right side that the accelerations of walls add for particle i \[Pa\].
    pub fn wall_source(&self, setting: &Setting, i: usize) -> f64 {
        let of = |(moving, work): (&MovingFacet, &[f64])| {
            let acceleration = Responses::normal_rate(work, &self.accelerations);
            -setting.parameters.density * moving.wall.facet.length() * acceleration
        };
        self.responses.of(i).map(of).sum()
    }
}

/// Largest norm of a velocity gradient times the step. The Courant number keeps flows below; a pair of particles that
/// nearly touch in a splash exceeds it many times, and would throw them out.
const STEEPEST: f64 = 0.3;
