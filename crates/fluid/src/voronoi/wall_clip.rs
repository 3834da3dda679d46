//! Takes the solids out of a cell. What remains need not be convex: the corner of a plate may stand in it.
//!
//! The outline of what remains is walked with the water on the left, along edges of the polygon and along walls. Where
//! it would cross another line from that line's left to its right, it goes on along that one.

use super::polygon::Corner;
use nalgebra::Vector2;

/// Largest number of edges and walls of one cell.
pub const MOST: usize = 48;
/// How far a wall that nothing continues is prolonged, in spacings: it ends on another one up to rounding.
const PROLONGED: f64 = 0.05;
/// Distance in spacings within which a wall continues another.
const JOINED: f64 = 1e-6;

/// An edge of the polygon or a piece of wall, water on its left, relative to the particle.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// Start \[m\].
    pub start: Vector2<f64>,
    /// Unit vector along it.
    pub tangent: Vector2<f64>,
    /// Length \[m\].
    pub length: f64,
    /// What a corner's label says of its edge.
    pub label: u32,
}

impl Line {
    fn at(&self, along: f64) -> Vector2<f64> {
        self.start + self.tangent * along
    }

    /// Place along this line, and along the other, where this one crosses the other from its left to its right.
    fn leaves(&self, other: &Self) -> Option<(f64, f64)> {
        let outward = Vector2::new(other.tangent.y, -other.tangent.x);
        let across = self.tangent.dot(&outward);
        if across < 1e-9 {
            return None;
        }
        let along = (other.start - self.start).dot(&outward) / across;
        Some((along, (self.at(along) - other.start).dot(&other.tangent)))
    }
}

/// Edges of a polygon, then walls.
pub struct WallClipper {
    lines: [Line; MOST],
    count: usize,
    edges: usize,
    spacing: f64,
}

impl WallClipper {
    /// The edges of a polygon.
    pub fn of(polygon: &[Corner], spacing: f64) -> Self {
        let nothing = Line { start: Vector2::zeros(), tangent: Vector2::zeros(), length: 0.0, label: 0 };
        let mut lines = Self { lines: [nothing; MOST], count: polygon.len(), edges: polygon.len(), spacing };
        for (k, corner) in polygon.iter().enumerate() {
            let side = polygon[(k + 1) % polygon.len()].place - corner.place;
            let length = side.norm();
            let tangent = if length > 0.0 { side / length } else { side };
            lines.lines[k] = Line { start: corner.place, tangent, length, label: corner.label };
        }
        lines
    }

    /// Adds a wall; returns whether there was room for it.
    pub fn add_wall(&mut self, wall: Line) -> bool {
        let fits = self.count < MOST;
        if fits {
            self.lines[self.count] = wall;
            self.count += 1;
        }
        fits
    }

    /// Outline of the part of the polygon that hangs together with the point `inside` in front of the walls, appended
    /// to `out`. False when the walls near the point do not bound an area.
    pub fn walk(&self, inside: &Vector2<f64>, out: &mut Vec<Corner>) -> bool {
        let begin = out.len();
        let Some((first, first_along)) = self.first_hit(inside) else { return false };
        let (mut line, mut along) = (first, first_along);
        for _ in 0..2 * MOST {
            let Some((next, place, next_along)) = self.follow(line, along) else { break };
            (line, along) = (next, next_along);
            out.push(Corner { place, label: self.lines[line].label });
            let ahead = self.follow(line, along).map(|(_, place, _)| (place - self.lines[line].start).norm());
            if line == first && along <= first_along && ahead.is_some_and(|ahead| ahead >= first_along) {
                return true;
            }
        }
        out.truncate(begin);
        false
    }

