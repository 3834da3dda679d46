//! The right side of the pressure equation: what the areas of cells ask for.
//!
//! Areas are right in the middle of every step, so that their rate R(u) with the velocity u after a step must be minus
//! the second-order change over the way to the middle of the next. This change follows from the velocity gradient,
//! dt V det grad u, which is exact in linear flow and inside the water, but not beside walls and surfaces; or from the
//! rate that the old velocity has on the new cells, less what it had on the old ones, which holds everywhere but has the
//! noise of cells that change their neighbours. The mean of both is taken. Modelled alone, its error is the same in every
//! step of one length, and shows as a false pressure when the length changes. Measured as a difference, an error of the
//! velocity itself, which is in both rates, drops out: nothing of it comes back in the next step. (To ask for minus the
//! old velocity's rate, the trapezoidal rule, gives every error back with the other sign, and rings.)
//!
//! The compact matrix A is not D G / V, so that a step leaves a rest of the rate that it asked for, which the next ones
//! work off: in steady flow the rest is in proportion to dt, and its share in the pressure is rest / dt. A step of another
//! length would find another rest; the difference is carried over, within the rest itself, and not asked for at once.

use super::cells::Cells;
use super::facet::Facet;
use super::operators;
use super::system::PressureSystem;
use super::unit_pressures::UnitPressures;
use crate::parallel;
use crate::parameters::VoronoiParameters;
use crate::problem::Problem;
use crate::state::{AreaRate, State};
use crate::time_step::TimeStep;
use crate::walls::FIXED;
use nalgebra::{DVector, Matrix2, Vector2};

/// Share of the second-order change that is measured.
const MEASURED: f64 = 0.5;
/// Largest rate that is carried over a change of the step, over (dt + dt_old) V |grad u|^2.
const LARGEST_CARRIED: f64 = 20.0;
/// Share of the carried rate that remains after a step.
const KEPT: f64 = 0.99;
/// What one step may change of the rate of an area at one and the same velocity, over V |grad u|, beyond twice what the motion
/// in the step can change; more is a jump. Waves, drops and sloshing change up to 0.1 of it.
const JUMP: f64 = 0.25;
/// Largest share of its area that a cell is taken to be too large or too small by.
const LARGEST_EXCESS: f64 = 0.5;

/// What the area of a cell asks for in a step \[m2/s\].
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked {
    /// Rate of the area with the velocity after the step.
    rate: f64,
    /// What the last step left of its rate beyond what one as long as this one would have left.
    carried: f64,
    /// Whether the cell changed faster than a step can follow: a facet that opens or closes, a neighbour that comes or goes.
    jumps: bool,
}

impl PressureSystem {
    /// What every area asks for.
    pub(super) fn ask(&mut self, voronoi: &VoronoiParameters, state: &State, step: TimeStep) {
        let time_step = step.length;
        let share = voronoi.alpha * (time_step / step.ordinary).min(1.0);
        let mut asked = std::mem::take(&mut self.asked);
        asked.resize(self.positions.len(), Asked::default());
        let system = &*self;
        parallel::fill(&mut asked, |i| {
            if system.cells.is_isolated(i) {
                return Asked::default();
            }
            let volume = state.areas[i];
            let excess = system.cells.cells[i].area - volume;
            let excess = excess.clamp(-LARGEST_EXCESS * volume, LARGEST_EXCESS * volume);
            let asked = system.second_order(i, state, time_step);
            Asked { rate: asked.rate - share * excess / time_step, ..asked }
        });
        self.jumps = asked.iter().filter(|asked| asked.jumps).count() as u64;
        self.asked = asked;
    }

    /// Minus the second-order change of the area over the step, and the rest that is carried over a change of its length.
    fn second_order(&self, i: usize, state: &State, time_step: f64) -> Asked {
        let gradient = &self.gradients[i];
        let second = self.cells.cells[i].trust() * state.areas[i] * gradient.determinant();
        let last_step = state.time_step;
        if last_step == 0.0 {
            return Asked { rate: -second * time_step, ..Asked::default() };
        }
        let AreaRate { left, asked, due } = state.area_rates[i];
        let both = time_step + last_step;
        let now = self.area_rate(i, &self.before, gradient, &self.rates);
        let scale = state.areas[i] * gradient.norm_squared();
        let measured = (now - left) / both;
        let change = second + MEASURED * (measured - second).clamp(-scale, scale);
        // Never more than the rest itself: what is carried ends with it, and does not outlive a splash.
        let rest = left - asked;
        let carried = due * time_step / last_step - rest;
        let bound = (LARGEST_CARRIED * both * scale).min(rest.abs());
        let jumps = self.jumps_by((now - left) / state.areas[i], i, both);
        Asked { rate: -change * time_step, carried: KEPT * carried.clamp(-bound, bound), jumps }
    }

