//! Pockets of gas in the pressure system.
//!
//! A pocket is a row of the matrix. The surfaces of cells that border on it are tied to its pressure P instead of to 0, and
//! with its volume V, kappa = gamma p / V and the ties w_i
//!
//!   c (P - P_known) + sum w_i (P - p_i) = rho / dt (sum F_i - sum L n.u_w),      c = rho / (kappa dt^2 (beta + zeta)),
//!
//! where F_i is the rate at which the predicted velocity moves the surface of cell i and the last sum goes over the walls
//! that the gas touches. It says that P over the step is the pressure in its middle, corrected by the change of the rate of
//! the volume, P = p - p_a - kappa dt (beta (V'_new - V'_old) + zeta V'_new): with beta = 1/4 that is the mean of
//! Newmark's trapezoid, without damping and stable at any stiffness. zeta damps what a few cells enclose and the step
//! cannot resolve. A vent adds its flow to the rate of the volume, implicitly. The matrix stays symmetric, and gas of no stiffness is the open air.

mod borders;
mod dry_walls;
mod rows;

use super::operators;
use super::source::surface_rate;
use super::system::PressureSystem;
use crate::gas::{Account, Pocket, Space};
use crate::problem::Problem;
use crate::sensors::stands;
use crate::state::State;
use crate::time_step::TimeStep;
use borders::{Border, border_of};
use dry_walls::Dry;
use nalgebra::{DVector, Matrix2, Vector2};

/// Share of the difference from what its outline measures by which the volume of a pocket is drawn there in a step, and the
/// most that this changes of it.
const DRAWN: f64 = 0.01;
const MOST_DRAWN: f64 = 0.001;
/// Least volume of a pocket that was closed off, in areas of a particle.
const LEAST: f64 = 0.5;

/// What a vent lets through in a step: from a pocket, to another or to the open air, mass per time and pressure \[s\].
#[derive(Debug, Clone, Copy, Default)]
struct Conductance {
    from: Option<usize>,
    to: Option<usize>,
    flow: f64,
}

impl Conductance {
    /// The flow, and the pocket at the other end, if pocket k is at one of its ends.
    fn seen_from(&self, k: usize) -> Option<(f64, Option<usize>)> {
        match (self.from, self.to) {
            (Some(from), to) if from == k => Some((self.flow, to)),
            (from, Some(to)) if to == k => Some((self.flow, from)),
            _ => None,
        }
    }

    /// Mass that leaves its pocket per time with the pressures of pockets \[kg/(m s)\].
    fn mass_flow(&self, pressures: &[f64]) -> f64 {
        let Some(from) = self.from else { return 0.0 };
        self.flow * (pressures[from] - self.to.map_or(0.0, |to| pressures[to]))
    }
}

/// The pockets of a step.
#[derive(Debug, Clone, Default)]
pub struct GasCells {
    space: Space,
    /// Pockets in the middle of the step.
    pub pockets: Vec<Pocket>,
    account: Account,
    borders: Vec<Border>,
    dry: Vec<Dry>,
    /// Ties of each pocket: cell and weight.
    ties: Vec<Vec<(u32, f64)>>,
    vents: Vec<Conductance>,
    /// c of each pocket, with what vents add.
    pub compliance: Vec<f64>,
    /// Right sides but for the accelerations of walls.
    source: Vec<f64>,
    /// Pressures less that of the open air \[Pa\].
    pub pressures: Vec<f64>,
    /// The same with the accelerations expected before the step.
    pub expected: Vec<f64>,
}

impl GasCells {
    /// Number of pockets.
    pub fn count(&self) -> usize {
        self.pockets.len()
    }

    /// Pockets that cell i borders on, with their shares.
    pub fn border(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        border_of(&self.borders, i)
    }

    /// Pressure at the surface of cell i with the pressures of pockets given \[Pa\].
    pub fn outside(&self, pressures: &[f64], i: usize) -> f64 {
        if pressures.is_empty() {
            return 0.0;
        }
        self.border(i).map(|(k, share)| share * pressures[k]).sum()
    }

    /// Share of the surface of cell i that is tied to pockets.
    pub fn tied(&self, i: usize) -> f64 {
        self.border(i).map(|(_, share)| share).sum()
    }

