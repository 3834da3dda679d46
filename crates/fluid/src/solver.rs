//! The solver: one communication step as named stages.

use crate::Error;
use crate::check;
use crate::fill;
use crate::grid::bounding_box;
use crate::kernel::Kernel;
use crate::load::{self, PressureField};
use crate::matrix::NO_ROW;
use crate::motion::interpolate;
use crate::observe::{self, Observables};
use crate::panel_motion::PanelMotion;
use crate::parallel;
use crate::parameters::{AccurateParameters, Geometry, PaperParameters, Parameters, Scheme};
use crate::particles::{self, Contact};
use crate::prepare::{Pace, Prepared, Setting};
use crate::pressure::{ConjugateGradient, Outcome};
use crate::report::{Report, Watch};
use crate::schedule::{Limits, next_step};
use crate::state::State;
use crate::voronoi;
use crate::walls::{WallLayout, Walls};
use kinematics::Motion;
use nalgebra::Vector2;

/// The semi-implicit particle method for one scene.
///
/// One internal step of length dt:
/// 1. foretell where the moving walls stand, x + v dt + a dt^2 / 2;
/// 2. predict u* = u + g dt, r* = r + u* dt;
/// 3. find neighbours and mirror images at r*, number density n, free surface;
/// 4. solve lap p = (1 - alpha) rho div u* / dt + alpha rho (n0 - n) / (n0 dt^2) with p = 0 on the surface and
///    dp/dn = rho (g - a_w).n at walls;
/// 5. correct u = u* - dt grad p / rho and r with it; shift; collide; part close pairs; stop at walls;
/// 6. integrate the wall pressure to the load.
///
/// Source: Koshizuka and Oka (1996); the mixed source term Tanaka and Masunaga (2010); the paper's equations (1)-(5).
/// Steps 1-3 do not depend on the motion asked for: a repeat from the same state starts at the solve.
#[derive(Debug)]
pub struct Solver {
    setting: Setting,
    start: Vec<Vector2<f64>>,
    volumes: Vec<f64>,
    domain: (Vector2<f64>, Vector2<f64>),
    pool: rayon::ThreadPool,
}

/// Scratch of a solver. It may be thrown away at any time; only time is lost.
#[derive(Debug, Clone)]
pub struct Workspace {
    prepared: Prepared,
    accurate: voronoi::prepare::Prepared,
    candidate: Option<State>,
    solve: ConjugateGradient,
    target: Motion,
    /// Frozen coordinates with the velocities at the end of the step.
    frozen_end: Motion,
    end_walls: Walls,
    end_panels: PanelMotion,
    right_side: Vec<f64>,
    solution: Vec<f64>,
    vectors: Vec<Vector2<f64>>,
    /// Positions before the particles were moved.
    before: Vec<Vector2<f64>>,
}

