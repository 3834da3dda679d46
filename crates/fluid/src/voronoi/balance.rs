//! What the stages of one step of the scheme `voronoi` give the water.
//!
//! The energy that a change w of the velocity gives is taken as w.(u_0 + u_1) / 2 per mass, with the velocities u_0 and u_1 at
//! the start and the end of the step: so all changes together give the change of u^2 / 2, and gravity exactly what the way
//! through the step takes from the potential energy.

use super::system::PressureSystem;
use crate::balance::Gain;
use crate::parallel;
use crate::problem::Problem;
use crate::state::State;
use crate::time_step::TimeStep;
use kinematics::Motion;
use nalgebra::Vector2;

/// Sums of the gains of a step, stage by stage.
#[derive(Debug, Default)]
pub struct Balance {
    four: Vec<[f64; 4]>,
    three: Vec<[f64; 3]>,
    all: Vec<[f64; 16]>,
}

/// Momentum, angular momentum and energy per mass of a change of velocity at a place.
fn change(place: &Vector2<f64>, change: Vector2<f64>, mean: &Vector2<f64>) -> [f64; 4] {
    [change.x, change.y, place.perp(&change), change.dot(mean)]
}

impl Balance {
    /// Particles stopped on the way to the middle of the step; before anything of `state` is changed.
    pub fn stopped(
        &mut self,
        problem: &Problem,
        state: &mut State,
        system: &PressureSystem,
        end: &Motion,
        time_step: f64,
    ) {
        if system.contacts == 0 {
            return;
        }
        let (parameters, half) = (&problem.parameters, 0.5 * time_step);
        let term = |i: usize| {
            let (from, to) = (&state.positions[i], &system.positions[i]);
            let (before, after) = (&state.velocities[i], &system.before[i]);
            let kinetic = 0.5 * (after.norm_squared() - before.norm_squared());
            let way = to - after * half - from;
            let potential = parameters.potential_on(&way, &(from + way));
            let change = after - before;
            let angular = to.perp(after) - from.perp(before);
            [change.x, change.y, angular, kinetic + potential].map(|value| value * state.areas[i])
        };
        let sums = parallel::sums(state.positions.len(), &mut self.four, term);
        let all = Gain::from_sums(parameters.density, sums);
        let bodies = -of_bodies(problem, state, system, end, &system.stopped);
        state.gains.bodies += bodies;
        state.gains.walls += all - bodies;
    }

    /// Force of the water on the fixed walls with the given pressures \[N/m\].
    pub fn force_on_fixed_walls(
        &mut self,
        problem: &Problem,
        system: &PressureSystem,
        pressures: &[f64],
    ) -> Vector2<f64> {
        system.force_on_fixed_walls(problem, pressures, &mut self.three).0
    }

    /// Everything from the middle of the step on; after particles and velocities were shifted, with the `changes` of velocity
    /// that this made, and before the particles move on.
    pub fn moved(
        &mut self,
        problem: &Problem,
        state: &mut State,
        system: &PressureSystem,
        end: &Motion,
        changes: &[Vector2<f64>],
        step: TimeStep,
    ) {
        let dt = step.length;
        let (force, moment) = system.force_on_fixed_walls(problem, &state.pressures, &mut self.three);
        let walls = Gain { impulse: force, angular: moment, energy: 0.0 } * -dt;
        let bodies = of_bodies(problem, state, system, end, &system.water_load) * -dt;
        let gas = self.of_gas(state, system, dt);
        let [forces, smoothing, pressure, shifting] = self.stages(problem, state, system, changes, dt);
        let gains = &mut state.gains;
        gains.forces += forces;
        gains.walls += walls;
        gains.bodies += bodies;
        // What the shift gave of momentum was taken back together with what the pressure left unpaid.
        let returned = Gain { impulse: shifting.impulse, ..Gain::default() };
        gains.gas += gas;
        gains.projection += pressure + returned - walls - bodies - gas;
        gains.smoothing += smoothing;
        gains.shifting += shifting - returned;
    }

    /// What gas gives by its pressure on the surface.
    fn of_gas(&mut self, state: &State, system: &PressureSystem, dt: f64) -> Gain {
        let pressures = &system.gas.pressures;
        if pressures.is_empty() {
            return Gain::default();
        }
        let term = |i: usize| {
            let cell = &system.cells.cells[i];
            let push = cell.outward * -system.gas.outside(pressures, i);
            let mean = (system.before[i] + state.velocities[i]) * 0.5;
            change(&system.positions[i], push, &mean)
        };
        let sums = parallel::sums(state.positions.len(), &mut self.four, term);
        Gain::from_sums(dt, sums)
    }

    /// Forces, smoothing, pressure and shift.
    fn stages(
        &mut self,
        problem: &Problem,
        state: &State,
        system: &PressureSystem,
        changes: &[Vector2<f64>],
        dt: f64,
    ) -> [Gain; 4] {
        let (parameters, half) = (&problem.parameters, 0.5 * dt);
        let smoothed = system.smoothed.len() == state.positions.len();
        let term = |i: usize| {
            let (middle, place) = (&system.positions[i], &state.positions[i]);
            let (first, last) = (&system.before[i], &state.velocities[i]);
            let mean = (first + last) * 0.5;
            let forced = system.forces[i] * dt;
            let smoothing = if smoothed { system.velocities[i] - (first + forced) } else { Vector2::zeros() };
            let (shifted, kicked) = (changes[i], last - changes[i]);
            let mut forces = change(middle, forced, &mean);
            let (to, from) = (first * half, last * half);
            forces[3] += parameters.potential_on(&to, middle) + parameters.potential_on(&from, &(place + from));
            let mut shifting = change(place, shifted, &mean);
            let way = place - middle;
            shifting[2] += way.perp(&kicked);
            shifting[3] += parameters.potential_on(&way, place);
            let stages = [
                forces,
                change(middle, smoothing, &mean),
                change(middle, kicked - system.velocities[i], &mean),
                shifting,
            ];
            let mut terms = [0.0; 16];
            terms.iter_mut().zip(stages.as_flattened()).for_each(|(term, value)| *term = value * state.areas[i]);
            terms
        };
        let sums = parallel::sums(state.positions.len(), &mut self.all, term);
        std::array::from_fn(|k| Gain::from_sums(parameters.density, std::array::from_fn(|n| sums[4 * k + n])))
    }

    /// Particles that were moved in front of walls at the end of the step, by these ways.
    pub fn kept_in_front(&mut self, problem: &Problem, state: &mut State, way: impl Fn(usize) -> Vector2<f64> + Sync) {
        let parameters = &problem.parameters;
        let term = |i: usize| {
            let (place, way) = (&state.positions[i], way(i));
            [0.0, 0.0, way.perp(&state.velocities[i]), parameters.potential_on(&way, place)]
                .map(|value| value * state.areas[i])
        };
        let sums = parallel::sums(state.positions.len(), &mut self.four, term);
        state.gains.walls += Gain::from_sums(parameters.density, sums);
    }
}

/// What an impulse of a step gives the bodies, which move with the mean of their rates at its ends.
fn of_bodies(problem: &Problem, state: &State, system: &PressureSystem, end: &Motion, impulse: &[f64]) -> Gain {
    let rates = state.motion.velocity.iter().zip(end.velocity.iter()).map(|(first, last)| 0.5 * (first + last));
    Gain::of_bodies(&problem.geometry.bodies, impulse, &system.middle.position, rates)
}
