//! The part of an internal step that depends on the state alone: prediction, neighbours, matrix, preconditioner.
//!
//! Coupling iterations repeat a step from the same state with other motions of the body. What is prepared here is
//! kept in the workspace under the fingerprint of its state, so that a repeat only solves.

use crate::contact::BodyContact;
use crate::fill::Filling;
use crate::free_surface;
use crate::gaps::{self, ClosedGap};
use crate::images;
use crate::kernel::Kernel;
use crate::matrix::Matrix;
use crate::motion::foretell;
use crate::multigrid::Multigrid;
use crate::neighbours::Neighbourhood;
use crate::operators::{Density, Operators};
use crate::panel_motion::PanelMotion;
use crate::parallel::{self, Lists};
use crate::parameters::{Geometry, PaperParameters, Parameters, Scheme, Source};
use crate::report::{StageTimes, Watch};
use crate::state::State;
use crate::walls::{Attachment, WallLayout, Walls};
use kinematics::Motion;
use nalgebra::{DVector, Vector2};

/// What stays the same over all internal steps of a solver.
#[derive(Debug, Clone)]
pub struct Setting {
    pub parameters: Parameters,
    pub paper: PaperParameters,
    pub geometry: Geometry,
    /// Walls with narrow gaps closed.
    pub layout: WallLayout,
    /// The gaps that were closed.
    pub gaps: Vec<ClosedGap>,
    pub kernel: Kernel,
    /// Side of the square of a particle's area \[m\].
    pub spacing: f64,
}

impl Setting {
    /// What follows from parameters and geometry, with particles as `filling` has them.
    pub fn new(parameters: Parameters, geometry: Geometry, filling: &Filling) -> Self {
        let paper = match &parameters.scheme {
            Scheme::Paper(paper) => paper.clone(),
            Scheme::Accurate(_) => PaperParameters::default(),
        };
        let spacing = filling.effective_spacing;
        let kernel = Kernel::new(paper.influence_radius, filling.cell);
        let drawn = WallLayout::new(&geometry, spacing);
        let mut setting = Self { paper, kernel, layout: drawn, gaps: Vec::new(), spacing, parameters, geometry };
        let walls = setting.walls(&Motion::at_rest(setting.modes()).position);
        (setting.layout, setting.gaps) = gaps::close(&setting.layout, &walls, spacing);
        setting
    }

    /// Number of modes of the body; 0 without one.
    pub fn modes(&self) -> usize {
        self.geometry.body.as_ref().map_or(0, |body| body.modes())
    }

    /// Walls at the start as they are drawn, and what of the body must not meet the fixed ones.
    pub fn drawn(&self) -> (Walls, BodyContact) {
        let layout = WallLayout::new(&self.geometry, self.spacing);
        let walls = self.place(&layout, &Motion::at_rest(self.modes()).position);
        let contact = BodyContact::new(&layout.panels, &walls, self.spacing);
        (walls, contact)
    }

    /// Walls with the body at `coordinates`.
    pub fn walls(&self, coordinates: &DVector<f64>) -> Walls {
        self.place(&self.layout, coordinates)
    }

    fn place(&self, layout: &WallLayout, coordinates: &DVector<f64>) -> Walls {
        let mut walls = Walls::default();
        let body = self.geometry.body.as_ref().map(|body| (body, coordinates));
        walls.place(layout, body, self.kernel.radius, self.spacing);
        walls
    }

    /// n0 lambda / (2 d): the paper's Laplacian is the matrix divided by minus this.
    pub fn laplacian_scale(&self) -> f64 {
        self.kernel.reference_density * self.kernel.lambda / (2.0 * crate::operators::DIMENSIONS)
    }
}

/// How fast an internal step goes.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Length of the step \[s\].
    pub time_step: f64,
    /// Length that stability would allow at the default Courant number \[s\].
    pub ordinary_step: f64,
    /// Share of the communication step.
    pub share: f64,
}