    /// Ties of a pocket: cells and weights.
    pub fn ties(&self, k: usize) -> &[(u32, f64)] {
        &self.ties[k]
    }

    /// Work of a unit pressure of pocket k on every coordinate.
    pub fn work(&self, k: usize) -> &[f64] {
        &self.dry[k].work
    }

    /// The space without water.
    pub fn space(&self) -> &Space {
        &self.space
    }

    /// Fraction of the pull of its ties with which a pocket holds the water: 0 where it gives way, 1 as the open air does.
    pub fn hold(&self, k: usize) -> f64 {
        let ties: f64 = self.ties[k].iter().map(|(_, weight)| weight).sum();
        self.compliance[k] / (self.compliance[k] + ties).max(f64::MIN_POSITIVE)
    }

    /// Right side of pocket k with accelerations of the walls.
    pub fn right_side(&self, density: f64, k: usize, accelerations: &DVector<f64>) -> f64 {
        self.source[k] - density * self.dry[k].opening(accelerations)
    }

    /// Adds the load of the gas on the coordinates of the bodies \[N/m, N m/m, modal\].
    pub fn add_load(&self, load: &mut [f64]) {
        for (dry, pressure) in self.dry.iter().zip(&self.pressures) {
            load.iter_mut().zip(&dry.work).for_each(|(load, work)| *load += pressure * work);
        }
    }

    /// Force of the gas on the fixed walls \[N/m\].
    pub fn force_on_fixed_walls(&self) -> Vector2<f64> {
        self.dry.iter().zip(&self.pressures).map(|(dry, pressure)| dry.fixed * *pressure).sum()
    }
}

impl PressureSystem {
    /// Finds pockets and what they touch in the middle of the step, `half` \[s\] after its start.
    pub(super) fn find_gas(&mut self, problem: &Problem, state: &State, half: f64) {
        let Some(parameters) = &problem.parameters.gas else { return };
        let mut gas = std::mem::take(&mut self.gas);
        gas.space.find(&self.positions, &self.walls, problem.spacing);
        let centres: Vec<_> = gas.space.found().map(|(_, centre)| centre).collect();
        if centres.is_empty() {
            gas.borders.clear();
            gas.dry.clear();
        } else {
            self.find_borders(&mut gas, problem.spacing);
            self.find_dry_walls(&mut gas, problem, &centres);
        }
        let measured = self.measure(&gas, &centres);
        let least = LEAST * problem.spacing * problem.spacing;
        let usable: Vec<_> = measured.iter().map(|volume| volume.max(least)).collect();
        (gas.pockets, gas.account) = state.gas.carried(&gas.space, half, parameters, &usable);
        if state.gas.labels.is_empty() {
            self.start_gas(&mut gas, problem, half);
        }
        for (pocket, &measured) in gas.pockets.iter_mut().zip(&measured) {
            let most = MOST_DRAWN * pocket.volume;
            let way = (DRAWN * (measured - pocket.volume)).clamp(-most, most);
            *pocket = pocket.at(pocket.volume + way, parameters.exponent);
        }
        self.gas = gas;
    }

    /// Pockets at the start: as the scene says then, and half a step of `half` \[s\] later.
    fn start_gas(&self, gas: &mut GasCells, problem: &Problem, half: f64) {
        let Some(parameters) = &problem.parameters.gas else { return };
        let rates = self.volume_rates(gas, &self.before, &self.rates);
        for chamber in &problem.geometry.chambers {
            let at = gas.space.pocket_at(&stands(problem, &chamber.place, chamber.on_body, &self.middle.position));
            if let (Some(k), Some(pressure)) = (at, chamber.pressure) {
                let pocket = &mut gas.pockets[k];
                let mass = pocket.mass * (pressure / pocket.pressure).powf(1.0 / parameters.exponent);
                gas.account.enclosed += mass - pocket.mass;
                (pocket.mass, pocket.pressure, pocket.push) = (mass, pressure, pressure - parameters.ambient);
            }
        }
        for (pocket, rate) in gas.pockets.iter_mut().zip(rates) {
            let begun = Pocket { rate, volume: pocket.volume - half * rate, ..*pocket };
            *pocket = begun.at(pocket.volume, parameters.exponent);
        }
    }

