//! The scheme `mps`: the classical weights of the moving particle semi-implicit method, as the paper states it.
//!
//! One internal step of length dt:
//! 1. extrapolate where the moving walls stand, x + v dt + a dt^2 / 2;
//! 2. predict u* = u + g dt, r* = r + u* dt;
//! 3. find neighbours and mirror images at r*, number density n, free surface;
//! 4. solve lap p = (1 - alpha) rho div u* / dt + alpha rho (n0 - n) / (n0 dt^2) with p = 0 on the surface and
//!    dp/dn = rho (g - a_w).n at walls;
//! 5. correct u = u* - dt grad p / rho and r with it; shift; collide; part close pairs; stop at walls;
//! 6. integrate the wall pressure to the load.
//!
//! Source: Koshizuka and Oka (1996); the mixed source term Tanaka and Masunaga (2010); the paper's equations (1)-(5).

mod correct;
mod free_surface;
pub mod images;
pub mod kernel;
mod load;
mod neighbour;
pub mod neighbourhood;
pub mod operators;
mod system;

use crate::Error;
use crate::balance::{Gain, Tally};
use crate::diagnostics::{self, Observables};
use crate::discretisation::Discretisation;
use crate::grid::Grid;
use crate::linear::ConjugateGradient;
use crate::parallel;
use crate::parameters::MpsParameters;
use crate::pressure_field::PressureField;
use crate::problem::Problem;
use crate::report::{Report, Watch};
use crate::sensors;
use crate::state::State;
use crate::time_step::{Stability, TimeStep};
use crate::voronoi::outline::Outline;
use crate::walls::stop::{Contact, EndWalls};
use kernel::Kernel;
use kinematics::Motion;
use nalgebra::Vector2;
use std::any::Any;
use system::{NO_ROW, PressureSystem};

/// Share of sqrt(l0 / |a|) that a step may take.
const EASE: f64 = 0.1;
/// Share of the full number density from which on a particle has company.
const COMPANY: f64 = 0.3;

/// The parameters and what follows from them.
#[derive(Debug, Clone)]
pub struct Method {
    pub parameters: MpsParameters,
    pub kernel: Kernel,
}

impl Method {
    /// n0 lambda / (2 d): the paper's Laplacian is the matrix divided by minus this.
    pub fn laplacian_scale(&self) -> f64 {
        self.kernel.reference_density * self.kernel.lambda / (2.0 * operators::DIMENSIONS)
    }
}

/// Water with classical weights.
#[derive(Debug)]
pub struct Mps {
    method: Method,
    system: PressureSystem,
    solver: ConjugateGradient<1>,
    right_side: Vec<f64>,
    solution: Vec<f64>,
    vectors: Vec<Vector2<f64>>,
    /// Frozen coordinates with the velocities at the end of the step.
    frozen_end: Motion,
    end_walls: EndWalls,
    /// Cells in which particles are looked for around a place.
    grid: Grid,
    balance: Tally,
    loads: Vec<f64>,
    partial: Vec<[f64; 4]>,
}

impl Mps {
    /// Water with the given parameters, whose particles start on a lattice of rectangular cells `cell` \[m\].
    ///
    /// # Errors
    /// A parameter out of its range.
    pub fn new(parameters: MpsParameters, cell: Vector2<f64>) -> Result<Self, Error> {
        parameters.check()?;
        let kernel = Kernel::new(parameters.influence_radius, cell);
        Ok(Self::with(Method { parameters, kernel }))
    }

    fn with(method: Method) -> Self {
        Self {
            method,
            system: PressureSystem::new(0),
            solver: ConjugateGradient::default(),
            right_side: Vec::new(),
            solution: Vec::new(),
            vectors: Vec::new(),
            frozen_end: Motion::at_rest(0),
            end_walls: EndWalls::default(),
            grid: Grid::default(),
            balance: Tally::default(),
            loads: Vec::new(),
            partial: Vec::new(),
        }
    }

