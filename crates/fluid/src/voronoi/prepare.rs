//! What an internal step needs that depends on the state alone.

use super::added_mass::{MovingFacet, Responses};
use super::cells::{Cells, Setup};
use super::operators;
use crate::matrix::Matrix;
use crate::motion::foretell;
use crate::multigrid::Multigrid;
use crate::parallel::{self, Lists};
use crate::parameters::AccurateParameters;
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
    /// State whose cells these are; none with a body, where they depend on the time step too.
    cells_of: Option<u64>,
    /// Time at the start of the step \[s\].
    pub time: f64,
    /// Foretold coordinates of the body in the middle of the step, where its walls stand during it. Positions of
    /// particles belong to the middle of a step as well, velocities to its ends: the load on the walls is then that of
    /// the middle of the step over which it is held. A load of the start would feed every oscillation of frequency w
    /// with a negative damping of w^2 dt / 4.
    pub middle: Motion,
    /// Walls at those coordinates.
    pub walls: Walls,
    walls_placed: bool,
    /// Rates of the body's coordinates at the start of the step.
    pub rates: DVector<f64>,
    /// Mean accelerations of the body's coordinates over the step.
    pub accelerations: DVector<f64>,
    /// Walls near each particle.
    pub attachments: Lists<Attachment>,
    /// Cells at the start of the step.
    pub cells: Cells,
    /// Body force of each particle \[m/s2\].
    pub forces: Vec<Vector2<f64>>,
    /// Predicted velocities u* \[m/s\].
    pub velocities: Vec<Vector2<f64>>,
    smoothed: Vec<Vector2<f64>>,
    /// Gradients of the predicted velocity \[1/s\].
    pub gradients: Vec<Matrix2<f64>>,
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
            cells_of: None,
            time: 0.0,
            middle: Motion::at_rest(0),
            walls: Walls::default(),
            walls_placed: false,
            rates: DVector::zeros(0),
            accelerations: DVector::zeros(0),
            attachments: Lists::default(),
            cells: Cells::default(),
            forces: Vec::new(),
            velocities: Vec::new(),
            smoothed: Vec::new(),
            gradients: Vec::new(),
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
        let key = Some((fingerprint, pace.time_step.to_bits() ^ pace.kick.to_bits().rotate_left(1)));
        if self.key == key {
            return false;
        }
        self.key = None;
        self.find_geometry(setting, state, pace, fingerprint);
        watch.lap(&mut stages.neighbours);
        self.assemble(setting, accurate, state, pace);
        self.key = key;
        watch.lap(&mut stages.assembly);
        true
    }

    /// Walls, cells and facets on moving walls.
    fn find_geometry(&mut self, setting: &Setting, state: &State, pace: Pace, fingerprint: u64) {
        self.time = state.time;
        foretell(&state.motion, 0.5 * pace.time_step, &mut self.middle);
        self.build_cells(setting, state, fingerprint);
        if let Some(body) = &setting.geometry.body {
            self.responses.collect(&self.cells, &setting.layout, body, &self.middle.position);
        }
    }

    /// The same, whatever is there already.
    pub fn make_cells(&mut self, setting: &Setting, state: &State, pace: Pace) {
        (self.key, self.cells_of) = (None, None);
        self.find_geometry(setting, state, pace, 0);
        self.cells_of = None;
    }

    /// Predicted velocities, right side, matrix and preconditioner.
    pub fn assemble(&mut self, setting: &Setting, accurate: &AccurateParameters, state: &State, pace: Pace) {
        self.predict(setting, state, pace);
        self.smooth(accurate, state, pace.time_step);
        self.build_source(setting, accurate, state, pace);
        self.matrix.assemble_cells(&self.cells);
        self.multigrid.set_up(&self.matrix, &state.positions, setting.spacing, setting.spacing * setting.spacing);
    }

    /// Walls and cells of a state; in a scene without a body they may be there already.
    fn build_cells(&mut self, setting: &Setting, state: &State, fingerprint: u64) {
        if self.cells_of == Some(fingerprint) {
            return;
        }
        self.cells_of = None;
        self.place_walls(setting, state);
        let walls = &self.walls;
        self.attachments.build(state.positions.len(), |i, out| walls.attach(&state.positions[i], out));
        self.cells.build(&Setup {
            positions: &state.positions,
            volumes: &state.volumes,
            attachments: &self.attachments,
            walls: &self.walls,
            spacing: setting.spacing,
        });
        if setting.geometry.body.is_none() {
            self.cells_of = Some(fingerprint);
        }
    }

    /// The cells of a state for looking at it, which the next step will find done; none in a scene with a body, whose
    /// walls stand elsewhere during a step.
    pub fn cells_of(&mut self, setting: &Setting, state: &State) -> Option<&Cells> {
        if setting.geometry.body.is_some() {
            return None;
        }
        let fingerprint = state.fingerprint(&mut self.partial);
        if self.cells_of != Some(fingerprint) {
            self.key = None;
        }
        self.build_cells(setting, state, fingerprint);
        Some(&self.cells)
    }

    fn place_walls(&mut self, setting: &Setting, state: &State) {
        let body = setting.geometry.body.as_ref();
        kinematics::copy(&state.motion.velocity, &mut self.rates);
        if body.is_some() || !self.walls_placed {
            let at = body.map(|body| (body, &self.middle.position));
            self.walls.place(&setting.layout, at, 2.0 * Cells::reach(setting.spacing), setting.spacing);
            self.walls_placed = true;
        }
    }

    /// u* = u + f dt, and its gradient.
    fn predict(&mut self, setting: &Setting, state: &State, pace: Pace) {
        let Pace { time_step, kick, .. } = pace;
        let count = state.positions.len();
        self.forces.resize(count, Vector2::zeros());
        self.velocities.resize(count, Vector2::zeros());
        self.gradients.resize(count, Matrix2::zeros());
        parallel::fill(&mut self.forces, |i| setting.parameters.body_force(&state.positions[i], state.time));
        let forces = &self.forces;
        parallel::fill(&mut self.velocities, |i| state.velocities[i] + forces[i] * kick);
        let (cells, velocities) = (&self.cells, &self.velocities);
        parallel::fill(&mut self.gradients, |i| {
            let gradient = operators::velocity_gradient(cells, i, &state.positions, velocities);
            gradient * (STEEPEST / (gradient.norm() * time_step).max(STEEPEST))
        });
    }

    /// Takes out of u* what its neighbours' linear fields do not explain: noise of the wave length of a cell. A linear
    /// field stays as it is, a potential flow nearly, and the momentum exactly.
    fn smooth(&mut self, accurate: &AccurateParameters, state: &State, time_step: f64) {
        if accurate.smoothing == 0.0 {
            return;
        }
        let (cells, velocities, gradients) = (&self.cells, &self.velocities, &self.gradients);
        let strength = 0.25 * accurate.smoothing * time_step;
        let mut smoothed = std::mem::take(&mut self.smoothed);
        smoothed.resize(velocities.len(), Vector2::zeros());
        parallel::fill(&mut smoothed, |i| {
            let mut change = Vector2::zeros();
            for facet in cells.facets.of(i) {
                let j = facet.neighbour as usize;
                let mean = (gradients[i] + gradients[j]) * 0.5;
                let away = state.positions[j] - state.positions[i];
                let unexplained = velocities[j] - velocities[i] - mean * away;
                let rate = (strength * mean.norm()).min(0.05);
                change += unexplained * (facet.weight().min(2.0) * rate);
            }
            velocities[i] + change
        });
        std::mem::swap(&mut self.velocities, &mut smoothed);
        self.smoothed = smoothed;
    }

    /// Right side of A p = b, from the demand that areas are right at the end of the step:
    /// (V - V0) share / dt + D u* + dt V det grad u* = k / rho (-A p) with the time k over which forces act.
    fn build_source(&mut self, setting: &Setting, accurate: &AccurateParameters, state: &State, pace: Pace) {
        let Pace { time_step, kick, .. } = pace;
        let share = accurate.alpha * (time_step / pace.stable_step).min(1.0);
        let density = setting.parameters.density;
        let (cells, velocities, gradients) = (&self.cells, &self.velocities, &self.gradients);
        let (forces, rates, responses) = (&self.forces, &self.rates, &self.responses);
        self.source.resize(state.positions.len(), 0.0);
        parallel::fill(&mut self.source, |i| {
            if cells.is_lone(i) {
                return 0.0;
            }
            let cell = &cells.cells[i];
            let volume = state.volumes[i];
            let excess = (cell.area - volume).clamp(-LARGEST_EXCESS * volume, LARGEST_EXCESS * volume);
            let mut rate = operators::area_rate(cells, i, velocities);
            // Round a tip or a drop the surface has no one direction, and the gradient comes from too few neighbours.
            let trust = cell.flatness();
            rate += trust * time_step * volume * gradients[i].determinant();
            if cell.is_open() && trust > 0.0 {
                let outward = cell.outward;
                rate += trust * outward.dot(&(gradients[i] * outward)) * cell.depth / outward.norm();
            }
            rate += share * excess / time_step;
            let mut value = -density * rate / kick;
            // What the wall must do beyond the body force: fillers move with the water, fixed walls stop it.
            for wall in cells.walls.of(i).iter().filter(|wall| wall.panel == FIXED) {
                let normal = wall.facet.normal * (density * wall.facet.length());
                value += if wall.filler { forces[i].dot(&normal) } else { velocities[i].dot(&normal) / kick };
            }
            for (moving, work) in responses.of(i) {
                let facet = &moving.wall.facet;
                let closing = velocities[i].dot(&facet.normal) - Responses::normal_rate(work, rates);
                value += density * facet.length() * closing / kick;
            }
            value
        });
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
/// Largest share of its area that a cell is taken to be too large or too small by.
const LARGEST_EXCESS: f64 = 0.5;
