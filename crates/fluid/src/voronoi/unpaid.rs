//! Momentum that particles got and nobody gave, and how it is taken back.
//!
//! Velocities come from the gradient of the pressure, which is exact for a linear pressure on cells of any shape; the forces
//! that cells exchange, and that walls bear, are those of the pressure on facets. The two differ where a particle moves with
//! the area of its cell instead of its own, at free surfaces that are not straight, and on facets that close a cell far from
//! all walls. (In smooth flow by 1e-4 of what is exchanged, in a splash by some per cent.) And the velocity that follows a
//! shifted particle comes from nowhere.
//!
//! What shifts give changes its sign from particle to particle. It is evened out among neighbours, by exchanges of pairs, and
//! taken back there. The rest is taken back from all water alike. Taken back from those nearest to it, too, it drove particles of
//! the surface together in clumps: the exact gradient is what keeps them apart.

use super::facet::Facet;
use super::operators;
use super::system::PressureSystem;
use crate::parallel::{self, CHUNK};
use crate::problem::Problem;
use crate::state::State;
use crate::walls::FIXED;
use nalgebra::Vector2;
use rayon::prelude::*;

/// Least and largest area of a cell over its particle's own whose mass moves with the cell: one beyond is pushed as one of this
/// area, with its weight. A splinter between two walls that close on it would be thrown out at any speed.
pub(super) const MOVED: [f64; 2] = [0.5, 2.0];
/// Share of the difference of their unpaid impulses that two neighbours exchange, twice, if the facet between them is as long
/// as they are apart.
const EXCHANGED: f64 = 0.2;

/// What is taken back of each particle's velocity.
#[derive(Debug, Default)]
pub struct Unpaid {
    taken: Vec<Vector2<f64>>,
    /// Impulses of shifts per density that were exchanged once \[m3/s\].
    once: Vec<Vector2<f64>>,
    partial: Vec<[f64; 3]>,
}

impl PressureSystem {
    /// Area that the water of particle i has in its cell, and the one whose mass moves with it \[m2\].
    fn filled_and_moved(&self, i: usize, volume: f64) -> [f64; 2] {
        let filled = if self.cells.is_isolated(i) { volume } else { self.cells.cells[i].filled };
        [filled, filled.clamp(MOVED[0] * volume, MOVED[1] * volume)]
    }

    /// Velocity that the pressure gives particle i \[m/s\].
    pub fn kick_of(&self, problem: &Problem, state: &State, i: usize, time_step: f64) -> Vector2<f64> {
        let [filled, moved] = self.filled_and_moved(i, state.areas[i]);
        let outside = self.cells.cells[i].free_surface_gradient * self.gas.outside(&self.gas.pressures, i);
        let sum = operators::pressure_difference(&self.cells, i, &state.pressures)
            + self.wall_difference(problem, i)
            + outside;
        (self.forces[i] * (filled - moved) - sum / problem.parameters.density) * (time_step / moved)
    }

    /// Force of the free surface on cell i beyond -p S, less what walls give it where they end at the surface \[N/m\].
    fn unpaid_at_surface(&self, problem: &Problem, pressures: &[f64], i: usize) -> Vector2<f64> {
        let cell = &self.cells.cells[i];
        if !cell.is_open() {
            return Vector2::zeros();
        }
        let beyond = pressures[i] - self.gas.outside(&self.gas.pressures, i);
        let walls = self.cells.walls.of(i).iter().filter(|wall| wall.facet.meets_surface()).map(|wall| {
            let paid = if wall.panel == FIXED { beyond } else { self.expected_beyond(problem, pressures, i) };
            self.push_on_wall(i, &wall.facet, paid, problem.spacing)
        });
        (cell.free_surface_gradient - cell.outward) * beyond + walls.sum::<Vector2<f64>>()
    }
}

/// An impulse of particle i after every pair of neighbours evened out a share of the difference of theirs.
fn evened(system: &PressureSystem, i: usize, impulse: impl Fn(usize) -> Vector2<f64>) -> Vector2<f64> {
    let own = impulse(i);
    let from = |facet: &Facet| (impulse(facet.neighbour as usize) - own) * (EXCHANGED * facet.weight().min(1.0));
    own + system.cells.facets.of(i).iter().map(from).sum::<Vector2<f64>>()
}

impl Unpaid {
    /// Takes back what the pressure gave beyond what was paid, and what the `changes` of velocity of shifted particles give.
    pub fn take_back(
        &mut self,
        state: &mut State,
        system: &PressureSystem,
        problem: &Problem,
        changes: &[Vector2<f64>],
        time_step: f64,
    ) {
        let rest = self.rest(state, system, problem, time_step);
        let State { areas, velocities, .. } = state;
        let Self { taken, once, .. } = self;
        taken.resize(areas.len(), Vector2::zeros());
        once.resize(areas.len(), Vector2::zeros());
        parallel::fill(once, |i| evened(system, i, |j| changes[j] * areas[j]));
        let both = taken.par_iter_mut().zip(velocities).with_min_len(CHUNK).enumerate();
        both.for_each(|(i, (taken, velocity))| {
            let of_all = if system.cells.is_isolated(i) { Vector2::zeros() } else { rest };
            *taken = evened(system, i, |j| once[j]) / areas[i] + of_all;
            *velocity -= *taken;
        });
    }

    /// Velocities that were taken back \[m/s\].
    pub fn taken(&self) -> &[Vector2<f64>] {
        &self.taken
    }

    /// Velocity that all water that touches other water got beyond what was paid \[m/s\].
    fn rest(&mut self, state: &State, system: &PressureSystem, problem: &Problem, time_step: f64) -> Vector2<f64> {
        let per_mass = time_step / problem.parameters.density;
        let term = |i: usize| {
            if system.cells.is_isolated(i) {
                return [0.0; 3];
            }
            let volume = state.areas[i];
            let [filled, moved] = system.filled_and_moved(i, volume);
            let change = state.velocities[i] - system.velocities[i];
            let areas = system.forces[i] * (time_step * (filled - moved)) - change * (moved - volume);
            let pressure = system.unpaid_at_surface(problem, &state.pressures, i)
                - system.unpaid_at_closures(problem, &state.pressures, i);
            let unpaid = areas + pressure * per_mass;
            [unpaid.x, unpaid.y, volume]
        };
        let [x, y, volume] = parallel::sums(state.positions.len(), &mut self.partial, term);
        if volume > 0.0 { Vector2::new(x, y) / volume } else { Vector2::zeros() }
    }
}
