//! The solver: one communication step as named stages.

use crate::Error;
use crate::check;
use crate::contact::BodyContact;
use crate::fill;
use crate::grid::bounding_box;
use crate::motion::interpolate;
use crate::observe::{self, Observables};
use crate::order::Order;
use crate::panel_motion::PanelMotion;
use crate::parallel;
use crate::parameters::{AccurateParameters, Geometry, PaperParameters, Parameters, Scheme};
use crate::prepare::{Pace, Prepared, Setting};
use crate::pressure::ConjugateGradient;
use crate::report::Report;
use crate::schedule::{Limits, next_step};
use crate::state::{AreaRate, State};
use crate::voronoi;
use crate::walls::Walls;
use kinematics::Motion;
use nalgebra::{DVector, Vector2};

/// The semi-implicit particle method for one scene, in the scheme that its parameters name.
///
/// Scheme `accurate`: see [`crate::voronoi`]. Scheme `paper`, one internal step of length dt:
/// 1. foretell where the moving walls stand, x + v dt + a dt^2 / 2;
/// 2. predict u* = u + g dt, r* = r + u* dt;
/// 3. find neighbours and mirror images at r*, number density n, free surface;
/// 4. solve lap p = (1 - alpha) rho div u* / dt + alpha rho (n0 - n) / (n0 dt^2) with p = 0 on the surface and
///    dp/dn = rho (g - a_w).n at walls;
/// 5. correct u = u* - dt grad p / rho and r with it; shift; collide; part close pairs; stop at walls;
/// 6. integrate the wall pressure to the load.
///
/// Source: Koshizuka and Oka (1996); the mixed source term Tanaka and Masunaga (2010); the paper's equations (1)-(5).
/// What comes before the solve does not depend on the motion asked for: a repeat from the same state starts there.
#[derive(Debug)]
pub struct Solver {
    pub(crate) setting: Setting,
    pub(crate) start: Vec<Vector2<f64>>,
    pub(crate) volumes: Vec<f64>,
    pub(crate) domain: (Vector2<f64>, Vector2<f64>),
    pub(crate) contact: BodyContact,
    pub(crate) pool: rayon::ThreadPool,
}

/// Scratch of a solver. It may be thrown away at any time; only time is lost.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(crate) prepared: Prepared,
    pub(crate) accurate: voronoi::prepare::Prepared,
    pub(crate) candidate: Option<State>,
    pub(crate) solve: ConjugateGradient<1>,
    pub(crate) target: Motion,
    /// Frozen coordinates with the velocities at the end of the step.
    pub(crate) frozen_end: Motion,
    pub(crate) end_walls: Walls,
    pub(crate) end_panels: PanelMotion,
    pub(crate) right_side: Vec<f64>,
    pub(crate) solution: Vec<f64>,
    /// Generalised acceleration over the step beyond the one that pressures were prepared for.
    pub(crate) surplus: DVector<f64>,
    pub(crate) vectors: Vec<Vector2<f64>>,
    /// Positions before the particles were moved.
    pub(crate) before: Vec<Vector2<f64>>,
    pub(crate) order: Order,
}

