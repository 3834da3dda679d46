//! On which side of the walls a place lies: water or solid.

use crate::parameters::Geometry;
use crate::setup::fill::{contains, signed_area};
use crate::walls::Segment;
use kinematics::{MaterialPoint, SurfacePoint};
use nalgebra::Vector2;

/// Distance in spacings up to which a place counts as on a wall, and ends of walls as joined.
pub const SLACK: f64 = 1e-6;
/// Squared distances of two walls that differ by less count as equal.
const TIED: f64 = 1e-9;
/// Rounding of a coordinate, over the largest coordinate.
const ROUNDING: f64 = 1e-12;

/// Walls, and the normals at their corners.
///
/// A place whose nearest point of the walls is a corner lies on the side that the sum of the normals of both walls at
/// that corner tells: the angle-weighted pseudonormal of Baerentzen and Aanaes (2005) in two dimensions. The normal of
/// one of them alone tells the wrong side next to an acute corner.
pub struct Sides<'a> {
    segments: Vec<&'a Segment>,
    /// Sums of the normals at start and end of each segment.
    corners: Vec<[Vector2<f64>; 2]>,
    slack: f64,
}

impl<'a> Sides<'a> {
    /// Takes walls at one instant.
    pub fn new(segments: impl Iterator<Item = &'a Segment>, spacing: f64) -> Self {
        let segments: Vec<&Segment> = segments.collect();
        let ends = segments.iter().flat_map(|segment| [segment.start, segment.end()]);
        let largest = ends.fold(0.0, |largest: f64, end| largest.max(end.amax()));
        let slack = (SLACK * spacing).max(ROUNDING * largest);
        let corners = corners(&segments, slack);
        Self { segments, corners, slack }
    }

    /// Distance from the nearest wall \[m\], negative within the solid; none without walls. Where walls are equally
    /// near it is negative only if all of them say so.
    pub fn distance(&self, point: &Vector2<f64>) -> Option<f64> {
        let squares = self.segments.iter().map(|segment| segment.squared_distance(point));
        let nearest = squares.fold(f64::INFINITY, f64::min);
        if !nearest.is_finite() {
            return None;
        }
        let tied = |k: &usize| self.segments[*k].squared_distance(point) <= nearest * (1.0 + TIED) + self.slack.powi(2);
        let mut near = (0..self.segments.len()).filter(tied);
        let distance = nearest.sqrt();
        Some(if near.any(|k| self.is_in_front(k, point)) { distance } else { -distance })
    }

    /// Whether a point lies on the solid side of the wall nearest to it.
    pub fn is_behind(&self, point: &Vector2<f64>) -> bool {
        self.distance(point).is_some_and(|distance| distance < -self.slack)
    }

    /// Whether the nearest place of a segment says that a point lies in the water.
    fn is_in_front(&self, index: usize, point: &Vector2<f64>) -> bool {
        let segment = self.segments[index];
        let (distance, along) = segment.local(point);
        if (0.0..=segment.length).contains(&along) {
            return distance >= 0.0;
        }
        let at_end = usize::from(along > 0.0);
        let corner = if at_end == 1 { segment.end() } else { segment.start };
        self.corners[index][at_end].dot(&(point - corner)) <= 0.0
    }
}

/// Sums of the normals at start and end of every segment, of all segments that have an end there.
fn corners(segments: &[&Segment], slack: f64) -> Vec<[Vector2<f64>; 2]> {
    let mut corners: Vec<_> = segments.iter().map(|segment| [segment.normal; 2]).collect();
    let place = |&(k, end): &(usize, usize)| if end == 0 { segments[k].start } else { segments[k].end() };
    let mut ends: Vec<(usize, usize)> = (0..segments.len()).flat_map(|k| [(k, 0), (k, 1)]).collect();
    ends.sort_by(|a, b| place(a).x.total_cmp(&place(b).x));
    for (i, one) in ends.iter().enumerate() {
        let here = place(one);
        for other in ends[i + 1..].iter().take_while(|other| place(other).x - here.x <= slack) {
            if (place(other) - here).norm() <= slack && one.0 != other.0 {
                corners[one.0][one.1] += segments[other.0].normal;
                corners[other.0][other.1] += segments[one.0].normal;
            }
        }
    }
    corners
}

/// The outlines of closed solids at the start: walls that come back to their first point, walked clockwise.
pub struct Solids {
    outlines: Vec<Vec<Vector2<f64>>>,
}

impl Solids {
    /// Those among the fixed walls and the body's rigid ones.
    pub fn new(geometry: &Geometry) -> Self {
        let walls = geometry.fixed_walls.iter().cloned().chain(placed_walls(geometry));
        Self { outlines: walls.filter(|wall| is_closed(wall) && signed_area(wall) < 0.0).collect() }
    }

    /// How deep a point lies within a solid \[m\]; 0 outside of all.
    pub fn depth(&self, point: &Vector2<f64>) -> f64 {
        let around = self.outlines.iter().filter(|outline| contains(outline, point));
        let depths = around.map(|outline| {
            let pieces = outline.windows(2).filter(|pair| pair[0] != pair[1]);
            let squares = pieces.map(|pair| Segment::between(pair[0], pair[1], 0, 0.0, 0).squared_distance(point));
            squares.fold(f64::INFINITY, f64::min).sqrt()
        });
        depths.fold(0.0, f64::max)
    }
}

