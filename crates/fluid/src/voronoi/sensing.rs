//! What sensors read in a step of the scheme `voronoi`.

use super::facet::Facet;
use super::system::PressureSystem;
use super::tessellate::GRID;
use crate::gas::{NOTHING, OPEN};
use crate::parameters::Probe;
use crate::pressure_field::{PressureField, REACH};
use crate::problem::Problem;
use crate::sensors::{ON_WALL, Sensor, read_in_water, stands};
use crate::time_step::TimeStep;
use crate::walls::{FIXED, Segment};
use nalgebra::Vector2;

/// Least cosine of the angle between a patch and a facet that counts to it.
const PARALLEL: f64 = 0.9;
/// Farthest distance of a facet from the line of a patch, in spacings.
const ALIKE: f64 = 0.3;

/// A patch on a wall: places along the wall from `low` to `high` \[m\].
struct Patch<'a> {
    wall: &'a Segment,
    low: f64,
    high: f64,
}

impl Patch<'_> {
    /// Length of the part of the patch that a facet of a particle at `place` covers \[m\].
    fn covered(&self, place: &Vector2<f64>, facet: &Facet, spacing: f64) -> f64 {
        let far = self.wall.local(&(place + facet.middle())).0.abs() > ALIKE * spacing;
        if far || facet.normal.dot(&self.wall.normal) < PARALLEL {
            return 0.0;
        }
        let [a, b] = facet.ends().map(|end| self.wall.local(&(place + end)).1);
        (a.max(b).min(self.high) - a.min(b).max(self.low)).max(0.0)
    }
}

impl PressureSystem {
    /// Adds the readings of this step.
    pub fn sense(&self, problem: &Problem, pressures: &[f64], step: TimeStep, sensors: &mut [Sensor]) {
        for (sensor, probe) in sensors.iter_mut().zip(&problem.geometry.probes) {
            sensor.add(self.read(problem, pressures, probe), step.share, step.length, probe.threshold);
        }
    }

    /// Pressure at a probe \[Pa\]: on a wall the force on the patch over its area, with no pressure where it is dry.
    pub fn read(&self, problem: &Problem, pressures: &[f64], probe: &Probe) -> f64 {
        let place = stands(problem, &probe.place, probe.on_body, &self.middle.position);
        match self.patch(problem, &place, probe.size) {
            Some(patch) => self.read_on_wall(problem, pressures, &place, &patch),
            None => {
                let field = PressureField {
                    grid: &self.cells.grid,
                    rings: (REACH / GRID).ceil() as i64,
                    positions: &self.positions,
                    pressures,
                    parameters: &problem.parameters,
                    time: self.time,
                    spacing: problem.spacing,
                    walls: &self.walls,
                };
                read_in_water(problem, &field, probe, &self.middle.position)
            }
        }
    }

    /// The patch of a probe that stands on a wall; it ends where the wall does.
    fn patch(&self, problem: &Problem, place: &Vector2<f64>, size: f64) -> Option<Patch<'_>> {
        let near = self.walls.candidates(place).iter().map(|&index| &self.walls.segments[index as usize]);
        let reach = (ON_WALL * problem.spacing).powi(2);
        let on = near.filter(|segment| segment.squared_distance(place) < reach);
        let wall = on.min_by(|a, b| a.squared_distance(place).total_cmp(&b.squared_distance(place)))?;
        let chain = self.walls.chains.get(wall.chain as usize)?;
        let (middle, half) = (wall.local(place).1, 0.5 * if size > 0.0 { size } else { problem.spacing });
        let (first, last) = (-wall.arc, chain.length - wall.arc);
        let (low, high) = ((middle - half).clamp(first, last), (middle + half).clamp(first, last));
        (high > low).then_some(Patch { wall, low, high })
    }

    fn read_on_wall(&self, problem: &Problem, pressures: &[f64], place: &Vector2<f64>, patch: &Patch) -> f64 {
        let (spacing, size) = (problem.spacing, patch.high - patch.low);
        let rings = ((0.5 * size / spacing + 2.0) / GRID).ceil() as i64;
        let (mut force, mut dry) = (0.0, size);
        self.cells.grid.for_each_within(place, rings, |i| {
            if self.cells.is_isolated(i) {
                return;
            }
            let fixed = self.cells.walls.of(i).iter().filter(|wall| wall.panel == FIXED && !wall.is_closure);
            for wall in fixed {
                let slope = problem.parameters.density * self.forces[i].dot(&wall.facet.normal);
                let covered = patch.covered(&self.positions[i], &wall.facet, spacing);
                dry -= covered;
                force += covered * (pressures[i] + slope * wall.facet.height);
            }
            for (moving, work) in self.unit_pressures.of(i) {
                let facet = &moving.wall.facet;
                let covered = patch.covered(&self.positions[i], facet, spacing);
                if covered > 0.0 {
                    let slope = self.wall_slope(problem, moving, work, &self.accelerations);
                    dry -= covered;
                    force += covered * (pressures[i] + slope * facet.height);
                }
            }
        });
        (force + self.read_gas(patch, dry.max(0.0), spacing)) / size
    }

    /// Force of gas on a length of a patch that is dry \[N/m\].
    fn read_gas(&self, patch: &Patch, dry: f64, spacing: f64) -> f64 {
        if self.gas.pressures.is_empty() {
            return 0.0;
        }
        match self.gas_before(self.gas.space(), patch.wall, 0.5 * (patch.low + patch.high), spacing) {
            NOTHING | OPEN => 0.0,
            label => self.gas.pressures[label as usize - 1] * dry,
        }
    }
}
