//! Whether the places where the water is read are places where water can be.

use crate::error::place;
use crate::grid::bounding_box;
use crate::solver::Solver;
use crate::walls::sides::{SLACK, Sides, Solids};
use digits::six;
use nalgebra::Vector2;

/// Depth within a solid, in spacings, from which a place is no slip of rounding.
const DEEP: f64 = 0.5;

/// What is read, by its index in the geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instrument {
    /// Of [`crate::Geometry::probes`].
    Probe(usize),
    /// Of [`crate::Geometry::gauges`].
    Gauge(usize),
    /// Of [`crate::Geometry::regions`].
    Region(usize),
}

/// An instrument that stands where no water can be at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Misplaced {
    /// Which one.
    pub instrument: Instrument,
    /// Where it stands in the scene's pose: a point, the abscissa of a gauge, the box around a region \[m\].
    pub place: String,
    /// What is wrong, with the distance.
    pub reason: String,
    /// Whether it can never read anything but nothing.
    pub hopeless: bool,
}

impl Solver {
    /// Instruments within a solid, or outside of all walls, water and body, judged in the pose of the scene. Deeper
    /// than half a spacing in a solid, or outside the domain that particles must not leave, an instrument is hopeless;
    /// on_body makes no difference.
    pub fn misplaced(&self) -> Vec<Misplaced> {
        let geometry = &self.problem.geometry;
        let spacing = self.problem.spacing;
        let walls = self.problem.walls(&self.at_rest().position);
        let ends = walls.segments.iter().flat_map(|segment| [segment.start, segment.end()]);
        let everything: Vec<_> = ends.chain(geometry.water.iter().flatten().copied()).collect();
        let places = Places {
            sides: Sides::new(walls.segments.iter(), spacing),
            solids: Solids::new(geometry),
            everything: bounding_box(&everything),
            domain: self.domain,
            spacing,
        };
        let probes = geometry.probes.iter().enumerate().map(|(k, probe)| (Instrument::Probe(k), [probe.place; 2]));
        let gauges = geometry.gauges.iter().enumerate().map(|(k, &x)| (Instrument::Gauge(k), places.upright(x)));
        let regions = geometry.regions.iter().enumerate();
        let regions = regions.map(|(k, region)| (Instrument::Region(k), bounding_box(&region.polygon).into()));
        probes.chain(gauges).chain(regions).filter_map(|(instrument, ends)| places.judge(instrument, ends)).collect()
    }
}

struct Places<'a> {
    sides: Sides<'a>,
    solids: Solids,
    /// The box around walls, water and body.
    everything: (Vector2<f64>, Vector2<f64>),
    /// The box that particles must not leave.
    domain: (Vector2<f64>, Vector2<f64>),
    spacing: f64,
}

impl Places<'_> {
    /// A gauge looks at all heights.
    fn upright(&self, x: f64) -> [Vector2<f64>; 2] {
        let (low, high) = self.everything;
        [Vector2::new(x, low.y), Vector2::new(x, high.y)]
    }

    /// What is wrong with an instrument in the box between two corners.
    fn judge(&self, instrument: Instrument, ends: [Vector2<f64>; 2]) -> Option<Misplaced> {
        let [low, high] = ends;
        let stands = match instrument {
            Instrument::Probe(_) => place(&low),
            Instrument::Gauge(_) => format!("{} m", six(low.x)),
            Instrument::Region(_) => format!("{} to {}", place(&low), place(&high)),
        };
        let found = |reason: String, hopeless: bool| Some(Misplaced { instrument, place: stands, reason, hopeless });
        let beyond = distance(&self.everything, &ends);
        let depth = if matches!(instrument, Instrument::Probe(_)) { self.depth(&low) } else { 0.0 };
        let out_of_reach = distance(&self.domain, &ends) > 0.0;
        if depth > SLACK * self.spacing && !out_of_reach {
            return found(format!("it lies {} m within a solid", six(depth)), depth > DEEP * self.spacing);
        }
        if beyond <= SLACK * self.spacing {
            return None;
        }
        let all = format!("from {} to {}", place(&self.everything.0), place(&self.everything.1));
        let beyond = six(beyond);
        found(format!("it lies {beyond} m outside of walls, water and structure, which reach {all}"), out_of_reach)
    }

    /// How deep a point lies within a solid \[m\], 0 or less in front of all walls.
    fn depth(&self, point: &Vector2<f64>) -> f64 {
        let behind = self.sides.distance(point).map_or(f64::NEG_INFINITY, |distance| -distance);
        behind.max(self.solids.depth(point))
    }
}

/// Distance between two boxes \[m\]; 0 where they overlap.
fn distance((low, high): &(Vector2<f64>, Vector2<f64>), other: &[Vector2<f64>; 2]) -> f64 {
    let apart = |axis: usize| (other[0][axis] - high[axis]).max(low[axis] - other[1][axis]).max(0.0);
    apart(0).hypot(apart(1))
}