/// Whether a wall comes back to its first point.
pub fn is_closed(wall: &[Vector2<f64>]) -> bool {
    wall.len() > 2 && wall.first() == wall.last()
}

/// The bodies' rigid walls in the pose of the scene \[m\].
pub fn placed_walls(geometry: &Geometry) -> Vec<Vec<Vector2<f64>>> {
    let rest = geometry.bodies.at_rest();
    let place = |body: usize, wall: &Vec<Vector2<f64>>| {
        let at = |point: &Vector2<f64>| SurfacePoint { body, point: MaterialPoint::Rigid(*point) };
        wall.iter().map(|point| geometry.bodies.position(at(point), &rest)).collect()
    };
    let bodies = geometry.bodies.bodies().iter().enumerate();
    bodies.flat_map(|(index, body)| body.walls.iter().map(move |wall| place(index, wall))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation2;
    use proptest::prelude::*;

    fn closed(corners: &[Vector2<f64>]) -> Vec<Segment> {
        let count = corners.len();
        (0..count).map(|k| Segment::between(corners[k], corners[(k + 1) % count], 0, 0.0, 0)).collect()
    }

    /// A triangle with this angle at its first corner, and sides of these lengths there, walked clockwise.
    fn triangle(angle: f64, sides: [f64; 2], place: Vector2<f64>, turn: f64) -> [Vector2<f64>; 3] {
        let side = |direction: f64, length: f64| place + Rotation2::new(turn + direction) * Vector2::new(length, 0.0);
        [place, side(0.5 * angle, sides[0]), side(-0.5 * angle, sides[1])]
    }

    proptest! {
        /// Off its corner a triangle of any shape, size and place has water all around, however far away one looks, and
        /// walked the other way round solid.
        #[test]
        fn a_place_off_a_corner_is_outside(
            angle in 0.02_f64..3.0, ratio in 0.05_f64..20.0, size in -6.0_f64..6.0, far in -3.0_f64..3.0,
            turn in 0.0_f64..6.3, share in 0.0_f64..1.0, x in -100.0_f64..100.0, y in -100.0_f64..100.0,
        ) {
            let size = 10.0_f64.powf(size);
            let corners = triangle(angle, [size, ratio * size], Vector2::new(x, y) * size, turn);
            // The normals of both sides bound the directions whose nearest point is the corner.
            let half = std::f64::consts::FRAC_PI_2 - 0.5 * angle;
            let direction = turn + std::f64::consts::PI + half * (2.0 * share - 1.0);
            let point = corners[0] + Rotation2::new(direction) * Vector2::new(size * 10.0_f64.powf(far), 0.0);
            let spacing = 0.1 * size;
            let around = closed(&corners);
            let distance = Sides::new(around.iter(), spacing).distance(&point);
            let expected = (point - corners[0]).norm();
            prop_assert!(distance.is_some_and(|distance| (distance / expected - 1.0).abs() < 1e-6), "{distance:?}");
            let mirrored: Vec<_> = corners.iter().rev().copied().collect();
            let within = closed(&mirrored);
            prop_assert!(Sides::new(within.iter(), spacing).is_behind(&point));
        }

        /// A place between the corners lies within.
        #[test]
        fn a_place_between_the_corners_is_inside(
            angle in 0.1_f64..3.0, ratio in 0.2_f64..5.0, size in -6.0_f64..6.0, turn in 0.0_f64..6.3,
            weights in [0.05_f64..1.0, 0.05_f64..1.0, 0.05_f64..1.0],
        ) {
            let size = 10.0_f64.powf(size);
            let corners = triangle(angle, [size, ratio * size], Vector2::zeros(), turn);
            let total: f64 = weights.iter().sum();
            let point: Vector2<f64> = corners.iter().zip(weights).map(|(corner, weight)| corner * (weight / total)).sum();
            let around = closed(&corners);
            prop_assert!(Sides::new(around.iter(), 0.1 * size).is_behind(&point));
            let outline: Vec<_> = corners.iter().chain(&corners[..1]).copied().collect();
            let solids = Solids::new(&Geometry { fixed_walls: vec![outline], ..Geometry::default() });
            let depth = solids.depth(&point);
            let distance = Sides::new(around.iter(), 0.1 * size).distance(&point);
            prop_assert!(distance.is_some_and(|distance| (distance + depth).abs() < 1e-9 * size), "{depth} {distance:?}");
        }
    }

    /// Two walls that are given apart are one corner where they meet.
    #[test]
    fn walls_that_meet_are_a_corner() {
        let corner = Vector2::new(1.0, 0.0);
        let one = Segment::between(Vector2::new(0.0, 0.1), corner, 0, 0.0, 0);
        let other = Segment::between(corner, Vector2::new(0.0, -0.1), 1, 0.0, 0);
        let point = Vector2::new(3.0, 1.5);
        // Behind the line of the second wall, and in front of the corner.
        assert!(other.local(&point).0 < 0.0);
        assert!(!Sides::new([one, other].iter(), 0.01).is_behind(&point));
        assert!(Sides::new([one, other].iter(), 0.01).is_behind(&Vector2::new(0.5, 0.0)));
    }
}
