//! The rows of the pockets: ties, compliances, right sides, vents.

use super::{Conductance, GasCells, border_of};
use crate::gas::{GasParameters, Pocket};
use crate::linear::SolveParameters;
use crate::parallel;
use crate::parameters::Vent;
use crate::problem::Problem;
use crate::sensors::stands;
use crate::voronoi::system::PressureSystem;

/// Share of the change of the rate of the volume that acts within the step.
const TRAPEZOID: f64 = 0.25;
/// Least tolerance of a solve with pockets: rounding allows no less.
const LEAST_TOLERANCE: f64 = 1e-13;
/// Pressure difference below which the flow through a vent is taken as linear \[Pa\].
const LAMINAR: f64 = 0.01;

/// Share of what happens within a step, between `from` and half more, by how far the step resolves it.
fn within(from: f64, unresolved: f64) -> f64 {
    from + 0.5 * unresolved / (1.0 + unresolved)
}

impl PressureSystem {
    /// Ties, compliances and right sides of the pockets, once velocities are predicted.
    pub(in crate::voronoi) fn tie_gas(&mut self, problem: &Problem, time_step: f64) {
        let Some(parameters) = &problem.parameters.gas else { return };
        let mut gas = std::mem::take(&mut self.gas);
        let leaving = self.tie_cells(&mut gas);
        let vents = problem.geometry.vents.iter();
        gas.vents = vents.map(|vent| self.conductance(&gas, problem, parameters, vent)).collect();
        gas.compliance.clear();
        gas.source.clear();
        let density = problem.parameters.density;
        for (k, pocket) in gas.pockets.iter().enumerate() {
            let ties: f64 = gas.ties[k].iter().map(|(_, weight)| weight).sum();
            let stiffness = parameters.exponent * pocket.pressure / pocket.volume;
            let share = within(TRAPEZOID, (stiffness * time_step * time_step * ties / density).powi(2));
            let mut compliance = density / (stiffness * time_step * time_step * share);
            let known = pocket.pressure - parameters.ambient + stiffness * time_step * TRAPEZOID * pocket.rate;
            let walls = gas.dry[k].opening(&self.rates);
            let mut source = compliance * known + density / time_step * (leaving[k] - walls);
            for (flow, other) in gas.vents.iter().flat_map(|vent| vent.seen_from(k)) {
                let per_volume = flow * pocket.volume / pocket.mass;
                let vented = within(0.5, stiffness * time_step * per_volume);
                let tie = density * vented * per_volume / (time_step * share);
                compliance += tie;
                source += tie * other.map_or(0.0, |other: usize| gas.pockets[other].push);
            }
            gas.compliance.push(compliance);
            gas.source.push(source);
        }
        self.gas = gas;
    }

    /// Ties cells to the pockets that they border on; the rates at which they leave them room \[m2/s\].
    fn tie_cells(&self, gas: &mut GasCells) -> Vec<f64> {
        let GasCells { pockets, borders, ties, .. } = gas;
        ties.resize_with(pockets.len(), Vec::new);
        ties.iter_mut().for_each(Vec::clear);
        let mut leaving = vec![0.0; pockets.len()];
        for i in 0..borders.len() {
            for (k, share) in border_of(borders, i) {
                ties[k].push((i as u32, share * self.cells.cells[i].air_tie()));
                leaving[k] += share * self.surface_flux(i, &self.velocities[i], &self.gradients[i]);
            }
        }
        leaving
    }

    /// What a vent lets through, by the pressures of the last step: the flow of an orifice, C A sqrt(2 rho dp), over dp.
    fn conductance(&self, gas: &GasCells, problem: &Problem, parameters: &GasParameters, vent: &Vent) -> Conductance {
        let pocket = |place| gas.space.pocket_at(&stands(problem, place, vent.on_body, &self.middle.position));
        let Some(from) = pocket(&vent.place) else { return Conductance::default() };
        let to = match &vent.to {
            Some(place) => match pocket(place) {
                Some(to) if to != from => Some(to),
                _ => return Conductance::default(),
            },
            None => None,
        };
        let density = |pocket: &Pocket| pocket.mass / pocket.volume;
        let (own, other) = (&gas.pockets[from], to.map(|to| &gas.pockets[to]));
        let drop = own.push - other.map_or(0.0, |other| other.push);
        let upstream = if drop > 0.0 { density(own) } else { other.map_or(parameters.density, density) };
        let flow = vent.discharge * vent.area * (2.0 * upstream / drop.abs().max(LAMINAR)).sqrt();
        Conductance { from: Some(from), to, flow }
    }

    /// How cells are tied to zero, by way of pockets too as far as these do not give way; none without pockets.
    pub(in crate::voronoi) fn held_by_gas(&self) -> Option<Vec<f64>> {
        let gas = &self.gas;
        (gas.count() > 0).then(|| {
            let held: Vec<_> = (0..gas.count()).map(|k| gas.hold(k)).collect();
            let mut sums = self.matrix.row_sums[..self.positions.len()].to_vec();
            parallel::update(&mut sums, |i, sum| {
                sum + gas.border(i).map(|(k, share)| share * held[k]).sum::<f64>() * self.cells.cells[i].air_tie()
            });
            sums
        })
    }

    /// The parameters of the solver, with a tolerance of what the water asks for: the right side of pockets is their pressure
    /// times their compliance, and larger by orders.
    pub(in crate::voronoi) fn tolerance_beside_gas(
        &self,
        parameters: &SolveParameters,
        right_side: &[f64],
    ) -> SolveParameters {
        let mut parameters = parameters.clone();
        let (water, gas) = right_side.split_at(self.positions.len());
        if !gas.is_empty() {
            let square = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
            let share = (square(water) / (square(water) + square(gas)).max(f64::MIN_POSITIVE)).sqrt();
            parameters.tolerance = (parameters.tolerance * share).max(LEAST_TOLERANCE);
        }
        parameters
    }
}
