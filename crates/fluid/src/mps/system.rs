//! The part of an internal step that depends on the state alone: prediction, neighbours, matrix, preconditioner.
//!
//! Coupling iterations repeat a step from the same state with other motions of the body. What is prepared here is
//! kept in the workspace under the fingerprint of its state, so that a repeat only solves.

use super::Method;
use super::free_surface;
use super::images::Image;
use super::kernel::Kernel;
use super::neighbourhood::Neighbourhood;
use super::operators::{Density, Operators};
use crate::linear::{Entry, Matrix, Multigrid};
use crate::motion::extrapolate;
use crate::parallel::{self, Lists};
use crate::parameters::{MpsParameters, Source};
use crate::problem::Problem;
use crate::report::{StageTimes, Watch};
use crate::state::State;
use crate::time_step::TimeStep;
use crate::walls::{PanelMotion, WallProximity, Walls};
use kinematics::Motion;
use nalgebra::Vector2;

/// Row number of a particle that is no unknown.
pub const NO_ROW: u32 = u32::MAX;

/// Which particles are unknowns: those that are not on the surface.
#[derive(Debug, Clone, Default)]
pub struct Unknowns {
    /// Particle of each row.
    pub particles: Vec<u32>,
    /// Row of each particle, or `NO_ROW`.
    pub rows: Vec<u32>,
}

impl Unknowns {
    fn number(&mut self, surface: &[bool]) {
        self.particles.clear();
        self.rows.clear();
        for (i, &on_surface) in surface.iter().enumerate() {
            self.rows.push(if on_surface { NO_ROW } else { self.particles.len() as u32 });
            if !on_surface {
                self.particles.push(i as u32);
            }
        }
    }

    /// The matrix of A p = b with (A p)_i = sum_j w_ij (p_i - p_j): the Laplacian (the paper's equation 3b) times
    /// -n0 lambda / (2 d). Neighbours on the surface, where p = 0, are row sums. `regularise` is for water without any
    /// free surface.
    pub fn assemble(&mut self, around: &Neighbourhood, surface: &[bool], regularise: bool, matrix: &mut Matrix) {
        self.number(surface);
        let Self { particles, rows } = &*self;
        let near = |row: usize| {
            let i = particles[row] as usize;
            let direct = around.neighbours.of(i).iter().map(|entry| (entry.index, entry.weight));
            direct.chain(around.images.of(i).iter().map(|image| (image.neighbour, image.weight)))
        };
        matrix.set_rows(particles.len(), |row, out| {
            for (j, weight) in near(row) {
                let column = rows[j as usize];
                if column != NO_ROW && column != row as u32 {
                    out.push(Entry { column, weight: weight as f32 });
                }
            }
        });
        matrix.row_sums.resize(particles.len(), 0.0);
        parallel::fill(&mut matrix.row_sums, |row| {
            near(row).filter(|&(j, _)| surface[j as usize]).map(|(_, weight)| weight).sum()
        });
        matrix.close(regularise);
    }

    /// Position of the particle of each row.
    pub fn gather_positions(&self, positions: &[Vector2<f64>], out: &mut Vec<Vector2<f64>>) {
        out.clear();
        out.extend(self.particles.iter().map(|&i| positions[i as usize]));
    }
}

/// Everything prepared for one internal step, and the scratch it needs.
#[derive(Debug, Clone)]
pub struct PressureSystem {
    key: Option<(u64, u64)>,
    partial: Vec<u64>,
    /// Time at the start of the step \[s\].
    pub time: f64,
    /// Extrapolated coordinates of the body, where walls stand during the step.
    pub extrapolated: Motion,
    /// Walls at those coordinates.
    pub walls: Walls,
    walls_placed: bool,
    /// Wall velocities at the start of the step.
    pub panels: PanelMotion,
    /// Predicted positions r* \[m\].
    pub positions: Vec<Vector2<f64>>,
    /// Walls near each particle.
    pub proximities: Lists<WallProximity>,
    /// Neighbours and images at the predicted positions.
    pub around: Neighbourhood,
    /// Number density and centroid of each particle.
    pub densities: Vec<Density>,
    /// Particles on the free surface.
    pub surface: Vec<bool>,
    /// Source of the Poisson equation at each row, already scaled to the matrix, without the walls' part \[Pa\].
    pub source: Vec<f64>,
    /// Unknowns of the pressure.
    pub unknowns: Unknowns,
    /// Matrix of the pressure.
    pub matrix: Matrix,
    /// Preconditioner of the pressure solve.
    pub multigrid: Multigrid,
    points: Vec<Vector2<f64>>,
    reached: Vec<bool>,
    queue: Vec<u32>,
}