impl Solver {
    /// Makes a solver; refuses parameters out of range and impossible geometry.
    pub fn new(parameters: Parameters, geometry: Geometry) -> Result<Self, Error> {
        parameters.validate()?;
        geometry.jitter.validate()?;
        check::is_of_bearable_size(&geometry, parameters.spacing)?;
        check::walls_are_sound(&geometry, parameters.spacing)?;
        let mut filling = fill::fill(&geometry.water, parameters.spacing)?;
        let setting = Setting::new(parameters, geometry, &filling);
        let spacing = setting.spacing;
        let volumes = match &setting.parameters.scheme {
            Scheme::Paper(_) => vec![spacing * spacing; filling.positions.len()],
            Scheme::Accurate(_) => {
                let water = &setting.geometry.water;
                voronoi::relax::relax(&mut filling.positions, &filling.counts, water, spacing)
            }
        };
        let mut positions = filling.positions;
        check::areas_are_sound(&volumes, &positions)?;
        setting.geometry.jitter.apply(&mut positions, spacing);
        let threads = setting.parameters.threads;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| Error::Threads { threads, reason: error.to_string() })?;
        let (walls, contact) = setting.drawn();
        check::fits_together(&walls, &setting.geometry, &positions, spacing)?;
        check::no_overlap(&positions, spacing)?;
        let domain = domain(&walls, &positions);
        Ok(Self { setting, contact, start: positions, volumes, domain, pool })
    }

    /// Number of modes of the body; 0 without one.
    pub fn modes(&self) -> usize {
        self.setting.modes()
    }

    /// Corners at which a gap too narrow for a particle was closed, and its width \[m\].
    pub fn closed_gaps(&self) -> impl Iterator<Item = (Vector2<f64>, f64)> {
        self.setting.gaps.iter().map(|gap| (gap.corner, gap.width))
    }

    /// Whether the scheme gives an added mass.
    pub fn has_added_mass(&self) -> bool {
        matches!(self.setting.parameters.scheme, Scheme::Accurate(_))
    }

    /// Side of the square of a particle's area \[m\]: near the spacing asked for, such that the water fits.
    pub fn effective_spacing(&self) -> f64 {
        self.setting.spacing
    }

    /// The water at rest, as the geometry says.
    pub fn initial_state(&self) -> State {
        let count = self.start.len();
        let modes = self.modes();
        let mut state = State {
            time: 0.0,
            steps: 0,
            time_step: 0.0,
            motion: Motion::at_rest(modes),
            load: vec![0.0; kinematics::RIGID + modes],
            acceleration: vec![0.0; kinematics::RIGID + modes],
            added_mass: vec![0.0; (kinematics::RIGID + modes).pow(2)],
            positions: self.start.clone(),
            velocities: self.start.iter().map(|place| self.setting.geometry.start.at(place)).collect(),
            pressures: vec![0.0; count],
            volumes: self.volumes.clone(),
            area_rates: vec![AreaRate::default(); count],
            number_densities: vec![self.setting.kernel.reference_density; count],
            surface: vec![false; count],
            lost: 0,
        };
        Order::default().sort(&mut state, self.setting.spacing);
        state
    }

    /// Scratch for this solver.
    pub fn workspace(&self) -> Workspace {
        let modes = self.modes();
        Workspace {
            prepared: Prepared::new(modes),
            accurate: voronoi::prepare::Prepared::default(),
            candidate: None,
            solve: ConjugateGradient::default(),
            target: Motion::at_rest(modes),
            frozen_end: Motion::at_rest(modes),
            end_walls: Walls::default(),
            end_panels: PanelMotion::default(),
            right_side: Vec::new(),
            solution: Vec::new(),
            surplus: DVector::zeros(0),
            vectors: Vec::new(),
            before: Vec::new(),
            order: Order::default(),
        }
    }

    /// Advances `state` by `duration` \[s\] to the motion `end` of the body. The state changes only on success.
    pub fn step(
        &self,
        state: &mut State,
        end: &Motion,
        duration: f64,
        workspace: &mut Workspace,
    ) -> Result<Report, Error> {
        self.check_inputs(state, end, duration)?;
        let mut candidate = workspace.candidate.take().unwrap_or_else(|| state.clone());
        candidate.clone_from(state);
        let result = self.pool.install(|| self.advance(&mut candidate, state, end, duration, workspace));
        if result.is_ok() {
            std::mem::swap(state, &mut candidate);
        }
        workspace.candidate = Some(candidate);
        result
    }

    /// Finds pressure, load and added mass at a communication point at which nothing was stepped yet, with the body as it
    /// stands. The scheme `paper` does nothing.
    pub fn begin(&self, state: &mut State, workspace: &mut Workspace) -> Result<Report, Error> {
        self.check_body_inside(&state.motion, state.time)?;
        let mut report = Report::default();
        let limits = self.limits_now(state);
        let pace = Pace { time_step: limits.stable_step(), ordinary_step: limits.ordinary_step(), share: 1.0 };
        workspace.target.clone_from(&state.motion);
        self.pool.install(|| self.find_load(state, pace, workspace, &mut report))?;
        Ok(report)
    }

    /// Figures of a state.
    pub fn observe(&self, state: &State) -> Observables {
        self.pool.install(|| observe::observe(&self.setting, state, None))
    }

    /// The same figures; what was prepared for them serves the next step.
    pub fn observe_with(&self, state: &State, workspace: &mut Workspace) -> Observables {
        self.pool.install(|| match &self.setting.parameters.scheme {
            Scheme::Paper(_) => observe::observe(&self.setting, state, None),
            Scheme::Accurate(_) => {
                observe::observe(&self.setting, state, Some(workspace.accurate.cells_of(&self.setting, state)))
            }
        })
    }

    fn check_inputs(&self, state: &State, end: &Motion, duration: f64) -> Result<(), Error> {
        let refuse = |name: String, got: f64, expected: &str| {
            Err(Error::Input { name, got, time: state.time, expected: expected.to_string() })
        };
        if !(duration.is_finite() && duration > 0.0) {
            return refuse("duration".to_string(), duration, "a finite number above 0");
        }
        for (name, vector) in
            [("position", &end.position), ("velocity", &end.velocity), ("acceleration", &end.acceleration)]
        {
            let length = state.motion.position.len();
            if vector.len() != length {
                return refuse(format!("length of motion.{name}"), vector.len() as f64, &format!("{length}"));
            }
            if let Some(k) = (0..length).find(|&k| !vector[k].is_finite()) {
                return refuse(format!("motion.{name}[{k}]"), vector[k], "a finite number");
            }
        }
        Ok(())
    }

    /// Internal steps until the end of the communication step.
    fn advance(
        &self,
        candidate: &mut State,
        start: &State,
        end: &Motion,
        duration: f64,
        workspace: &mut Workspace,
    ) -> Result<Report, Error> {
        let mut report = Report::default();
        candidate.load.fill(0.0);
        candidate.added_mass.fill(0.0);
        let mut done = 0.0;
        while done < duration {
            let now = self.limits_now(candidate);
            let limits = self.limits_towards(now, candidate, end, duration - done)?;
            let time_step = next_step(&limits, duration - done, candidate.time_step, candidate.time)?;
            let last = time_step >= duration - done;
            done = if last { duration } else { done + time_step };
            workspace.target.clone_from(end);
            interpolate(&start.motion, end, duration, done / duration, &mut workspace.target);
            let pace = Pace { time_step, ordinary_step: now.ordinary_step(), share: time_step / duration };
            self.internal_step(candidate, pace, workspace, &mut report)?;
            candidate.time = start.time + done;
        }
        for (k, mean) in candidate.acceleration.iter_mut().enumerate() {
            *mean = (end.velocity[k] - start.motion.velocity[k]) / duration;
        }
        report.suggested_step = SUGGESTED_SHARE * self.limits_now(candidate).stable_step();
        Ok(report)
    }

    /// Limits of the next internal step from the state alone.
    fn limits_now(&self, state: &State) -> Limits {
        let lonely = LONELY * self.setting.kernel.reference_density;
        let mut speed = parallel::maximum(state.velocities.len(), 0.0, |i| {
            let share = if state.number_densities[i] < lonely { LONELY_SPEED } else { 1.0 };
            state.velocities[i].norm() * share
        });
        let parameters = &self.setting.parameters;
        let force = |place: &Vector2<f64>| parameters.body_force(place, state.time).norm();
        let mut acceleration = parameters.gravity.norm().max(force(&Vector2::zeros()));
        if parameters.attraction != 0.0 {
            acceleration = parallel::maximum(state.positions.len(), acceleration, |i| force(&state.positions[i]));
        }
        if let Some(body) = &self.setting.geometry.body {
            for point in self.setting.layout.panels.iter().flatten() {
                speed = speed.max(body.velocity(*point, &state.motion).norm());
                acceleration = acceleration.max(body.acceleration(*point, &state.motion).norm());
            }
        }
        let (courant, ordinary_courant, ease) = match &self.setting.parameters.scheme {
            Scheme::Paper(paper) => (paper.courant, PaperParameters::default().courant, 0.1),
            Scheme::Accurate(accurate) => (accurate.courant, AccurateParameters::default().courant, 0.25),
        };
        Limits { spacing: self.setting.spacing, courant, ordinary_courant, speed, acceleration, ease }
    }

    /// The same limits with the speed of the walls on the way to `end` and there.
    fn limits_towards(&self, mut limits: Limits, state: &State, end: &Motion, left: f64) -> Result<Limits, Error> {
        if let Some(body) = &self.setting.geometry.body {
            self.contact.check(body, end, state.time)?;
            for point in self.setting.layout.panels.iter().flatten() {
                let place = body.position(*point, end);
                self.check_inside(&place, state.time)?;
                let travelled = (place - body.position(*point, &state.motion)).norm() / left;
                limits.speed = limits.speed.max(travelled).max(body.velocity(*point, end).norm());
            }
        }
        Ok(limits)
    }

    /// Refuses a motion that takes the body out of the domain.
    pub(crate) fn check_body_inside(&self, motion: &Motion, time: f64) -> Result<(), Error> {
        let Some(body) = &self.setting.geometry.body else { return Ok(()) };
        let mut points = self.setting.layout.panels.iter().flatten();
        points.try_for_each(|point| self.check_inside(&body.position(*point, motion), time))
    }

    fn check_inside(&self, place: &Vector2<f64>, time: f64) -> Result<(), Error> {
        let (low, high) = self.domain;
        for (name, value, low, high) in [("x", place.x, low.x, high.x), ("y", place.y, low.y, high.y)] {
            if !(low..=high).contains(&value) {
                let name = format!("motion: {name} of a point of the body's surface");
                return Err(Error::Input { name, got: value, time, expected: format!("within {low} to {high} m") });
            }
        }
        Ok(())
    }
}

/// The box within which particles and body must stay: as far beyond walls and water as these are long.
fn domain(walls: &Walls, positions: &[Vector2<f64>]) -> (Vector2<f64>, Vector2<f64>) {
    let corners = walls.segments.iter().flat_map(|segment| [segment.start, segment.end()]);
    let all: Vec<_> = corners.chain(positions.iter().copied()).collect();
    let (low, high) = bounding_box(&all);
    let margin = (high - low).max();
    (low.add_scalar(-margin), high.add_scalar(margin))
}

/// Share of the stable step that is suggested to a master, so that the next step needs no division although the flow
/// gets faster meanwhile: only a step without division has a load that is exactly affine in the motion.
pub const SUGGESTED_SHARE: f64 = 0.8;
/// Share of n0 below which a particle flies on its own.
const LONELY: f64 = 0.2;
/// Share of its speed that such a particle counts with in the Courant number: it interacts with nothing, and needs only
/// not to jump over walls, which see it from r_e on. A single fast drop would otherwise slow down all the water.
const LONELY_SPEED: f64 = 0.3;
