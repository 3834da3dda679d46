//! The solver: one communication step as internal steps of its discretisation.

use crate::Error;
use crate::balance::{Gain, Gains};
use crate::diagnostics::Observables;
use crate::discretisation::Discretisation;
use crate::gas::{Gas, Reading, Space};
use crate::grid::bounding_box;
use crate::motion::interpolate;
use crate::mps::Mps;
use crate::order::{self, Order};
use crate::parallel;
use crate::parameters::{Geometry, Parameters, Scheme};
use crate::particles;
use crate::problem::Problem;
use crate::report::{Report, Watch};
use crate::sensors::Sensor;
use crate::setup::{check, fill};
use crate::state::{AreaRate, State};
use crate::time_step::{Limits, TimeStep, next_step};
use crate::voronoi::Voronoi;
use crate::walls::{BodyContact, Walls};
use kinematics::Motion;
use nalgebra::Vector2;

/// The semi-implicit particle method for one scene, in the scheme that its parameters name.
///
/// What comes before the solve does not depend on the motion asked for: a repeat from the same state starts there.
#[derive(Debug)]
pub struct Solver {
    pub(crate) problem: Problem,
    pub(crate) start: Vec<Vector2<f64>>,
    pub(crate) areas: Vec<f64>,
    pub(crate) domain: (Vector2<f64>, Vector2<f64>),
    /// The discretisation, without scratch.
    pub(crate) discretisation: Box<dyn Discretisation>,
    pub(crate) contact: BodyContact,
    pub(crate) pool: rayon::ThreadPool,
}

/// Scratch of a solver. It may be thrown away at any time; only time is lost.
#[derive(Debug)]
pub struct Workspace {
    discretisation: Box<dyn Discretisation>,
    candidate: Option<State>,
    target: Motion,
    order: Order,
    /// Scratch of sums.
    sums: Vec<[f64; 4]>,
}

/// The one place where schemes are told apart.
fn discretisation(scheme: &Scheme, cell: Vector2<f64>) -> Result<Box<dyn Discretisation>, Error> {
    Ok(match scheme {
        Scheme::Mps(parameters) => Box::new(Mps::new(parameters.clone(), cell)?),
        Scheme::Voronoi(parameters) => Box::new(Voronoi::new(parameters.clone())?),
    })
}

