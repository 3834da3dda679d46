//! The scheme `voronoi`: Voronoi cells of the particles as weights.

mod balance;
mod cell;
pub mod cells;
mod closed_components;
mod correct;
mod edges;
mod facet;
mod gas;
mod neighbour_lanes;
mod operators;
pub mod outline;
mod polygon;
mod reaction;
mod relax;
mod sensing;
mod shape;
mod shifting;
mod source;
mod stages;
mod system;
mod tessellate;
mod unit_pressures;
mod unpaid;
mod wall_clip;

#[cfg(test)]
mod verification;

pub use stages::Stages;

use crate::Error;
use crate::diagnostics::{self, Observables};
use crate::discretisation::{Discretisation, mean_acceleration};
use crate::linear::ConjugateGradient;
use crate::parameters::VoronoiParameters;
use crate::problem::Problem;
use crate::report::{Report, Watch};
use crate::state::State;
use crate::time_step::{Stability, TimeStep};
use crate::walls::stop::{Contact, EndWalls};
use balance::Balance;
use kinematics::Motion;
use nalgebra::{DVector, Vector2};
use outline::Outline;
use shifting::Shift;
use std::any::Any;
use system::PressureSystem;
use unpaid::Unpaid;

/// Distance in spacings at which walls count at the end of a step, and where water is looked at.
const REACH: f64 = 3.1;
/// Share of sqrt(l0 / |a|) that a step may take.
const EASE: f64 = 0.25;

/// Water on Voronoi cells.
#[derive(Debug)]
pub struct Voronoi {
    parameters: VoronoiParameters,
    system: PressureSystem,
    solver: ConjugateGradient<1>,
    right_side: Vec<f64>,
    solution: Vec<f64>,
    /// Generalised acceleration over the step beyond the one that pressures were prepared for.
    acceleration_increment: DVector<f64>,
    shift: Shift,
    unpaid: Unpaid,
    end_walls: EndWalls,
    balance: Balance,
}

impl Voronoi {
    /// Water on Voronoi cells with the given parameters.
    ///
    /// # Errors
    /// A parameter out of its range.
    pub fn new(parameters: VoronoiParameters) -> Result<Self, Error> {
        parameters.check()?;
        Ok(Self::with(parameters))
    }

    fn with(parameters: VoronoiParameters) -> Self {
        Self {
            parameters,
            system: PressureSystem::default(),
            solver: ConjugateGradient::default(),
            right_side: Vec::new(),
            solution: Vec::new(),
            acceleration_increment: DVector::zeros(0),
            shift: Shift::default(),
            unpaid: Unpaid::default(),
            end_walls: EndWalls::default(),
            balance: Balance::default(),
        }
    }

    /// Cells, matrix and pressure of one internal step. What does not depend on the motion asked for is kept for
    /// repeats of the step; where coordinates answer to the load this includes the pressure itself, but for its small
    /// change with the acceleration beyond the expected one.
    fn solve(
        &mut self,
        problem: &Problem,
        state: &mut State,
        step: TimeStep,
        end: &Motion,
        report: &mut Report,
    ) -> Result<(), Error> {
        let fresh = self.system.update(problem, &self.parameters, state, step, &mut report.stages);
        report.reused += usize::from(!fresh);
        let mut watch = Watch::start();
        self.solution.clone_from(&state.pressures);
        self.solution.extend(self.system.gas.pockets.iter().map(|pocket| pocket.push));
        report.responses = problem.geometry.active.len();
        kinematics::copy(&state.motion.acceleration, &mut self.system.expected);
        if report.responses > 0 {
            if fresh {
                self.prepare_unit_pressures(problem, state, report)?;
            }
            mean_acceleration(end, &state.motion, step.length, &mut self.acceleration_increment);
            self.acceleration_increment -= &state.motion.acceleration;
            self.solution.clone_from(&self.system.base);
            self.system.unit_pressures.add(&self.acceleration_increment, &mut self.solution);
        }
        mean_acceleration(end, &state.motion, step.length, &mut self.system.accelerations);
        self.solve_for_walls(problem, state.time, report)?;
        self.level_compartments(problem);
        let (water, gas) = self.solution.split_at(state.pressures.len());
        state.pressures.copy_from_slice(water);
        self.system.gas.pressures.clear();
        self.system.gas.pressures.extend_from_slice(gas);
        if report.responses == 0 {
            self.system.gas.expected.clone_from(&self.system.gas.pressures);
            self.system.find_steady_load(problem, &state.pressures);
        } else if fresh {
            let base = std::mem::take(&mut self.system.base);
            let (water, gas) = base.split_at(state.pressures.len());
            self.system.gas.expected.clear();
            self.system.gas.expected.extend_from_slice(gas);
            self.system.find_steady_load(problem, water);
            self.system.base = base;
        }
        watch.lap(&mut report.stages.solve);
        Ok(())
    }

    /// Unit pressures, and the pressure with the body accelerating as at the end of the last step: both depend on the
    /// state alone. `self.solution` holds the first guess.
    fn prepare_unit_pressures(&mut self, problem: &Problem, state: &State, report: &mut Report) -> Result<(), Error> {
        let PressureSystem { matrix, multigrid, unit_pressures, accelerations, .. } = &mut self.system;
        unit_pressures.solve(problem, matrix, multigrid);
        report.iterations += unit_pressures.iterations;
        kinematics::copy(&state.motion.acceleration, accelerations);
        self.solve_for_walls(problem, state.time, report)?;
        self.system.base.clone_from(&self.solution);
        Ok(())
    }