    /// Mean acceleration of every panel over the step with the coordinates at which the walls stand in it: affine in
    /// the velocity asked for.
    fn set_wall_acceleration(&mut self, problem: &Problem, end: &Motion, time_step: f64) {
        let bodies = &problem.geometry.bodies;
        if bodies.is_empty() {
            return;
        }
        let Self { system, frozen_end, .. } = self;
        frozen_end.clone_from(end);
        frozen_end.position.copy_from(&system.extrapolated.position);
        system.panels.set_end(&problem.layout.panels, bodies, frozen_end, time_step);
    }

    fn solve(&mut self, problem: &Problem, state: &mut State, report: &mut Report) -> Result<(), Error> {
        let mut watch = Watch::start();
        let Self { system, solver, right_side, solution, .. } = self;
        let unknowns = &system.unknowns;
        let size = system.matrix.size();
        right_side.resize(size, 0.0);
        solution.resize(size, 0.0);
        parallel::fill(right_side, |row| {
            let images = system.around.images.of(unknowns.particles[row] as usize);
            let walls: f64 = images.iter().map(|image| image.weight * system.rise(problem, image)).sum();
            system.source[row] + walls
        });
        parallel::fill(solution, |row| state.pressures[unknowns.particles[row] as usize]);
        let parameters = &problem.parameters.solve;
        let outcome = solver.solve_one(&system.matrix, &system.multigrid, right_side, solution, parameters);
        report.enter_solve(outcome, size, state.time, parameters.tolerance)?;
        let rows = &unknowns.rows;
        parallel::fill(&mut state.pressures, |i| if rows[i] == NO_ROW { 0.0 } else { solution[rows[i] as usize] });
        watch.lap(&mut report.stages.solve);
        Ok(())
    }

    /// Adds this internal step's share of the mean load, and the readings of sensors.
    fn add_load(&self, problem: &Problem, state: &mut State, step: TimeStep) {
        let bodies = &problem.geometry.bodies;
        if bodies.is_empty() && problem.geometry.probes.is_empty() {
            return;
        }
        let system = &self.system;
        let field = PressureField {
            grid: &system.around.grid,
            rings: 1,
            positions: &system.positions,
            pressures: &state.pressures,
            parameters: &problem.parameters,
            time: system.time,
            spacing: problem.spacing,
            walls: &system.walls,
        };
        let (coordinates, panels) = (&system.extrapolated.position, &problem.layout.panels);
        for (sensor, probe) in state.sensors.iter_mut().zip(&problem.geometry.probes) {
            let reading = sensors::read_in_water(problem, &field, probe, coordinates);
            sensor.add(reading, step.share, step.length, probe.threshold);
        }
        if !bodies.is_empty() {
            load::add_body_load(&field, bodies, panels, &system.panels, coordinates, step.share, &mut state.load);
        }
    }

    /// Largest x of a particle that has company, and half a spacing \[m\].
    fn front(&self, problem: &Problem, state: &State) -> f64 {
        let company = COMPANY * self.method.kernel.reference_density;
        let has_company = |i: &usize| state.number_densities[*i] > company;
        let farthest = (0..state.positions.len()).filter(has_company).map(|i| state.positions[i].x);
        let front = farthest.fold(f64::NEG_INFINITY, f64::max);
        if front.is_finite() { front + 0.5 * problem.spacing } else { 0.0 }
    }
}

/// What the body forces give per time; energy only of those without a potential.
fn forces(problem: &Problem, state: &State, time: f64, partial: &mut Vec<[f64; 4]>) -> Gain {
    let parameters = &problem.parameters;
    let shaking = parameters.uniform_force(time) - parameters.gravity;
    let term = |i: usize| {
        let (place, force) = (&state.positions[i], parameters.body_force(&state.positions[i], time));
        let power = shaking.dot(&state.velocities[i]);
        [force.x, force.y, place.perp(&force), power].map(|value| value * state.areas[i])
    };
    Gain::from_sums(parameters.density, parallel::sums(state.positions.len(), partial, term))
}

