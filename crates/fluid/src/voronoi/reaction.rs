//! What walls and bodies get of the pressure: as much as the water loses to them.
//!
//! A facet on a wall has the pressure p + s h at its foot, with the slope s that the wall's acceleration needs. The pressure
//! along the facet is not constant either; with a linear one its moment puts a force along the wall on the cell, s times the
//! integral of the place along the facet, which alternates from cell to cell and adds up to one at the ends of a straight
//! wall: the wall gets it, too. On bodies s is there that of the acceleration expected before the step, so that the added mass
//! has no part in it. What facets that close a cell where no wall is bear goes to the wall nearest to the cell.

use super::cells::WallFacet;
use super::facet::{Facet, turn};
use super::system::PressureSystem;
use super::unit_pressures::{MovingFacet, UnitPressures};
use crate::parallel;
use crate::problem::Problem;
use crate::walls::FIXED;
use kinematics::SurfacePoint;
use nalgebra::{DVector, Vector2};

/// Force on a facet with the pressure at the particle \[Pa\] and its slopes at the foot and along the facet \[Pa/m\].
fn force(facet: &Facet, pressure: f64, slope: f64, slope_along: f64) -> Vector2<f64> {
    facet.normal * (facet.length() * (pressure + slope * facet.height))
        + turn(&facet.normal) * (slope_along * facet.moment_along())
}

impl PressureSystem {
    /// Sum over the wall facets of cell i of their pressure slope times length and arm: what walls add to G p \[N/m\].
    pub fn wall_difference(&self, problem: &Problem, i: usize) -> Vector2<f64> {
        if self.cells.walls.of(i).is_empty() || self.cells.is_isolated(i) {
            return Vector2::zeros();
        }
        let fixed = self.cells.walls.of(i).iter().filter(|wall| wall.panel == FIXED).map(|wall| {
            let slope = self.weight_slope(problem, i, &wall.facet);
            force(&wall.facet, 0.0, slope, slope)
        });
        let moving = self.unit_pressures.of(i).map(|(moving, work)| {
            let [slope, along] =
                [&self.accelerations, &self.expected].map(|a| self.wall_slope(problem, moving, work, a));
            force(&moving.wall.facet, 0.0, slope, along)
        });
        fixed.sum::<Vector2<f64>>() + moving.sum::<Vector2<f64>>()
    }

    /// Normal pressure gradient that the body force alone makes on a facet of cell i \[Pa/m\].
    fn weight_slope(&self, problem: &Problem, i: usize, facet: &Facet) -> f64 {
        problem.parameters.density * self.forces[i].dot(&facet.normal)
    }

    /// Normal pressure gradient on a moving facet with these `accelerations` of the coordinates \[Pa/m\].
    pub fn wall_slope(
        &self,
        problem: &Problem,
        moving: &MovingFacet,
        work: &[f64],
        accelerations: &DVector<f64>,
    ) -> f64 {
        let force = self.forces[moving.particle as usize].dot(&moving.wall.facet.normal);
        problem.parameters.density * (force - UnitPressures::normal_rate(work, accelerations))
    }

    /// What the step puts on bodies whatever their acceleration: forces along walls, and those of facets that close cells
    /// near them, with the pressures `expected`.
    pub fn find_steady_load(&mut self, problem: &Problem, expected: &[f64]) {
        let mut load = std::mem::take(&mut self.steady_load);
        load.clear();
        load.resize(problem.coordinates(), 0.0);
        if !load.is_empty() {
            for (moving, work) in self.unit_pressures.facets_with_work() {
                let along = self.wall_slope(problem, moving, work, &self.expected);
                let (i, facet) = (moving.particle as usize, &moving.wall.facet);
                let beyond = expected[i] - self.gas.outside(&self.gas.expected, i);
                let push = self.push_on_wall(i, facet, beyond, problem.spacing);
                let force = turn(&facet.normal) * (along * facet.moment_along()) + push;
                self.add_on_panel(problem, moving.wall.panel, moving.wall.fraction, force, &mut load);
            }
            for (i, &pressure) in expected.iter().enumerate() {
                for wall in self.closures(i).filter(|_| !self.cells.is_isolated(i)) {
                    let Some((panel, fraction)) = self.nearest_wall(i) else { continue };
                    let slope = self.weight_slope(problem, i, &wall.facet);
                    let push = force(&wall.facet, pressure, slope, slope);
                    self.add_on_panel(problem, panel, fraction, push, &mut load);
                }
            }
        }
        self.steady_load = load;
    }

    /// What a facet on a wall bears beyond the pressure at its particle where it ends at the free surface: the `pressure` beyond
    /// the one outside falls to 0 there \[N/m\].
    pub fn push_on_wall(&self, i: usize, facet: &Facet, pressure: f64, spacing: f64) -> Vector2<f64> {
        let cell = &self.cells.cells[i];
        if !cell.is_open() || !facet.meets_surface() {
            return Vector2::zeros();
        }
        let Some(normal) = cell.outward.try_normalize(1e-6 * spacing) else { return Vector2::zeros() };
        let tangent = turn(&normal);
        let scale = -0.5 * tangent.dot(&facet.normal).signum() * cell.flatness() * pressure / cell.depth;
        let square = |place: f64| facet.height * facet.height + place * place - 0.5 * spacing * spacing;
        tangent * (scale * facet.surface_shares().map(|(place, share)| share * square(place)).sum::<f64>())
    }