impl PressureSystem {
    pub fn new(modes: usize) -> Self {
        Self {
            key: None,
            partial: Vec::new(),
            time: 0.0,
            extrapolated: Motion::at_rest(modes),
            walls: Walls::default(),
            walls_placed: false,
            panels: PanelMotion::default(),
            positions: Vec::new(),
            proximities: Lists::default(),
            around: Neighbourhood::default(),
            densities: Vec::new(),
            surface: Vec::new(),
            source: Vec::new(),
            unknowns: Unknowns::default(),
            matrix: Matrix::default(),
            multigrid: Multigrid::default(),
            points: Vec::new(),
            reached: Vec::new(),
            queue: Vec::new(),
        }
    }

    /// The operators at the predicted positions.
    pub fn operators<'a>(&'a self, kernel: &'a Kernel) -> Operators<'a> {
        Operators { positions: &self.positions, around: &self.around, kernel, panels: &self.panels }
    }

    /// Prepares the step from `state`; returns false when the workspace held it already.
    pub fn update(
        &mut self,
        problem: &Problem,
        method: &Method,
        state: &State,
        step: TimeStep,
        stages: &mut StageTimes,
    ) -> bool {
        let mut watch = Watch::start();
        let key = Some((state.fingerprint(&mut self.partial), step.length.to_bits()));
        if self.key == key {
            return false;
        }
        self.key = None;
        extrapolate(&state.motion, step.length, &mut self.extrapolated);
        self.place_walls(problem, state);
        self.predict(problem, state, step.length);
        self.around.build(&self.positions, &self.proximities, &self.walls, &method.kernel);
        watch.lap(&mut stages.neighbours);
        let closed = self.classify(problem, method);
        self.build_source(problem, method, state, step);
        self.unknowns.assemble(&self.around, &self.surface, closed, &mut self.matrix);
        let mut points = std::mem::take(&mut self.points);
        self.unknowns.gather_positions(&self.positions, &mut points);
        self.multigrid.set_up(&self.matrix.row_sums, &points, problem.spacing, method.laplacian_scale());
        self.points = points;
        self.gather_source();
        self.key = key;
        watch.lap(&mut stages.assembly);
        true
    }

    fn place_walls(&mut self, problem: &Problem, state: &State) {
        let bodies = &problem.geometry.bodies;
        if bodies.is_empty() {
            if !self.walls_placed {
                self.walls.place(&problem.layout, None, problem.reach, problem.spacing);
                self.walls_placed = true;
            }
            return;
        }
        let at = Some((bodies, &self.extrapolated.position));
        self.walls.place(&problem.layout, at, problem.reach, problem.spacing);
        self.panels.set_start(&problem.layout.panels, bodies, &state.motion);
    }

    /// Predictor: u* = u + g dt, r* = r + u* dt, stopping at walls.
    fn predict(&mut self, problem: &Problem, state: &State, time_step: f64) {
        let parameters = &problem.parameters;
        self.time = state.time;
        self.positions.resize(state.positions.len(), Vector2::zeros());
        parallel::fill(&mut self.positions, |i| {
            let force = parameters.body_force(&state.positions[i], state.time);
            state.positions[i] + state.velocities[i] * time_step + force * (time_step * time_step)
        });
        let walls = &self.walls;
        let least = 0.05 * problem.spacing;
        let mut positions = std::mem::take(&mut self.positions);
        {
            let predicted = &positions;
            self.proximities.build(predicted.len(), |i, out| walls.attach(&predicted[i], out));
        }
        let proximities = &self.proximities;
        let stop = |i: usize, position: Vector2<f64>| {
            let touches = |entry: &&WallProximity| entry.distance < least && walls.is_beside(entry);
            let near = proximities.of(i).iter().filter(touches);
            near.fold(position, |place, entry| place - entry.normal * (least - entry.distance))
        };
        for (i, position) in positions.iter_mut().enumerate() {
            *position = stop(i, *position);
        }
        self.positions = positions;
    }