impl Solver {
    /// Makes a solver; refuses parameters out of range and impossible geometry.
    pub fn new(parameters: Parameters, geometry: Geometry) -> Result<Self, Error> {
        parameters.validate()?;
        check::walls_are_sound(&geometry, parameters.spacing)?;
        let mut filling = fill::fill(&geometry.water, parameters.spacing)?;
        let spacing = filling.effective_spacing;
        let fallback = PaperParameters::default();
        let paper = match &parameters.scheme {
            Scheme::Paper(paper) => paper,
            Scheme::Accurate(_) => &fallback,
        };
        let setting = Setting {
            paper: paper.clone(),
            kernel: Kernel::new(paper.influence_radius, filling.cell),
            layout: WallLayout::new(&geometry, spacing),
            spacing,
            parameters,
            geometry,
        };
        let volumes = match &setting.parameters.scheme {
            Scheme::Paper(_) => vec![spacing * spacing; filling.positions.len()],
            Scheme::Accurate(_) => {
                let water = &setting.geometry.water;
                voronoi::relax::relax(&mut filling.positions, &filling.counts, water, spacing)
            }
        };
        let threads = setting.parameters.threads;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| Error::Threads { threads, reason: error.to_string() })?;
        let mut walls = Walls::default();
        let rest = Motion::at_rest(setting.geometry.body.as_ref().map_or(0, |body| body.modes()));
        let body = setting.geometry.body.as_ref().map(|body| (body, &rest.position));
        walls.place(&setting.layout, body, setting.kernel.radius, spacing);
        check::fits_together(&walls, &filling.positions, spacing)?;
        check::no_overlap(&filling.positions, spacing)?;
        let corners = walls.segments.iter().flat_map(|segment| [segment.start, segment.end()]);
        let all: Vec<_> = corners.chain(filling.positions.iter().copied()).collect();
        let (low, high) = bounding_box(&all);
        let margin = (high - low).max();
        let domain = (low.add_scalar(-margin), high.add_scalar(margin));
        Ok(Self { setting, start: filling.positions, volumes, domain, pool })
    }

    /// Number of modes of the body; 0 without one.
    pub fn modes(&self) -> usize {
        self.setting.geometry.body.as_ref().map_or(0, |body| body.modes())
    }

    /// Side of the square of a particle's area \[m\]: near the spacing asked for, such that the water fits.
    pub fn effective_spacing(&self) -> f64 {
        self.setting.spacing
    }

    /// The water at rest, as the geometry says.
    pub fn initial_state(&self) -> State {
        let count = self.start.len();
        let modes = self.modes();
        State {
            time: 0.0,
            steps: 0,
            time_step: 0.0,
            motion: Motion::at_rest(modes),
            load: vec![0.0; kinematics::RIGID + modes],
            positions: self.start.clone(),
            velocities: self.start.iter().map(|place| self.setting.geometry.start.at(place)).collect(),
            pressures: vec![0.0; count],
            volumes: self.volumes.clone(),
            number_densities: vec![self.setting.kernel.reference_density; count],
            surface: vec![false; count],
            lost: 0,
        }
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
            vectors: Vec::new(),
            before: Vec::new(),
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

    /// Figures of a state.
    pub fn observe(&self, state: &State) -> Observables {
        self.pool.install(|| observe::observe(&self.setting, state))
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
        let mut done = 0.0;
        while done < duration {
            let now = self.limits_now(candidate);
            let limits = self.limits_towards(now, candidate, end, duration - done)?;
            let time_step = next_step(&limits, duration - done, candidate.time_step, candidate.time)?;
            let last = time_step >= duration - done;
            done = if last { duration } else { done + time_step };
            let mut target = std::mem::replace(&mut workspace.target, Motion::at_rest(0));
            target.clone_from(end);
            interpolate(&start.motion, end, duration, done / duration, &mut target);
            workspace.target = target;
            let pace = Pace { time_step, stable_step: now.stable_step(), share: time_step / duration };
            self.internal_step(candidate, pace, workspace, &mut report)?;
            candidate.time = start.time + done;
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
        let mut acceleration = parallel::maximum(state.positions.len(), parameters.gravity.norm(), |i| {
            parameters.body_force(&state.positions[i], state.time).norm()
        });
        if let Some(body) = &self.setting.geometry.body {
            for point in self.setting.layout.panels.iter().flatten() {
                speed = speed.max(body.velocity(*point, &state.motion).norm());
                acceleration = acceleration.max(body.acceleration(*point, &state.motion).norm());
            }
        }
        let (courant, ease) = match &self.setting.parameters.scheme {
            Scheme::Paper(paper) => (paper.courant, 0.1),
            Scheme::Accurate(accurate) => (accurate.courant, 0.25),
        };
        Limits { spacing: self.setting.spacing, courant, speed, acceleration, ease }
    }

    /// The same limits with the speed of the walls on the way to `end` and there.
    fn limits_towards(&self, mut limits: Limits, state: &State, end: &Motion, left: f64) -> Result<Limits, Error> {
        if let Some(body) = &self.setting.geometry.body {
            for point in self.setting.layout.panels.iter().flatten() {
                let place = body.position(*point, end);
                self.check_inside(&place, state.time)?;
                let travelled = (place - body.position(*point, &state.motion)).norm() / left;
                limits.speed = limits.speed.max(travelled).max(body.velocity(*point, end).norm());
            }
        }
        Ok(limits)
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

    /// One internal step: prepare, solve, correct, keep in front of the walls, load.
    fn internal_step(
        &self,
        state: &mut State,
        pace: Pace,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        let setting = &self.setting;
        if let Scheme::Accurate(accurate) = &setting.parameters.scheme {
            return self.accurate_step(accurate, state, pace, workspace, report);
        }
        let time_step = pace.time_step;
        let fresh = workspace.prepared.update(setting, state, pace, &mut report.stages);
        report.reused += usize::from(!fresh);
        self.set_wall_acceleration(time_step, workspace);
        self.solve_pressure(state, workspace, report)?;
        let mut watch = Watch::start();
        particles::correct(state, &workspace.prepared, setting, time_step, &mut workspace.vectors);
        particles::shift(state, &workspace.prepared, setting, time_step, &mut workspace.vectors);
        particles::collide(state, &workspace.prepared, setting, &mut workspace.vectors);
        particles::separate(state, &workspace.prepared, setting, &mut workspace.vectors);
        report.contacts += self.keep_in_front(state, workspace);
        watch.lap(&mut report.stages.gradient);
        self.add_load(state, pace.share, workspace);
        for (value, density) in state.number_densities.iter_mut().zip(&workspace.prepared.densities) {
            *value = density.number_density;
        }
        state.surface.copy_from_slice(&workspace.prepared.surface);
        workspace.before.clone_from(&workspace.prepared.positions);
        self.finish(state, time_step, workspace)?;
        report.substeps += 1;
        report.unknowns = workspace.prepared.matrix.size();
        watch.lap(&mut report.stages.other);
        Ok(())
    }

    /// One internal step on Voronoi cells.
    fn accurate_step(
        &self,
        accurate: &AccurateParameters,
        state: &mut State,
        pace: Pace,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        let setting = &self.setting;
        let fresh = workspace.accurate.update(setting, accurate, state, pace, &mut report.stages);
        report.reused += usize::from(!fresh);
        if let Some(body) = &setting.geometry.body {
            workspace.frozen_end.clone_from(&workspace.target);
            workspace.frozen_end.position.copy_from(&state.motion.position);
            let end = &workspace.frozen_end;
            workspace.accurate.panels.set_end(&setting.layout.panels, body, end, pace.time_step);
        }
        self.solve_on_cells(state, workspace, report)?;
        let mut watch = Watch::start();
        if let Some(body) = &setting.geometry.body {
            voronoi::step::add_body_load(state, &workspace.accurate, setting, body, pace.share);
        }
        workspace.before.clone_from(&state.positions);
        voronoi::step::correct(state, &workspace.accurate, setting, pace.time_step);
        voronoi::step::shift(state, &workspace.accurate, setting, accurate, pace.time_step, &mut workspace.vectors);
        report.contacts += self.keep_in_front(state, workspace);
        watch.lap(&mut report.stages.gradient);
        voronoi::step::record(state, &workspace.accurate, setting.kernel.reference_density);
        self.finish(state, pace.time_step, workspace)?;
        report.substeps += 1;
        report.unknowns = workspace.accurate.matrix.size();
        watch.lap(&mut report.stages.other);
        Ok(())
    }

    fn solve_on_cells(&self, state: &mut State, workspace: &mut Workspace, report: &mut Report) -> Result<(), Error> {
        let mut watch = Watch::start();
        let Workspace { accurate: prepared, solve, right_side, solution, .. } = workspace;
        let size = prepared.matrix.size();
        right_side.resize(size, 0.0);
        {
            let prepared = &*prepared;
            parallel::fill(right_side, |i| prepared.source[i] + prepared.wall_source(&self.setting, i));
        }
        solution.clone_from(&state.pressures);
        let parameters = &self.setting.parameters.solve;
        let outcome = solve.solve(&prepared.matrix, &mut prepared.multigrid, right_side, solution, parameters);
        self.account(&outcome, size, state.time, report)?;
        state.pressures.copy_from_slice(solution);
        watch.lap(&mut report.stages.solve);
        Ok(())
    }

    /// Enters a solve into the report; an error if it did not reach its tolerance.
    fn account(&self, outcome: &Outcome, unknowns: usize, time: f64, report: &mut Report) -> Result<(), Error> {
        let tolerance = self.setting.parameters.solve.tolerance;
        report.iterations += outcome.iterations;
        report.residual = report.residual.max(outcome.residual);
        if outcome.residual > tolerance || !outcome.residual.is_finite() {
            let Outcome { iterations, residual } = *outcome;
            return Err(Error::Pressure { time, iterations, residual, tolerance, unknowns });
        }
        Ok(())
    }

    /// Mean acceleration of every panel over the step, on the foretold geometry: affine in the velocity asked for.
    fn set_wall_acceleration(&self, time_step: f64, workspace: &mut Workspace) {
        let Some(body) = &self.setting.geometry.body else { return };
        workspace.frozen_end.clone_from(&workspace.target);
        workspace.frozen_end.position.copy_from(&workspace.prepared.foretold.position);
        workspace.prepared.panels.set_end(&self.setting.layout.panels, body, &workspace.frozen_end, time_step);
    }

    fn solve_pressure(&self, state: &mut State, workspace: &mut Workspace, report: &mut Report) -> Result<(), Error> {
        let mut watch = Watch::start();
        let Workspace { prepared, solve, right_side, solution, .. } = workspace;
        let size = prepared.matrix.size();
        right_side.resize(size, 0.0);
        solution.resize(size, 0.0);
        {
            let (setting, prepared) = (&self.setting, &*prepared);
            parallel::fill(right_side, |row| {
                let i = prepared.matrix.particles[row] as usize;
                let images = prepared.around.images.of(i);
                let walls: f64 = images.iter().map(|image| image.weight * prepared.rise(setting, image)).sum();
                prepared.source[row] + walls
            });
            parallel::fill(solution, |row| state.pressures[prepared.matrix.particles[row] as usize]);
        }
        let parameters = &self.setting.parameters.solve;
        let outcome = solve.solve(&prepared.matrix, &mut prepared.multigrid, right_side, solution, parameters);
        self.account(&outcome, size, state.time, report)?;
        let rows = &prepared.matrix.rows;
        parallel::fill(&mut state.pressures, |i| if rows[i] == NO_ROW { 0.0 } else { solution[rows[i] as usize] });
        watch.lap(&mut report.stages.solve);
        Ok(())
    }

    /// Keeps particles in front of the walls where these stand at the end of the step.
    fn keep_in_front(&self, state: &mut State, workspace: &mut Workspace) -> usize {
        let setting = &self.setting;
        let spacing = setting.spacing;
        let (attachments, walls, contact) = match &setting.parameters.scheme {
            Scheme::Paper(paper) => {
                let reach = 0.5 * paper.collision_distance * spacing;
                let contact = Contact { reach, restitution: paper.restitution, least: 0.1 * spacing, spacing };
                (&workspace.prepared.attachments, &workspace.prepared.walls, contact)
            }
            Scheme::Accurate(_) => {
                let least = 0.1 * spacing;
                let contact = Contact { reach: least, restitution: 0.0, least, spacing };
                (&workspace.accurate.attachments, &workspace.accurate.walls, contact)
            }
        };
        let Some(body) = &setting.geometry.body else {
            return particles::stop_at_walls(state, attachments, walls, &contact, |_, _| Vector2::zeros());
        };
        let at = Some((body, &workspace.target.position));
        workspace.end_walls.place(&setting.layout, at, setting.kernel.radius, spacing);
        workspace.end_panels.set_start(&setting.layout.panels, body, &workspace.target);
        let panels = &workspace.end_panels;
        particles::stop_at_walls(state, attachments, &workspace.end_walls, &contact, |panel, fraction| {
            panels.velocity(panel, fraction)
        })
    }

    /// Adds this internal step's share of the mean load.
    fn add_load(&self, state: &mut State, share: f64, workspace: &Workspace) {
        let Some(body) = &self.setting.geometry.body else { return };
        let prepared = &workspace.prepared;
        let field = PressureField {
            grid: &prepared.around.grid,
            positions: &prepared.positions,
            pressures: &state.pressures,
            parameters: &self.setting.parameters,
            time: prepared.time,
            spacing: self.setting.spacing,
            walls: &prepared.walls,
        };
        let coordinates = &prepared.foretold.position;
        let panels = &self.setting.layout.panels;
        load::add_body_load(&field, body, panels, &prepared.panels, coordinates, share, &mut state.load);
    }

    /// Removes lost particles, and stops anything that is not finite.
    fn finish(&self, state: &mut State, time_step: f64, workspace: &Workspace) -> Result<(), Error> {
        check::all_finite(state, &workspace.before)?;
        state.lost += particles::remove_lost(state, &self.domain.0, &self.domain.1);
        state.motion.clone_from(&workspace.target);
        state.time_step = time_step;
        state.steps += 1;
        Ok(())
    }
}

/// Share of the stable step that is suggested to a master, so that the next step needs no division although the flow
/// gets faster meanwhile: only a step without division has a load that is exactly affine in the motion.
const SUGGESTED_SHARE: f64 = 0.8;
/// Share of n0 below which a particle flies on its own.
const LONELY: f64 = 0.2;
/// Share of its speed that such a particle counts with in the Courant number: it interacts with nothing, and needs only
/// not to jump over walls, which see it from r_e on. A single fast drop would otherwise slow down all the water.
const LONELY_SPEED: f64 = 0.3;
