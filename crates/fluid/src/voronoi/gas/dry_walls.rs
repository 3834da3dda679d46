//! Which walls the gas touches.

use super::GasCells;
use crate::gas::{NOTHING, OPEN, Space};
use crate::problem::Problem;
use crate::voronoi::system::PressureSystem;
use crate::walls::{FIXED, Segment};
use kinematics::SurfacePoint;
use nalgebra::{DVector, Vector2};

/// Distance in spacings in front of a wall at which gas touches it, and how far from there its nearest node stands.
const IN_FRONT: f64 = 0.6;
const NEAREST: f64 = 1.0;
/// Gap between wet facets in spacings below which there is no gas.
const SLIVER: f64 = 1e-6;

/// What a pocket touches of walls.
#[derive(Debug, Clone, Default)]
pub struct Dry {
    /// Integral of the normal into fixed walls \[m\].
    pub fixed: Vector2<f64>,
    /// Work of a unit pressure on the walls of bodies, by coordinate.
    pub work: Vec<f64>,
    /// Integral of the normal times the place beyond the pocket's centre \[m2\].
    pub volume: f64,
}

impl Dry {
    /// Rate at which the walls move away from the gas with these rates of the bodies' coordinates \[m2/s\].
    pub fn opening(&self, rates: &DVector<f64>) -> f64 {
        self.work.iter().zip(rates.iter()).map(|(work, rate)| work * rate).sum()
    }
}

/// A dry part of a wall: from and to, from its start \[m\], and the label of the gas in front of it.
struct Part {
    interval: [f64; 2],
    label: u32,
}

impl PressureSystem {
    /// What every pocket touches of walls: the gaps between wet facets, in parts of at most a spacing, each with the gas in
    /// front of it. What overlapping facets and slivers leave of a wall is shared by its parts: the pressure of a closed
    /// compartment adds up to nothing.
    pub(super) fn find_dry_walls(&self, gas: &mut GasCells, problem: &Problem, centres: &[Vector2<f64>]) {
        let size = problem.coordinates();
        gas.dry = vec![Dry { work: vec![0.0; size], ..Dry::default() }; centres.len()];
        let (mut parts, mut wet) = (Vec::new(), self.wet_intervals());
        for (segment, wet) in self.walls.segments.iter().zip(&mut wet) {
            self.label_gaps(&gas.space, segment, wet, problem.spacing, &mut parts);
            if parts.iter().all(|part| part.label == NOTHING || part.label == OPEN) {
                continue;
            }
            let length = segment.length;
            let all = wet.iter().copied().chain(parts.iter().map(|part| part.interval));
            let rest = all.fold([length, 0.5 * length], |rest, [from, to]| {
                [rest[0] - (to - from), rest[1] - (to - from) * 0.5 * (from + to) / length]
            });
            let share = 1.0 / parts.len() as f64;
            for part in parts.iter().filter(|part| part.label != OPEN) {
                let [from, to] = part.interval;
                let moment = (to - from) * 0.5 * (from + to) / length;
                let dry = [to - from + share * rest[0], moment + share * rest[1]];
                let pocket = part.label as usize - 1;
                self.add_dry(problem, segment, dry, &centres[pocket], &mut gas.dry[pocket]);
            }
        }
    }

    /// Where each wall is wet, from its start \[m\].
    fn wet_intervals(&self) -> Vec<Vec<[f64; 2]>> {
        let mut wet = vec![Vec::new(); self.walls.segments.len()];
        for i in (0..self.positions.len()).filter(|&i| !self.cells.is_isolated(i)) {
            for wall in self.cells.walls.of(i).iter().filter(|wall| !wall.is_closure) {
                let middle = wall.fraction * self.walls.segments[wall.segment as usize].length;
                let half = 0.5 * wall.facet.length();
                wet[wall.segment as usize].push([middle - half, middle + half]);
            }
        }
        wet
    }

    /// The gaps between wet intervals of a wall in parts with their gas; those in front of which none is seen take the one of the
    /// nearest part of their gap.
    fn label_gaps(&self, space: &Space, segment: &Segment, wet: &mut [[f64; 2]], spacing: f64, parts: &mut Vec<Part>) {
        parts.clear();
        wet.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut from = 0.0;
        for [begin, end] in wet.iter().copied().chain([[segment.length; 2]]) {
            let gap = begin - from;
            if gap > SLIVER * spacing {
                let first = parts.len();
                let count = (gap / spacing).ceil();
                for k in 0..count as usize {
                    let interval = [k as f64, k as f64 + 1.0].map(|k| from + gap * k / count);
                    let label = self.gas_before(space, segment, 0.5 * (interval[0] + interval[1]), spacing);
                    parts.push(Part { interval, label });
                }
                let seen: Vec<_> = (first..parts.len()).filter(|&k| parts[k].label != NOTHING).collect();
                for k in first..parts.len() {
                    let nearest = seen.iter().min_by_key(|seen| seen.abs_diff(k));
                    parts[k].label = nearest.map_or(NOTHING, |&seen| parts[seen].label);
                }
                if seen.is_empty() {
                    parts.truncate(first);
                }
            }
            from = end.max(from);
        }
    }

    /// Label of the gas in front of a place on a wall, by its distance from the start; `NOTHING` in water.
    pub fn gas_before(&self, space: &Space, segment: &Segment, place: f64, spacing: f64) -> u32 {
        let on = segment.start + segment.tangent * place;
        let front = on - segment.normal * (IN_FRONT * spacing);
        let near = space.labels().near(&front, 1).filter(|(_, node)| {
            let close = (node - front).norm_squared() < (NEAREST * spacing).powi(2);
            close
                && segment.local(node).0 > 0.0
                && !self.walls.separates(&(on - segment.normal * (1e-6 * spacing)), node)
        });
        let nearest = near.min_by(|a, b| (a.1 - front).norm_squared().total_cmp(&(b.1 - front).norm_squared()));
        nearest.map_or(NOTHING, |(label, _)| label)
    }

    /// Adds a part of a wall to what a pocket touches: its length, and its first moment over the wall's length \[m\].
    fn add_dry(
        &self,
        problem: &Problem,
        segment: &Segment,
        [length, moment]: [f64; 2],
        centre: &Vector2<f64>,
        dry: &mut Dry,
    ) {
        let normal = segment.normal;
        dry.volume += (segment.start - centre).dot(&normal) * length;
        if segment.panel == FIXED {
            dry.fixed += normal * length;
            return;
        }
        // Exact for rigid walls; along a panel of a beam the deflection is taken as straight.
        let ends = problem.layout.panels[segment.panel as usize];
        for (place, weight) in [(0.0, length - moment), (1.0, moment)] {
            let Some(point) = SurfacePoint::between(ends[0], ends[1], place) else { continue };
            problem.geometry.bodies.add_force(point, &self.middle.position, normal * weight, &mut dry.work);
        }
    }
}