/// Everything prepared for one internal step, and the scratch it needs.
#[derive(Debug, Clone)]
pub struct Prepared {
    key: Option<(u64, u64)>,
    partial: Vec<u64>,
    /// Time at the start of the step \[s\].
    pub time: f64,
    /// Foretold coordinates of the body, where walls stand during the step.
    pub foretold: Motion,
    /// Walls at those coordinates.
    pub walls: Walls,
    walls_placed: bool,
    /// Wall velocities at the start of the step.
    pub panels: PanelMotion,
    /// Predicted positions r* \[m\].
    pub positions: Vec<Vector2<f64>>,
    /// Walls near each particle.
    pub attachments: Lists<Attachment>,
    /// Neighbours and images at the predicted positions.
    pub around: Neighbourhood,
    /// Number density and centroid of each particle.
    pub densities: Vec<Density>,
    /// Particles on the free surface.
    pub surface: Vec<bool>,
    /// Source of the Poisson equation at each row, already scaled to the matrix, without the walls' part \[Pa\].
    pub source: Vec<f64>,
    /// Matrix of the pressure.
    pub matrix: Matrix,
    /// Preconditioner of the pressure solve.
    pub multigrid: Multigrid,
    points: Vec<Vector2<f64>>,
    reached: Vec<bool>,
    queue: Vec<u32>,
}