    /// Whether a change of the relative rate of the area of cell i is more than a step can follow, with the gradient of the velocity
    /// and where this vanishes, at the turn of a flow, with the steepest slope to a neighbour.
    fn jumps_by(&self, change: f64, i: usize, both: f64) -> bool {
        let exceeds = |slope: f64| change.abs() > (JUMP + 2.0 * both * slope) * slope;
        exceeds(self.gradients[i].norm()) && {
            let slope =
                |facet: &Facet| (self.before[facet.neighbour as usize] - self.before[i]).norm() / (2.0 * facet.height);
            exceeds(self.cells.facets.of(i).iter().map(slope).fold(0.0, f64::max))
        }
    }

    /// Rate of the area of cell i with the given velocities, the gradient of the velocity there, and rates of the body.
    fn area_rate(&self, i: usize, velocities: &[Vector2<f64>], gradient: &Matrix2<f64>, rates: &DVector<f64>) -> f64 {
        let cells = &self.cells;
        let fixed = cells.walls.of(i).iter().filter(|wall| wall.panel == FIXED && !wall.is_closure);
        let fixed = fixed.map(|wall| velocities[i].dot(&wall.facet.normal) * wall.facet.length());
        let moving = self.unit_pressures.of(i).map(|(moving, work)| {
            let facet = &moving.wall.facet;
            facet.length() * (velocities[i].dot(&facet.normal) - UnitPressures::normal_rate(work, rates))
        });
        operators::area_rate(cells, i, velocities) + surface_rate(cells, i, gradient)
            - fixed.sum::<f64>()
            - moving.sum::<f64>()
    }

    /// Records the rates that the velocities after the step have, and what is due of them.
    pub fn record_rates(&self, out: &mut [AreaRate], velocities: &[Vector2<f64>], rates: &DVector<f64>) {
        let (cells, positions) = (&self.cells, &self.positions);
        parallel::fill(out, |i| {
            if cells.is_isolated(i) {
                return AreaRate::default();
            }
            let open = cells.cells[i].is_open();
            let gradient = || operators::velocity_gradient(cells, i, positions, velocities);
            let gradient = if open { gradient() } else { Matrix2::zeros() };
            let left = self.area_rate(i, velocities, &gradient, rates);
            let Asked { rate, carried, .. } = self.asked[i];
            AreaRate { left, asked: rate, due: left - rate + carried }
        });
    }

    /// Right side of A p = b, from the demand that the rates of areas are what is asked for:
    /// D u* - asked = dt / rho (-A p).
    pub(super) fn build_source(&mut self, problem: &Problem, time_step: f64) {
        let density = problem.parameters.density;
        let (cells, velocities, gradients) = (&self.cells, &self.velocities, &self.gradients);
        let (forces, rates, unit_pressures, asked) = (&self.forces, &self.rates, &self.unit_pressures, &self.asked);
        self.source.resize(self.positions.len(), 0.0);
        parallel::fill(&mut self.source, |i| {
            if cells.is_isolated(i) {
                return 0.0;
            }
            let rate = operators::area_rate(cells, i, velocities) + surface_rate(cells, i, &gradients[i]);
            let mut value = -density * (rate - asked[i].rate + asked[i].carried) / time_step;
            // What the wall must do beyond the body force: closures move with the water, fixed walls stop it.
            for wall in cells.walls.of(i).iter().filter(|wall| wall.panel == FIXED) {
                let normal = wall.facet.normal * (density * wall.facet.length());
                value += if wall.is_closure { forces[i].dot(&normal) } else { velocities[i].dot(&normal) / time_step };
            }
            for (moving, work) in unit_pressures.of(i) {
                let facet = &moving.wall.facet;
                let closing = velocities[i].dot(&facet.normal) - UnitPressures::normal_rate(work, rates);
                value += density * facet.length() * closing / time_step;
            }
            value
        });
    }
}

/// What moves the free surface of cell i beyond the velocity of its particle: the velocity at the surface. Round a tip
/// or a drop the surface has no one direction, and the gradient comes from too few neighbours.
pub(super) fn surface_rate(cells: &Cells, i: usize, gradient: &Matrix2<f64>) -> f64 {
    let cell = &cells.cells[i];
    let length = cell.outward.norm();
    if length == 0.0 {
        return 0.0;
    }
    cell.trust() * cell.outward.dot(&(gradient * cell.outward)) * cell.depth / length
}