    fn add_on_panel(&self, problem: &Problem, panel: u32, fraction: f64, force: Vector2<f64>, load: &mut [f64]) {
        let Some(&[start, end]) = problem.layout.panels.get(panel as usize) else { return };
        let Some(at) = SurfacePoint::between(start, end, fraction) else { return };
        problem.geometry.bodies.add_force(at, &self.middle.position, force, load);
    }

    fn closures(&self, i: usize) -> impl Iterator<Item = &WallFacet> {
        self.cells.walls.of(i).iter().filter(|wall| wall.is_closure)
    }

    /// Panel and place on it of the wall nearest to particle i; none where there is none within reach.
    fn nearest_wall(&self, i: usize) -> Option<(u32, f64)> {
        let near = self.proximities.of(i).iter();
        let nearest = near.min_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()))?;
        let segment = &self.walls.segments[nearest.segment as usize];
        let along = segment.local(&self.positions[i]).1;
        Some((segment.panel, (along / segment.length).clamp(0.0, 1.0)))
    }

    /// Force on the facets that close cell i, as far as no wall and no body gets it \[N/m\].
    pub fn unpaid_at_closures(&self, problem: &Problem, pressures: &[f64], i: usize) -> Vector2<f64> {
        if self.cells.walls.of(i).is_empty() || self.cells.is_isolated(i) {
            return Vector2::zeros();
        }
        let of_closure = |wall: &WallFacet| match self.nearest_wall(i) {
            Some((FIXED, _)) => Vector2::zeros(),
            Some(_) => force(&wall.facet, pressures[i] - self.expected_pressure(problem, pressures, i), 0.0, 0.0),
            None => {
                let slope = self.weight_slope(problem, i, &wall.facet);
                force(&wall.facet, pressures[i], slope, slope)
            }
        };
        self.closures(i).map(of_closure).sum()
    }

    /// The pressure that the bodies' steady load was found with \[Pa\].
    pub fn expected_pressure(&self, problem: &Problem, pressures: &[f64], i: usize) -> f64 {
        if problem.geometry.active.is_empty() { pressures[i] } else { self.base[i] }
    }

    /// The same beyond what the gas outside has.
    pub fn expected_beyond(&self, problem: &Problem, pressures: &[f64], i: usize) -> f64 {
        let gas = if problem.geometry.active.is_empty() { &self.gas.pressures } else { &self.gas.expected };
        self.expected_pressure(problem, pressures, i) - self.gas.outside(gas, i)
    }

    /// Finds the load of the pressure on the moving panels, by virtual work.
    pub fn find_body_load(&mut self, problem: &Problem, pressures: &[f64]) {
        let mut load = std::mem::take(&mut self.body_load);
        load.clone_from(&self.steady_load);
        for (moving, work) in self.unit_pressures.facets_with_work() {
            let facet = &moving.wall.facet;
            let slope = self.wall_slope(problem, moving, work, &self.accelerations);
            let force = (pressures[moving.particle as usize] + slope * facet.height) * facet.length();
            load.iter_mut().zip(work).for_each(|(load, work)| *load += force * work);
        }
        self.water_load.clone_from(&load);
        self.gas.add_load(&mut load);
        self.body_load = load;
    }

    /// Force of the water on the fixed walls, and its moment about the origin \[N/m, N m/m\].
    pub fn force_on_fixed_walls(
        &self,
        problem: &Problem,
        pressures: &[f64],
        partial: &mut Vec<[f64; 3]>,
    ) -> (Vector2<f64>, f64) {
        let term = |i: usize| {
            let mut sum = [0.0; 3];
            let walls = self.cells.walls.of(i);
            if walls.is_empty() || self.cells.is_isolated(i) {
                return sum;
            }
            let outside = self.gas.outside(&self.gas.pressures, i);
            for wall in walls.iter().filter(|wall| wall.panel == FIXED) {
                if wall.is_closure && self.nearest_wall(i).is_none_or(|(panel, _)| panel != FIXED) {
                    continue;
                }
                let slope = self.weight_slope(problem, i, &wall.facet);
                let force = force(&wall.facet, pressures[i], slope, slope)
                    + self.push_on_wall(i, &wall.facet, pressures[i] - outside, problem.spacing);
                let moment = (self.positions[i] + wall.facet.middle()).perp(&force);
                sum.iter_mut().zip([force.x, force.y, moment]).for_each(|(sum, value)| *sum += value);
            }
            sum
        };
        let [x, y, moment] = parallel::sums(pressures.len(), partial, term);
        (Vector2::new(x, y), moment)
    }
}