impl Solver {
    /// Makes a solver; refuses parameters out of range and impossible geometry.
    pub fn new(mut parameters: Parameters, geometry: Geometry) -> Result<Self, Error> {
        parameters.validate()?;
        geometry.jitter.validate()?;
        check::is_of_bearable_size(&geometry, parameters.spacing)?;
        check::instruments_have_bodies(&geometry)?;
        check::walls_are_sound(&geometry, parameters.spacing)?;
        let mut filling = fill::fill(&geometry.water, parameters.spacing)?;
        let discretisation = discretisation(&parameters.scheme, filling.cell)?;
        if parameters.solve.tolerance == 0.0 {
            let answers = !geometry.active.is_empty();
            parameters.solve.tolerance = if answers { COUPLED_TOLERANCE } else { discretisation.tolerance() };
        }
        let spacing = filling.effective_spacing;
        let problem = Problem::new(parameters, geometry, spacing, discretisation.reach() * spacing);
        let water = &problem.geometry.water;
        let areas = discretisation.areas(&mut filling.positions, &filling.counts, water, spacing);
        let mut positions = filling.positions;
        check::areas_are_sound(&areas, &positions)?;
        problem.geometry.jitter.apply(&mut positions, spacing);
        let threads = problem.parameters.threads;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| Error::Threads { threads, reason: error.to_string() })?;
        let (walls, contact) = problem.drawn();
        check::bodies_are_apart(&problem.geometry)?;
        contact.check_apart(&problem.geometry.bodies, &problem.geometry.bodies.at_rest(), 0.0)?;
        check::fits_together(&walls, &problem.geometry, &positions, spacing)?;
        check::no_overlap(&positions, spacing)?;
        let domain = domain(&walls, &positions);
        Ok(Self { problem, discretisation, contact, start: positions, areas, domain, pool })
    }

    /// The bodies at rest in the scene's pose.
    pub fn at_rest(&self) -> Motion {
        self.problem.geometry.bodies.at_rest()
    }

    /// Corners at which a gap too narrow for a particle was closed, and its width \[m\].
    pub fn closed_gaps(&self) -> impl Iterator<Item = (Vector2<f64>, f64)> {
        self.problem.gaps.iter().map(|gap| (gap.corner, gap.width))
    }

    /// Space without water at the start that walls, bodies and water close off from the open air, each with its area
    /// \[m2\] to within the noise of a spacing along its outline, and its middle \[m\].
    pub fn pockets(&self) -> Vec<(f64, Vector2<f64>)> {
        let mut space = Space::default();
        space.find(&self.start, &self.problem.walls(&self.at_rest().position), self.problem.spacing);
        space.found().collect()
    }

    /// Whether the scheme gives an added mass.
    pub fn has_added_mass(&self) -> bool {
        self.discretisation.has_added_mass()
    }

    /// Side of the square of a particle's area \[m\]: near the spacing asked for, such that the water fits.
    pub fn effective_spacing(&self) -> f64 {
        self.problem.spacing
    }

    /// The water at rest, as the geometry says.
    pub fn initial_state(&self) -> State {
        let count = self.start.len();
        let size = self.problem.coordinates();
        let mut state = State {
            time: 0.0,
            steps: 0,
            time_step: 0.0,
            motion: self.at_rest(),
            load: vec![0.0; size],
            acceleration: vec![0.0; size],
            added_mass: vec![0.0; size * size],
            positions: self.start.clone(),
            velocities: self.start.iter().map(|place| self.problem.geometry.start.at(place)).collect(),
            pressures: vec![0.0; count],
            areas: self.areas.clone(),
            area_rates: vec![AreaRate::default(); count],
            number_densities: vec![self.discretisation.full_density(); count],
            surface: vec![false; count],
            lost: 0,
            jumps: 0,
            wall_force: Vector2::zeros(),
            sensors: vec![Sensor::default(); self.problem.geometry.probes.len()],
            gains: Gains::default(),
            gas: Gas {
                chambers: vec![Reading::default(); self.problem.geometry.chambers.len()],
                vents: vec![0.0; self.problem.geometry.vents.len()],
                ..Gas::default()
            },
        };
        Order::default().sort(&mut state, self.problem.spacing);
        state
    }

    /// Scratch for this solver.
    pub fn workspace(&self) -> Workspace {
        Workspace {
            discretisation: self.discretisation.fresh(),
            candidate: None,
            target: self.at_rest(),
            order: Order::default(),
            sums: Vec::new(),
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
    /// stands. Without an added mass this does nothing.
    pub fn begin(&self, state: &mut State, workspace: &mut Workspace) -> Result<Report, Error> {
        self.check_body_inside(&state.motion, state.time)?;
        let mut report = Report::default();
        let limits = self.limits_now(state);
        let step = TimeStep { length: limits.stable_step(), ordinary: limits.ordinary_step(), share: 1.0 };
        let Workspace { discretisation, target, .. } = workspace;
        target.clone_from(&state.motion);
        target.velocity.axpy(step.length, &state.motion.acceleration, 1.0);
        self.pool.install(|| discretisation.find_load(&self.problem, state, step, target, &mut report))?;
        Ok(report)
    }

    /// Quantities of a state.
    pub fn observe(&self, state: &State) -> Observables {
        self.observe_with(state, &mut self.workspace())
    }

    /// The same; what was found for them serves the next step.
    pub fn observe_with(&self, state: &State, workspace: &mut Workspace) -> Observables {
        self.pool.install(|| workspace.discretisation.observe(&self.problem, state))
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
        candidate.wall_force = Vector2::zeros();
        candidate.added_mass.fill(0.0);
        candidate.sensors.iter_mut().for_each(Sensor::begin);
        candidate.gas.begin();
        let mut done = 0.0;
        while done < duration {
            let now = self.limits_now(candidate);
            let limits = self.limits_towards(now, candidate, end, duration - done)?;
            let time_step = next_step(&limits, duration - done, candidate.time_step, candidate.time)?;
            let last = time_step >= duration - done;
            done = if last { duration } else { done + time_step };
            workspace.target.clone_from(end);
            interpolate(&start.motion, end, duration, done / duration, &mut workspace.target);
            let step = TimeStep { length: time_step, ordinary: now.ordinary_step(), share: time_step / duration };
            self.internal_step(candidate, step, workspace, &mut report)?;
            candidate.time = start.time + done;
        }
        for (k, mean) in candidate.acceleration.iter_mut().enumerate() {
            *mean = (end.velocity[k] - start.motion.velocity[k]) / duration;
        }
        report.suggested_step = SUGGESTED_SHARE * self.limits_now(candidate).stable_step();
        Ok(report)
    }

    /// One internal step: that of the discretisation, damping zones, and what must hold after every step.
    fn internal_step(
        &self,
        state: &mut State,
        step: TimeStep,
        workspace: &mut Workspace,
        report: &mut Report,
    ) -> Result<(), Error> {
        let Workspace { discretisation, target, order, sums, .. } = workspace;
        discretisation.step(&self.problem, state, step, target, report)?;
        let mut watch = Watch::start();
        check::all_finite(state, discretisation.places())?;
        if particles::some_left(state, &self.domain.0, &self.domain.1) {
            let before = Gain::of_water(&self.problem, state, sums);
            state.lost += particles::remove_lost(state, &self.domain.0, &self.domain.1);
            state.gains.lost += Gain::of_water(&self.problem, state, sums) - before;
        }
        state.motion.clone_from(target);
        state.time_step = step.length;
        state.steps += 1;
        if order::is_due(state.steps) {
            order.sort(state, self.problem.spacing);
        }
        if !self.problem.parameters.damping.is_empty() {
            let before = Gain::of_water(&self.problem, state, sums);
            particles::slow(state, &self.problem.parameters, step.length);
            state.gains.damping += Gain::of_water(&self.problem, state, sums) - before;
        }
        watch.lap(&mut report.stages.other);
        report.substeps += 1;
        Ok(())
    }

    /// Limits of the next internal step from the state alone.
    fn limits_now(&self, state: &State) -> Limits {
        let lonely = LONELY * self.discretisation.full_density();
        let mut speed = parallel::maximum(state.velocities.len(), 0.0, |i| {
            let share = if state.number_densities[i] < lonely { LONELY_SPEED } else { 1.0 };
            state.velocities[i].norm() * share
        });
        let parameters = &self.problem.parameters;
        let force = |place: &Vector2<f64>| parameters.body_force(place, state.time).norm();
        let mut acceleration = parameters.gravity.norm().max(force(&Vector2::zeros()));
        if parameters.attraction != 0.0 {
            acceleration = parallel::maximum(state.positions.len(), acceleration, |i| force(&state.positions[i]));
        }
        let bodies = &self.problem.geometry.bodies;
        for point in self.problem.layout.panels.iter().flatten() {
            speed = speed.max(bodies.velocity(*point, &state.motion).norm());
            acceleration = acceleration.max(bodies.acceleration(*point, &state.motion).norm());
        }
        Limits { spacing: self.problem.spacing, stability: self.discretisation.stability(), speed, acceleration }
    }

    /// The same limits with the speed of the walls on the way to `end` and there.
    fn limits_towards(&self, mut limits: Limits, state: &State, end: &Motion, left: f64) -> Result<Limits, Error> {
        let bodies = &self.problem.geometry.bodies;
        self.contact.check(bodies, end, state.time)?;
        self.contact.check_apart(bodies, end, state.time)?;
        for point in self.problem.layout.panels.iter().flatten() {
            let place = bodies.position(*point, end);
            self.check_inside(&place, state.time)?;
            let travelled = (place - bodies.position(*point, &state.motion)).norm() / left;
            limits.speed = limits.speed.max(travelled).max(bodies.velocity(*point, end).norm());
        }
        Ok(limits)
    }

    /// Refuses a motion that takes a body out of the domain.
    pub(crate) fn check_body_inside(&self, motion: &Motion, time: f64) -> Result<(), Error> {
        let bodies = &self.problem.geometry.bodies;
        let mut points = self.problem.layout.panels.iter().flatten();
        points.try_for_each(|point| self.check_inside(&bodies.position(*point, motion), time))
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

/// Residual of the pressure, over the right side, where the body answers to the load: loads must be as good as the
/// coupling's tolerance.
const COUPLED_TOLERANCE: f64 = 1e-8;
/// Share of the stable step that is suggested to a master, so that the next step needs no division although the flow
/// gets faster meanwhile: only a step without division has a load that is exactly affine in the motion.
pub const SUGGESTED_SHARE: f64 = 0.8;
/// Share of n0 below which a particle flies on its own.
const LONELY: f64 = 0.2;
/// Share of its speed that such a particle counts with in the Courant number: it interacts with nothing, and needs only
/// not to jump over walls, which see it from r_e on. A single fast drop would otherwise slow down all the water.
const LONELY_SPEED: f64 = 0.3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{MpsParameters, VoronoiParameters};
    use kinematics::Body;

    fn tolerance(scheme: Scheme, given: f64, free: bool) -> f64 {
        let point = |(x, y): (f64, f64)| Vector2::new(x, y);
        let walls = vec![[(0.3, 0.3), (0.3, 0.6), (0.6, 0.6), (0.6, 0.3), (0.3, 0.3)].map(point).to_vec()];
        let geometry = Geometry {
            water: vec![[(0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.0, 0.2)].map(point).to_vec()],
            bodies: Body { origin: Vector2::zeros(), angle: 0.0, walls, members: Vec::new() }.into(),
            active: if free { vec![1] } else { Vec::new() },
            ..Geometry::default()
        };
        let solve = crate::SolveParameters { tolerance: given, ..crate::SolveParameters::default() };
        let parameters = Parameters { scheme, solve, spacing: 0.05, threads: 1, ..Parameters::default() };
        Solver::new(parameters, geometry).unwrap().problem.parameters.solve.tolerance
    }

    #[test]
    fn the_tolerance_is_what_the_discretisation_and_the_body_need() {
        let (voronoi, mps) =
            (|| Scheme::Voronoi(VoronoiParameters::default()), || Scheme::Mps(MpsParameters::default()));
        assert_eq!(tolerance(voronoi(), 0.0, false), 1e-5);
        assert_eq!(tolerance(mps(), 0.0, false), 1e-3);
        assert_eq!((tolerance(voronoi(), 0.0, true), tolerance(mps(), 0.0, true)), (1e-8, 1e-8));
        assert_eq!(tolerance(mps(), 1e-6, true), 1e-6);
    }
}