impl Prepared {
    pub fn new(modes: usize) -> Self {
        Self {
            key: None,
            partial: Vec::new(),
            time: 0.0,
            foretold: Motion::at_rest(modes),
            walls: Walls::default(),
            walls_placed: false,
            panels: PanelMotion::default(),
            positions: Vec::new(),
            attachments: Lists::default(),
            around: Neighbourhood::default(),
            densities: Vec::new(),
            surface: Vec::new(),
            source: Vec::new(),
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
    pub fn update(&mut self, setting: &Setting, state: &State, pace: Pace, stages: &mut StageTimes) -> bool {
        let mut watch = Watch::start();
        let time_step = pace.time_step;
        let key = Some((state.fingerprint(&mut self.partial), time_step.to_bits()));
        if self.key == key {
            return false;
        }
        self.key = None;
        foretell(&state.motion, time_step, &mut self.foretold);
        self.place_walls(setting, state);
        self.predict(setting, state, time_step);
        self.around.build(&self.positions, &self.attachments, &self.walls, &setting.kernel);
        watch.lap(&mut stages.neighbours);
        let enclosed = self.classify(setting);
        self.build_source(setting, state, pace);
        self.matrix.assemble(&self.around, &self.surface, enclosed);
        let mut points = std::mem::take(&mut self.points);
        self.matrix.gather_positions(&self.positions, &mut points);
        self.multigrid.set_up(&self.matrix, &points, setting.spacing, setting.laplacian_scale());
        self.points = points;
        self.gather_source();
        self.key = key;
        watch.lap(&mut stages.assembly);
        true
    }

    fn place_walls(&mut self, setting: &Setting, state: &State) {
        let Some(body) = &setting.geometry.body else {
            if !self.walls_placed {
                self.walls.place(&setting.layout, None, setting.kernel.radius, setting.spacing);
                self.walls_placed = true;
            }
            return;
        };
        let at = Some((body, &self.foretold.position));
        self.walls.place(&setting.layout, at, setting.kernel.radius, setting.spacing);
        self.panels.set_start(&setting.layout.panels, body, &state.motion);
    }

    /// Predictor: u* = u + g dt, r* = r + u* dt, stopping at walls.
    fn predict(&mut self, setting: &Setting, state: &State, time_step: f64) {
        let parameters = &setting.parameters;
        self.time = state.time;
        self.positions.resize(state.positions.len(), Vector2::zeros());
        parallel::fill(&mut self.positions, |i| {
            let force = parameters.body_force(&state.positions[i], state.time);
            state.positions[i] + state.velocities[i] * time_step + force * (time_step * time_step)
        });
        let walls = &self.walls;
        let least = 0.05 * setting.spacing;
        let mut positions = std::mem::take(&mut self.positions);
        {
            let predicted = &positions;
            self.attachments.build(predicted.len(), |i, out| walls.attach(&predicted[i], out));
        }
        let attachments = &self.attachments;
        let stop = |i: usize, position: Vector2<f64>| {
            let touches = |entry: &&Attachment| entry.distance < least && walls.is_beside(entry);
            let near = attachments.of(i).iter().filter(touches);
            near.fold(position, |place, entry| place - entry.normal * (least - entry.distance))
        };
        for (i, position) in positions.iter_mut().enumerate() {
            *position = stop(i, *position);
        }
        self.positions = positions;
    }

    fn classify(&mut self, setting: &Setting) -> bool {
        let count = self.positions.len();
        self.densities.resize(count, Density::default());
        let mut densities = std::mem::take(&mut self.densities);
        let operators = self.operators(&setting.kernel);
        parallel::fill(&mut densities, |i| operators.density(i));
        self.densities = densities;
        self.surface.resize(count, false);
        let mut surface = std::mem::take(&mut self.surface);
        let (operators, densities) = (self.operators(&setting.kernel), &self.densities);
        parallel::fill(&mut surface, |i| {
            free_surface::is_surface(i, &densities[i], &operators, setting.spacing, &setting.paper)
        });
        self.surface = surface;
        let strong = setting.kernel.weight((free_surface::REACH * setting.spacing).powi(2));
        free_surface::settle_enclosed(&self.around, &mut self.surface, strong, &mut self.reached, &mut self.queue)
    }

    /// The paper's equation (5), times -n0 lambda / (2 d), for every particle.
    ///
    /// Departure from the print: beside the surface a number density below n0 only says that the neighbourhood is cut
    /// off there, so it counts as n0; the paper's n0 - n would pull the layers below the surface with a force that
    /// grows as 1 / dt^2. A density above n0 counts everywhere.
    ///
    /// Gravity is uniform, so that div u* = div u; images reflect u about the wall's velocity at the start, and what
    /// the wall does during the step enters with the images' pressure.
    fn build_source(&mut self, setting: &Setting, state: &State, pace: Pace) {
        let mut source = std::mem::take(&mut self.source);
        source.resize(self.positions.len(), 0.0);
        let operators = self.operators(&setting.kernel);
        let (surface, densities) = (&self.surface, &self.densities);
        let density = setting.parameters.density;
        let reference = setting.kernel.reference_density;
        let scale = -setting.laplacian_scale();
        parallel::fill(&mut source, |i| {
            if surface[i] {
                return 0.0;
            }
            let divergence = operators.divergence(i, &state.velocities);
            let mut lack = (reference - densities[i].number_density) / reference;
            if lack > 0.0 && free_surface::is_beside_surface(i, operators.around, surface) {
                lack = 0.0;
            }
            scale * density * source_term(&setting.paper, divergence, lack, pace)
        });
        self.source = source;
    }

    /// Brings the source from particles to rows; rows ascend with particles, so this can be done in place.
    fn gather_source(&mut self) {
        for (row, &i) in self.matrix.particles.iter().enumerate() {
            self.source[row] = self.source[i as usize];
        }
        self.source.truncate(self.matrix.size());
    }

    /// Pressure of an image above that of its particle \[Pa\].
    pub fn rise(&self, setting: &Setting, image: &images::Image) -> f64 {
        let force = setting.parameters.body_force(&self.positions[image.neighbour as usize], self.time);
        setting.parameters.density * image.pressure_rise(&force, &self.panels)
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
fn source_term(paper: &PaperParameters, divergence: f64, lack: f64, pace: Pace) -> f64 {
    let time_step = pace.time_step;
    let slowing = (time_step / pace.ordinary_step).min(1.0);
    let lack = lack * slowing;
    match paper.source {
        Source::Mixed => (1.0 - paper.alpha) * divergence / time_step + paper.alpha * lack / (time_step * time_step),
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