    /// Volumes of the pockets as their outlines say, half the integral of the normal times the place \[m2\].
    fn measure(&self, gas: &GasCells, centres: &[Vector2<f64>]) -> Vec<f64> {
        let mut twice: Vec<_> = gas.dry.iter().map(|dry| dry.volume).collect();
        for i in 0..gas.borders.len() {
            for (k, share) in gas.border(i) {
                let cell = &self.cells.cells[i];
                let surface = cell.outward.dot(&(self.positions[i] - centres[k])) + cell.surface * cell.depth;
                twice[k] -= share * surface;
            }
        }
        twice.iter().map(|twice| 0.5 * twice).collect()
    }

    /// Rates of the volumes of the pockets with these velocities of particles and rates of the bodies' coordinates \[m2/s\].
    fn volume_rates(&self, gas: &GasCells, velocities: &[Vector2<f64>], rates: &DVector<f64>) -> Vec<f64> {
        let mut opening: Vec<_> = gas.dry.iter().map(|dry| dry.opening(rates)).collect();
        for i in 0..gas.borders.len() {
            let mut pockets = gas.border(i).peekable();
            if pockets.peek().is_some() {
                let gradient = operators::velocity_gradient(&self.cells, i, &self.positions, velocities);
                let flux = self.surface_flux(i, &velocities[i], &gradient);
                pockets.for_each(|(k, share)| opening[k] -= share * flux);
            }
        }
        opening
    }

    /// Rate at which a velocity moves the surface of cell i outwards \[m2/s\].
    fn surface_flux(&self, i: usize, velocity: &Vector2<f64>, gradient: &Matrix2<f64>) -> f64 {
        self.cells.cells[i].outward.dot(velocity) + surface_rate(&self.cells, i, gradient)
    }

    /// The gas at a communication point at which nothing was stepped yet, from what was found half a step of `half` \[s\] later.
    pub(super) fn begin_gas(&self, problem: &Problem, state: &mut State, half: f64) {
        let Some(parameters) = &problem.parameters.gas else { return };
        let (own, gas) = (&self.gas, &mut state.gas);
        gas.labels.clone_from(own.space.labels());
        gas.account = own.account;
        let pushing = own.pockets.iter().zip(&own.pressures).map(|(pocket, &push)| Pocket { push, ..*pocket });
        gas.pockets = pushing.map(|pocket| pocket.after(-half, parameters.exponent)).collect();
        gas.begin();
        for (chamber, reading) in problem.geometry.chambers.iter().zip(&mut gas.chambers) {
            let at = own.space.pocket_at(&stands(problem, &chamber.place, chamber.on_body, &self.middle.position));
            reading.add(at.map(|k| &gas.pockets[k]), 1.0);
        }
    }

    /// The gas after the step, with the velocities that it leaves and the rates of the bodies' coordinates at its end.
    pub(super) fn finish_gas(&self, problem: &Problem, state: &mut State, rates: &DVector<f64>, step: TimeStep) {
        let Some(parameters) = &problem.parameters.gas else { return };
        let own = &self.gas;
        let opening = self.volume_rates(own, &state.velocities, rates);
        let gas = &mut state.gas;
        gas.labels.clone_from(own.space.labels());
        gas.account = own.account;
        gas.pockets.clear();
        let mut flows = vec![0.0; own.count()];
        for (vent, mean) in own.vents.iter().zip(&mut gas.vents) {
            let flow = vent.mass_flow(&own.pressures);
            *mean += flow * step.share;
            vent.from.iter().for_each(|&from| flows[from] += flow);
            vent.to.iter().for_each(|&to| flows[to] -= flow);
        }
        for (k, pocket) in own.pockets.iter().enumerate() {
            let moving = Pocket { rate: opening[k], flow: flows[k], push: own.pressures[k], ..*pocket };
            let after = moving.after(0.5 * step.length, parameters.exponent);
            gas.account.vented += moving.mass - after.mass;
            gas.account.work += moving.push * moving.rate * step.length;
            gas.pockets.push(after);
        }
        for (chamber, reading) in problem.geometry.chambers.iter().zip(&mut gas.chambers) {
            let at = own.space.pocket_at(&stands(problem, &chamber.place, chamber.on_body, &self.middle.position));
            reading.add(at.map(|k| &gas.pockets[k]), step.share);
        }
    }
}