    fn classify(&mut self, problem: &Problem, method: &Method) -> bool {
        let count = self.positions.len();
        self.densities.resize(count, Density::default());
        let mut densities = std::mem::take(&mut self.densities);
        let operators = self.operators(&method.kernel);
        parallel::fill(&mut densities, |i| operators.density(i));
        self.densities = densities;
        self.surface.resize(count, false);
        let mut surface = std::mem::take(&mut self.surface);
        let (operators, densities) = (self.operators(&method.kernel), &self.densities);
        parallel::fill(&mut surface, |i| {
            free_surface::is_surface(i, &densities[i], &operators, problem.spacing, &method.parameters)
        });
        self.surface = surface;
        let strong = method.kernel.weight((free_surface::REACH * problem.spacing).powi(2));
        free_surface::settle_closed(&self.around, &mut self.surface, strong, &mut self.reached, &mut self.queue)
    }

    /// The paper's equation (5), times -n0 lambda / (2 d), for every particle.
    ///
    /// Departure from the print: beside the surface a number density below n0 only says that the neighbourhood is cut
    /// off there, so it counts as n0; the paper's n0 - n would pull the layers below the surface with a force that
    /// grows as 1 / dt^2. A density above n0 counts everywhere.
    ///
    /// Gravity is uniform, so that div u* = div u; images reflect u about the wall's velocity at the start, and what
    /// the wall does during the step enters with the images' pressure.
    fn build_source(&mut self, problem: &Problem, method: &Method, state: &State, step: TimeStep) {
        let mut source = std::mem::take(&mut self.source);
        source.resize(self.positions.len(), 0.0);
        let operators = self.operators(&method.kernel);
        let (surface, densities) = (&self.surface, &self.densities);
        let density = problem.parameters.density;
        let reference = method.kernel.reference_density;
        let scale = -method.laplacian_scale();
        parallel::fill(&mut source, |i| {
            if surface[i] {
                return 0.0;
            }
            let divergence = operators.divergence(i, &state.velocities);
            let mut lack = (reference - densities[i].number_density) / reference;
            if lack > 0.0 && free_surface::is_beside_surface(i, operators.around, surface) {
                lack = 0.0;
            }
            scale * density * source_term(&method.parameters, divergence, lack, step)
        });
        self.source = source;
    }

    /// Brings the source from particles to rows; rows ascend with particles, so this can be done in place.
    fn gather_source(&mut self) {
        for (row, &i) in self.unknowns.particles.iter().enumerate() {
            self.source[row] = self.source[i as usize];
        }
        self.source.truncate(self.matrix.size());
    }

    /// Pressure of an image above that of its particle \[Pa\].
    pub fn rise(&self, problem: &Problem, image: &Image) -> f64 {
        let force = problem.parameters.body_force(&self.positions[image.neighbour as usize], self.time);
        problem.parameters.density * image.pressure_rise(&force, &self.panels)
    }
}

/// Right side of the Poisson equation over the density \[1/s2\].
///
/// `lack` is (n0 - n) / n0. Mixed: the paper's equation (5), with n at the predicted positions; the difference to the
/// printed n^k is alpha times the divergence already present. Adaptive: Sun et al. (2015), with the density error
/// clipped at two per cent.
///
/// A step shorter than the stable one at the default Courant number removes a smaller share of the density error, in
/// proportion: the time in which the error decays, dt / alpha, then stays that of this step. With the printed constant alpha a master that
/// shortens its step would be answered with pressures that grow as 1 / dt^2.
fn source_term(mps: &MpsParameters, divergence: f64, lack: f64, step: TimeStep) -> f64 {
    let time_step = step.length;
    let slowing = (time_step / step.ordinary).min(1.0);
    let lack = lack * slowing;
    match mps.source {
        Source::Mixed => (1.0 - mps.alpha) * divergence / time_step + mps.alpha * lack / (time_step * time_step),
        Source::Adaptive => {
            let clipped = lack.clamp(-0.02, 0.02);
            let mut share = clipped.abs();
            if clipped * divergence > 0.0 {
                share += time_step * divergence.abs();
            }
            divergence / time_step + share * clipped / (time_step * time_step)
        }
    }
}
