//! The impulses of one step of the scheme `voronoi`: how far the pressure on walls and bodies is what the water loses.

use super::system::PressureSystem;
use crate::balance::{Momenta, force_of_load};
use crate::parallel;
use crate::problem::Problem;
use crate::state::State;
use crate::walls::FIXED;
use nalgebra::Vector2;

/// The impulses of a step, stage by stage.
#[derive(Debug, Default)]
pub struct Balance {
    momenta: Momenta,
}

impl Balance {
    /// Contacts on the way to the middle of the step, forces, and smoothing; before the pressure acts on the velocities.
    pub fn predicted(&mut self, problem: &Problem, state: &mut State, system: &PressureSystem, smoothed: bool) {
        self.momenta.since(problem, &state.areas, &state.velocities);
        if system.contacts > 0 {
            let all = self.momenta.since(problem, &state.areas, &system.before);
            let bodies = -force_of_load(problem, &system.stopped);
            state.impulses.bodies += bodies;
            state.impulses.walls += all - bodies;
        }
        if smoothed {
            state.impulses.forces += self.momenta.since(problem, &state.areas, &system.smoothed);
            state.impulses.smoothing += self.momenta.since(problem, &state.areas, &system.velocities);
        } else {
            state.impulses.forces += self.momenta.since(problem, &state.areas, &system.velocities);
        }
    }

    /// The pressure, with the force of this step on the bodies \[N/m\].
    pub fn kicked(
        &mut self,
        problem: &Problem,
        state: &mut State,
        system: &PressureSystem,
        on_bodies: Vector2<f64>,
        time_step: f64,
    ) {
        let on_walls = system.force_on_fixed_walls(problem, &state.pressures, &mut self.momenta.partial);
        let (walls, bodies) = (-on_walls * time_step, -on_bodies * time_step);
        state.impulses.walls += walls;
        state.impulses.bodies += bodies;
        state.impulses.projection += self.momenta.since(problem, &state.areas, &state.velocities) - walls - bodies;
    }

    /// The shift.
    pub fn shifted(&mut self, problem: &Problem, state: &mut State) {
        state.impulses.shifting += self.momenta.since(problem, &state.areas, &state.velocities);
    }
}

impl PressureSystem {
    /// Force of the pressure on the fixed walls, without facets that close a cell where no wall is \[N/m\].
    fn force_on_fixed_walls(&self, problem: &Problem, pressures: &[f64], partial: &mut Vec<[f64; 2]>) -> Vector2<f64> {
        let term = |i: usize| {
            let force = self.forces[i] * problem.parameters.density;
            let walls = self.cells.walls.of(i).iter().filter(|wall| wall.panel == FIXED && !wall.is_closure);
            let sum: Vector2<f64> = walls
                .map(|wall| {
                    let facet = &wall.facet;
                    let pressure = pressures[i] + force.dot(&facet.normal) * facet.height;
                    facet.normal * (facet.length() * pressure)
                })
                .sum();
            [sum.x, sum.y]
        };
        let [x, y] = parallel::sums(pressures.len(), partial, term);
        Vector2::new(x, y)
    }
}