impl Discretisation for Mps {
    fn fresh(&self) -> Box<dyn Discretisation> {
        Box::new(Self::with(self.method.clone()))
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn stability(&self) -> Stability {
        let (courant, ordinary_courant) = (self.method.parameters.courant, MpsParameters::default().courant);
        Stability { courant, ordinary_courant, ease: EASE }
    }

    fn tolerance(&self) -> f64 {
        1e-3
    }

    fn reach(&self) -> f64 {
        self.method.parameters.influence_radius
    }

    fn full_density(&self) -> f64 {
        self.method.kernel.reference_density
    }

    fn has_added_mass(&self) -> bool {
        false
    }

    fn areas(&self, positions: &mut [Vector2<f64>], _: &[usize], _: &[Vec<Vector2<f64>>], spacing: f64) -> Vec<f64> {
        vec![spacing * spacing; positions.len()]
    }

    fn step(
        &mut self,
        problem: &Problem,
        state: &mut State,
        step: TimeStep,
        end: &Motion,
        report: &mut Report,
    ) -> Result<(), Error> {
        let fresh = self.system.update(problem, &self.method, state, step, &mut report.stages);
        report.reused += usize::from(!fresh);
        self.set_wall_acceleration(problem, end, step.length);
        self.solve(problem, state, report)?;
        let mut watch = Watch::start();
        let Self { method, system, vectors, balance, partial, .. } = self;
        balance.since(problem, state);
        let forces = forces(problem, state, system.time, partial) * step.length;
        correct::correct(state, system, problem, method, step.length, vectors);
        state.gains.forces += forces;
        state.gains.projection += balance.since(problem, state) - forces;
        correct::shift(state, system, problem, method, step.length, vectors);
        state.gains.shifting += balance.since(problem, state);
        correct::collide(state, system, problem, method, vectors);
        correct::separate(state, system, problem, vectors);
        let (reach, restitution) = (0.5 * method.parameters.collision_distance, method.parameters.restitution);
        let contact = Contact { reach: reach * problem.spacing, restitution, ..Contact::inelastic(problem.spacing) };
        let near = (&system.proximities, &system.walls);
        report.contacts += self.end_walls.keep_in_front(problem, state, end, near, &contact);
        state.gains.contacts += self.balance.since(problem, state);
        watch.lap(&mut report.stages.gradient);
        self.loads.clone_from(&state.load);
        self.add_load(problem, state, step);
        let duration = step.length / step.share;
        self.loads.iter_mut().zip(&state.load).for_each(|(load, now)| *load = (now - *load) * duration);
        let rates = state.motion.velocity.iter().zip(end.velocity.iter()).map(|(a, b)| 0.5 * (a + b));
        let place = &self.system.extrapolated.position;
        let given = Gain::of_bodies(&problem.geometry.bodies, &self.loads, place, rates);
        state.gains.bodies += -given;
        state.gains.projection += given;
        for (value, density) in state.number_densities.iter_mut().zip(&self.system.densities) {
            *value = density.number_density;
        }
        state.surface.copy_from_slice(&self.system.surface);
        watch.lap(&mut report.stages.other);
        Ok(())
    }

    fn places(&self) -> &[Vector2<f64>] {
        &self.system.positions
    }

    /// Nothing: pressures come from steps.
    fn find_load(&mut self, _: &Problem, _: &mut State, _: TimeStep, _: &Motion, _: &mut Report) -> Result<(), Error> {
        Ok(())
    }

    fn observe(&mut self, problem: &Problem, state: &State) -> Observables {
        let walls = problem.walls(&state.motion.position);
        let outline = Outline::new(problem, state, &walls);
        self.grid.build(&state.positions, problem.reach);
        let field = PressureField::of(problem, state, &self.grid, &walls);
        let (front, wall_force) = (self.front(problem, state), load::fixed_wall_force(&field));
        Observables { front, wall_force, ..diagnostics::observe(problem, state, &outline) }
    }
}