    /// Gives the pressure of water that touches no free surface its zero.
    fn level_compartments(&mut self, problem: &Problem) {
        let Some(groups) = self.system.compartments() else { return };
        let up = -problem.parameters.gravity * problem.parameters.density;
        let (cells, places) = (&self.system.cells, &self.system.positions);
        groups.level(cells, places, &up, self.parameters.enclosed_pressure, &mut self.solution[..places.len()]);
    }

    /// Solves for the pressure with the accelerations of the walls as set, from the guess in `self.solution`.
    fn solve_for_walls(&mut self, problem: &Problem, time: f64, report: &mut Report) -> Result<(), Error> {
        let Self { system, solver, right_side, solution, .. } = self;
        system.fill_right_side(problem, right_side);
        let parameters = system.tolerance_beside_gas(&problem.parameters.solve, right_side);
        let outcome = solver.solve_one(&system.matrix, &system.multigrid, right_side, solution, &parameters);
        report.enter_solve(outcome, system.matrix.size(), time, parameters.tolerance)
    }
}

impl Discretisation for Voronoi {
    fn fresh(&self) -> Box<dyn Discretisation> {
        Box::new(Self::with(self.parameters.clone()))
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn stability(&self) -> Stability {
        let (courant, ordinary_courant) = (self.parameters.courant, VoronoiParameters::default().courant);
        Stability { courant, ordinary_courant, ease: EASE }
    }

    /// 1e-4 shows in linear sloshing only.
    fn tolerance(&self) -> f64 {
        1e-5
    }

    fn reach(&self) -> f64 {
        REACH
    }

    fn full_density(&self) -> f64 {
        1.0
    }

    fn has_added_mass(&self) -> bool {
        true
    }

    fn areas(
        &self,
        positions: &mut [Vector2<f64>],
        counts: &[usize],
        water: &[Vec<Vector2<f64>>],
        spacing: f64,
    ) -> Vec<f64> {
        relax::relax(positions, counts, water, spacing)
    }

    /// Symmetric in time: drift over half of the step, cells, walls and pressure in the middle, kick over all of it,
    /// drift over the other half. Positions and velocities stand at its ends.
    fn step(
        &mut self,
        problem: &Problem,
        state: &mut State,
        step: TimeStep,
        end: &Motion,
        report: &mut Report,
    ) -> Result<(), Error> {
        self.solve(problem, state, step, end, report)?;
        let mut watch = Watch::start();
        let paid_before = state.gains.walls.impulse;
        let Self { system, parameters, shift, unpaid, balance, .. } = self;
        balance.stopped(problem, state, system, end, step.length);
        system.find_body_load(problem, &state.pressures);
        system.sense(problem, &state.pressures, step, &mut state.sensors);
        correct::add_load(state, system, step);
        correct::add_added_mass(state, system, step.share);
        correct::kick(state, system, problem, step.length);
        system.finish_gas(problem, state, &end.velocity, step);
        shift.plan(&state.areas, system, problem, parameters, step.length);
        unpaid.take_back(state, system, problem, &shift.changes, step.length);
        system.record_rates(&mut state.area_rates, &state.velocities, &end.velocity);
        shift.apply(state, system, problem.spacing, unpaid.taken(), step.length);
        balance.moved(problem, state, system, end, &shift.changes, step);
        correct::drift(&mut state.positions, &state.velocities, 0.5 * step.length);
        let near = (&system.proximities, &system.walls);
        // What closes on a wall loses its velocity on the way to the middle of the next step, where the wall gets it.
        let contact = Contact { stops: false, ..Contact::inelastic(problem.spacing) };
        let kept = self.end_walls.keep_in_front(problem, state, end, near, &contact);
        if kept > 0 {
            balance.kept_in_front(problem, state, |i| self.end_walls.stops[i].way);
        }
        state.wall_force += (paid_before - state.gains.walls.impulse) * (step.share / step.length);
        state.wall_force += system.gas.force_on_fixed_walls() * step.share;
        report.contacts += system.contacts + kept;
        state.jumps += system.jumps;
        watch.lap(&mut report.stages.gradient);
        correct::record(state, &self.system);
        watch.lap(&mut report.stages.other);
        Ok(())
    }

    fn places(&self) -> &[Vector2<f64>] {
        &self.system.positions
    }

    /// With the body accelerating as at the end of the last step. Where nothing answers to the load, a pressure that is
    /// not found is left to the first step, which says why.
    fn find_load(
        &mut self,
        problem: &Problem,
        state: &mut State,
        step: TimeStep,
        end: &Motion,
        report: &mut Report,
    ) -> Result<(), Error> {
        let free = !problem.geometry.active.is_empty();
        let mut scratch = state.clone();
        match self.solve(problem, &mut scratch, step, end, report) {
            Err(Error::Pressure { .. }) if !free => return Ok(()),
            solved => solved?,
        }
        self.system.find_body_load(problem, &scratch.pressures);
        scratch.load.copy_from_slice(&self.system.body_load);
        for (sensor, probe) in state.sensors.iter_mut().zip(&problem.geometry.probes) {
            sensor.set(self.system.read(problem, &scratch.pressures, probe));
        }
        state.wall_force = self.balance.force_on_fixed_walls(problem, &self.system, &scratch.pressures)
            + self.system.gas.force_on_fixed_walls();
        self.system.begin_gas(problem, state, 0.5 * step.length);
        state.load = scratch.load;
        state.pressures = scratch.pressures;
        state.acceleration.copy_from_slice(state.motion.acceleration.as_slice());
        if free {
            state.added_mass.clone_from(&self.system.unit_pressures.added_mass);
        }
        Ok(())
    }

    fn observe(&mut self, problem: &Problem, state: &State) -> Observables {
        let outline = Outline::of(problem, state, self.system.cells_of(problem, state));
        diagnostics::observe(problem, state, &outline)
    }
}