    /// The first line that a ray from the point to the middle of the polygon's longest edge meets, and where on it.
    fn first_hit(&self, inside: &Vector2<f64>) -> Option<(usize, f64)> {
        let longest = self.lines[..self.edges].iter().max_by(|a, b| a.length.total_cmp(&b.length))?;
        let way = longest.at(0.5 * longest.length) - inside;
        let length = way.norm();
        let ray = Line { start: *inside, tangent: way / length, length, label: 0 };
        let hits = (0..self.count).filter_map(|other| {
            let (along, on_other) = ray.leaves(&self.lines[other])?;
            let met = along > 0.0 && (0.0..=self.lines[other].length).contains(&on_other);
            met.then_some((along, other, on_other))
        });
        hits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, other, on_other)| (other, on_other))
    }

    /// Where the outline goes on from the place `along` a line: the next line, where it is joined, and how far along
    /// it.
    fn follow(&self, line: usize, along: f64) -> Option<(usize, Vector2<f64>, f64)> {
        let own = &self.lines[line];
        let joined = self.continuation(line);
        let slack = JOINED * self.spacing;
        let end = own.length + if joined.is_some() { slack } else { PROLONGED * self.spacing };
        let mut nearest = joined.map(|next| (own.length + slack, next, 0.0));
        for (other, crossed) in self.lines[..self.count].iter().enumerate() {
            let both_edges = line < self.edges && other < self.edges;
            let after = self.continuation(other);
            if other == line || both_edges || joined == Some(other) || after == Some(line) {
                continue;
            }
            let Some((here, there)) = own.leaves(crossed) else { continue };
            let before =
                if other < self.edges || self.is_continued_by(other) { slack } else { PROLONGED * self.spacing };
            let after = if after.is_some() { slack } else { PROLONGED * self.spacing };
            let met = here >= along && here <= end && there >= -before && there <= crossed.length + after;
            if met && nearest.is_none_or(|(place, ..)| here < place) {
                nearest = Some((here, other, there));
            }
        }
        let last = if joined.is_some() { own.length } else { end };
        nearest.map(|(here, next, there)| (next, own.at(here.min(last)), there.max(0.0)))
    }

    /// The line that starts where this one ends.
    fn continuation(&self, line: usize) -> Option<usize> {
        if line < self.edges {
            return Some((line + 1) % self.edges);
        }
        let end = self.lines[line].at(self.lines[line].length);
        (self.edges..self.count).find(|&next| self.coincide(&self.lines[next].start, &end) && next != line)
    }

    fn is_continued_by(&self, line: usize) -> bool {
        let start = self.lines[line].start;
        (self.edges..self.count).any(|k| self.coincide(&self.lines[k].at(self.lines[k].length), &start))
    }

    fn coincide(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> bool {
        (a - b).norm_squared() < (JOINED * self.spacing).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::polygon::{Polygon, WALL, area};
    use super::*;

    /// What remains of the square from -1 to 1 in front of walls through the given points.
    fn remainder(walls: &[&[(f64, f64)]]) -> Option<Vec<Corner>> {
        let square = Polygon::square(1.0);
        let mut lines = WallClipper::of(square.corners(), 1.0);
        for (k, pair) in walls.iter().flat_map(|wall| wall.windows(2)).enumerate() {
            let [start, end] = [pair[0], pair[1]].map(|(x, y)| Vector2::new(x, y));
            let length = (end - start).norm();
            let label = WALL - k as u32;
            assert!(lines.add_wall(Line { start, tangent: (end - start) / length, length, label }));
        }
        let mut corners = Vec::new();
        lines.walk(&Vector2::zeros(), &mut corners).then_some(corners)
    }

    fn area_of(walls: &[&[(f64, f64)]]) -> f64 {
        remainder(walls).map_or(f64::NAN, |corners| area(&corners))
    }

    #[test]
    fn a_convex_corner_stands_in_the_cell() {
        let corner = [(0.5, -2.0), (0.5, -0.25), (2.0, -0.25)];
        let corners = remainder(&[&corner]).unwrap();
        assert!((area(&corners) - (4.0 - 0.5 * 0.75)).abs() < 1e-12);
        assert_eq!(corners.iter().filter(|corner| corner.label > u32::MAX - 3 && corner.label <= WALL).count(), 2);
    }

    #[test]
    fn a_concave_corner_and_a_plate_on_a_floor_bound_it() {
        let tank = [(-2.0, -0.5), (0.5, -0.5), (0.5, 2.0)];
        assert!((area_of(&[&tank]) - 1.5 * 1.5).abs() < 1e-12);
        let floor = [(-2.0, -0.5), (2.0, -0.5)];
        let plate = [(0.5, -0.5), (0.5, 3.0), (0.6, 3.0), (0.6, -0.5)];
        assert!((area_of(&[&floor, &plate]) - 1.5 * 1.5).abs() < 1e-12, "nothing of the far side belongs to the cell");
        let short = [(0.5, -0.5), (0.5, 0.5), (0.6, 0.5), (0.6, -0.5)];
        assert!((area_of(&[&floor, &short]) - (2.0 * 1.5 - 0.1)).abs() < 1e-12, "over the plate it does");
    }

    #[test]
    fn a_wall_that_ends_in_the_water_bounds_nothing() {
        assert!(remainder(&[&[(0.5, -2.0), (0.5, 0.0)]]).is_none());
    }
}
