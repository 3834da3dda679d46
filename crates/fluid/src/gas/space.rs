//! Which space has no water in it, and what of it hangs together.
//!
//! Nodes stand a spacing apart, on a lattice that stays where it is. One is dry when no particle is within 0.95 spacings: farther
//! than water in disorder leaves room. Neighbouring dry nodes hang together unless a wall passes between them. What reaches the
//! border of the lattice, outside all walls, is the open air; what walls show their back to is solid.

use crate::grid::{bearable_size, bounding_box};
use crate::walls::{Segment, Walls};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// Label of nodes in water and in solids.
pub const NOTHING: u32 = u32::MAX;
/// Label of the open air; pockets have those from 1 on.
pub const OPEN: u32 = 0;
/// Distance from a particle in spacings within which there is water.
const WET: f64 = 0.95;
/// Rows of nodes around everything.
const MARGIN: f64 = 2.0;
/// Where the lattice stands, as shares of a spacing: not on the round numbers that walls stand on.
const OFFSET: [f64; 2] = [0.371, 0.413];

/// A wall passes between a node and the next one along X, along Y; a wall beside it shows it its front, its back.
const BLOCKED: [u8; 2] = [1, 2];
const FRONT: u8 = 4;
const BACK: u8 = 8;

/// Labels of the nodes of a lattice.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Labels {
    /// Distance of nodes \[m\].
    size: f64,
    /// Lattice coordinates of the first node.
    corner: [i64; 2],
    columns: usize,
    rows: usize,
    labels: Vec<u32>,
}

impl Labels {
    /// Whether nothing was looked for yet.
    pub fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// Whether there is a label for every node and a pocket, of `count`, for every label.
    pub fn are_sound(&self, count: usize) -> bool {
        let known = |label: &u32| *label == NOTHING || *label as usize <= count;
        let places = self.corner.iter().all(|corner| corner.unsigned_abs() < 1 << 40);
        self.columns.checked_mul(self.rows) == Some(self.labels.len()) && places && self.labels.iter().all(known)
    }

    /// Label of a node by its lattice coordinates.
    fn of(&self, node: [i64; 2]) -> u32 {
        self.index(node).map_or(NOTHING, |index| self.labels[index])
    }

    /// Nodes with gas at most `rings` before and after a place, with their labels and places.
    pub fn near(&self, place: &Vector2<f64>, rings: i64) -> impl Iterator<Item = (u32, Vector2<f64>)> {
        let [column, row] = self.node_before(place);
        let rows = row - rings + 1..=row + rings;
        let nodes = rows.flat_map(move |row| (column - rings + 1..=column + rings).map(move |column| [column, row]));
        nodes.map(|node| (self.of(node), self.place(node))).filter(|(label, _)| *label != NOTHING)
    }

    /// The label of every node with gas and the label of the same node in `other`.
    pub fn pairs<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (u32, u32)> + 'a {
        let gas = self.labels.iter().enumerate().filter(|(_, label)| **label != NOTHING);
        gas.map(move |(at, &label)| (label, other.of(self.node_at(at))))
    }

    /// Lattice coordinates of the node before a place.
    fn node_before(&self, place: &Vector2<f64>) -> [i64; 2] {
        std::array::from_fn(|axis| (place[axis] / self.size - OFFSET[axis]).floor() as i64)
    }

    /// Where a node stands \[m\].
    fn place(&self, node: [i64; 2]) -> Vector2<f64> {
        Vector2::new((node[0] as f64 + OFFSET[0]) * self.size, (node[1] as f64 + OFFSET[1]) * self.size)
    }

    fn node_at(&self, at: usize) -> [i64; 2] {
        [self.corner[0] + (at % self.columns) as i64, self.corner[1] + (at / self.columns) as i64]
    }

    fn lay_out(&mut self, [low, high]: [Vector2<f64>; 2], spacing: f64) {
        self.size = bearable_size(&(high - low), spacing);
        let margin = MARGIN * self.size;
        let [first, last] = [low.add_scalar(-margin), high.add_scalar(margin)].map(|place| self.node_before(&place));
        self.corner = first;
        (self.columns, self.rows) = ((last[0] - first[0]) as usize + 2, (last[1] - first[1]) as usize + 2);
        self.labels.clear();
        self.labels.resize(self.columns * self.rows, NOTHING);
    }

    fn index(&self, [column, row]: [i64; 2]) -> Option<usize> {
        let (column, row) = (column - self.corner[0], row - self.corner[1]);
        let inside = (0..self.columns as i64).contains(&column) && (0..self.rows as i64).contains(&row);
        inside.then(|| row as usize * self.columns + column as usize)
    }
}

/// A pocket as it was found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Found {
    /// Its nodes.
    nodes: u32,
    /// The mean of their places \[m\].
    centre: Vector2<f64>,
}

/// What hangs together while it is looked through.
#[derive(Default)]
struct Component {
    nodes: u32,
    sum: Vector2<f64>,
    open: bool,
    front: u32,
    back: u32,
}

/// The space without water.
#[derive(Debug, Clone, Default)]
pub struct Space {
    /// Labels of its nodes.
    labels: Labels,
    /// Pockets; that with the label k stands at k - 1.
    found: Vec<Found>,
    flags: Vec<u8>,
    stack: Vec<u32>,
}

/// Label of a dry node that was not looked at yet.
const UNKNOWN: u32 = u32::MAX - 1;

impl Space {
    /// Finds the pockets among particles and walls.
    pub fn find(&mut self, positions: &[Vector2<f64>], walls: &Walls, spacing: f64) {
        self.found.clear();
        self.labels.lay_out(extent(positions, walls), spacing);
        self.labels.labels.fill(UNKNOWN);
        self.wet(positions, spacing);
        self.block(walls);
        for at in 0..self.labels.labels.len() {
            if self.labels.labels[at] == UNKNOWN {
                // Labels are given when all of a component is known.
                let component = self.walk(at as u32);
                let label = self.label(&component);
                self.stack.iter().for_each(|&node| self.labels.labels[node as usize] = label);
                self.stack.clear();
            }
        }
    }

    /// Labels of the nodes.
    pub fn labels(&self) -> &Labels {
        &self.labels
    }

    /// Index of the pocket at a place; none in water, solids and open air.
    pub fn pocket_at(&self, place: &Vector2<f64>) -> Option<usize> {
        let near = self.labels.near(place, 1).filter(|(label, _)| *label != OPEN);
        let nearest = near.min_by(|a, b| (a.1 - place).norm_squared().total_cmp(&(b.1 - place).norm_squared()));
        nearest.map(|(label, _)| label as usize - 1)
    }

    /// Area and middle of every pocket.
    pub fn found(&self) -> impl Iterator<Item = (f64, Vector2<f64>)> {
        let area = self.labels.size * self.labels.size;
        self.found.iter().map(move |found| (f64::from(found.nodes) * area, found.centre))
    }

    fn label(&mut self, component: &Component) -> u32 {
        if component.open {
            return OPEN;
        }
        if component.back > component.front {
            return NOTHING;
        }
        let centre = component.sum / f64::from(component.nodes);
        self.found.push(Found { nodes: component.nodes, centre });
        self.found.len() as u32
    }

    /// Marks the nodes in the water.
    fn wet(&mut self, positions: &[Vector2<f64>], spacing: f64) {
        let labels = &mut self.labels;
        let reach = WET * spacing;
        for position in positions {
            let [column, row] = labels.node_before(position);
            for row in row..=row + 1 {
                for column in column..=column + 1 {
                    let close = (labels.place([column, row]) - position).norm_squared() < reach * reach;
                    if let Some(index) = labels.index([column, row]).filter(|_| close) {
                        labels.labels[index] = NOTHING;
                    }
                }
            }
        }
    }

    /// Marks where walls pass between nodes. A wall that begins where another one ends leaves no gap, since of two equal
    /// numbers the first always counts as below.
    fn block(&mut self, walls: &Walls) {
        self.flags.clear();
        self.flags.resize(self.labels.labels.len(), 0);
        for segment in &walls.segments {
            self.block_along(segment, 0);
            self.block_along(segment, 1);
        }
    }

    /// Marks where a wall passes between nodes that follow each other along an axis.
    fn block_along(&mut self, segment: &Segment, axis: usize) {
        let across = 1 - axis;
        let [start, end] = [segment.start, segment.end()];
        let [from, to] = [start, end].map(|end| self.labels.node_before(&end)[across]);
        for line in from.min(to)..=from.max(to) + 1 {
            let level = (line as f64 + OFFSET[across]) * self.labels.size;
            if (start[across] <= level) == (end[across] <= level) {
                continue;
            }
            let crossing = start + (end - start) * ((level - start[across]) / (end[across] - start[across]));
            let mut before = self.labels.node_before(&crossing);
            before[across] = line;
            let mut after = before;
            after[axis] += 1;
            for (node, blocked) in [(before, BLOCKED[axis]), (after, 0)] {
                let side = if segment.local(&self.labels.place(node)).0 > 0.0 { FRONT } else { BACK };
                self.mark(node, blocked | side);
            }
        }
    }

    fn mark(&mut self, node: [i64; 2], flags: u8) {
        if let Some(index) = self.labels.index(node) {
            self.flags[index] |= flags;
        }
    }

    /// Walks through all that hangs together with a dry node; `stack` has its nodes afterwards.
    fn walk(&mut self, start: u32) -> Component {
        let mut component = Component::default();
        self.stack.push(start);
        self.labels.labels[start as usize] = NOTHING;
        let mut at = 0;
        while at < self.stack.len() {
            let node = self.stack[at] as usize;
            at += 1;
            let (column, row) = (node % self.labels.columns, node / self.labels.columns);
            component.nodes += 1;
            component.sum += self.labels.place(self.labels.node_at(node));
            component.front += u32::from(self.flags[node] & FRONT > 0);
            component.back += u32::from(self.flags[node] & BACK > 0);
            let (last_column, last_row) = (self.labels.columns - 1, self.labels.rows - 1);
            component.open |= column == 0 || row == 0 || column == last_column || row == last_row;
            let steps = [
                (column < last_column, node + 1, node, BLOCKED[0]),
                (column > 0, node.wrapping_sub(1), node.wrapping_sub(1), BLOCKED[0]),
                (row < last_row, node + self.labels.columns, node, BLOCKED[1]),
                (row > 0, node.wrapping_sub(self.labels.columns), node.wrapping_sub(self.labels.columns), BLOCKED[1]),
            ];
            for (inside, next, gate, blocked) in steps {
                if inside && self.labels.labels[next] == UNKNOWN && self.flags[gate] & blocked == 0 {
                    self.labels.labels[next] = NOTHING;
                    self.stack.push(next as u32);
                }
            }
        }
        component
    }
}

/// The box of the walls, or of the particles where there are none.
fn extent(positions: &[Vector2<f64>], walls: &Walls) -> [Vector2<f64>; 2] {
    let ends: Vec<_> = walls.segments.iter().flat_map(|segment| [segment.start, segment.end()]).collect();
    let (low, high) = bounding_box(if ends.is_empty() { positions } else { &ends });
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Geometry;
    use crate::walls::WallLayout;

    fn points(list: &[(f64, f64)]) -> Vec<Vector2<f64>> {
        list.iter().map(|&(x, y)| Vector2::new(x, y)).collect()
    }

    fn find(walls: Vec<Vec<Vector2<f64>>>, water: impl Fn(&Vector2<f64>) -> bool) -> Space {
        let geometry = Geometry { fixed_walls: walls, ..Geometry::default() };
        let mut placed = Walls::default();
        placed.place(&WallLayout::new(&geometry, 0.01), None, 0.03, 0.01);
        let lattice =
            (0..10_000).map(|k| Vector2::new(0.005 + 0.01 * f64::from(k % 100), 0.005 + 0.01 * f64::from(k / 100)));
        let mut space = Space::default();
        space.find(&lattice.filter(water).collect::<Vec<_>>(), &placed, 0.01);
        space
    }

    fn tank(closed: bool) -> Vec<Vector2<f64>> {
        let mut walls = points(&[(0.0, 1.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
        if closed {
            walls.push(walls[0]);
        }
        walls
    }

    #[test]
    fn a_lid_makes_a_pocket_of_the_open_air() {
        let half = |place: &Vector2<f64>| place.y < 0.5;
        assert_eq!(find(vec![tank(false)], half).found, []);
        let pockets = find(vec![tank(true)], half).found;
        assert_eq!(pockets.len(), 1);
        // Half a spacing is lost at the surface: nodes are dry from 0.95 spacings above particles on.
        let area = f64::from(pockets[0].nodes) * 1e-4;
        assert!((area - 0.495).abs() < 0.011, "{area}");
        assert!((pockets[0].centre - Vector2::new(0.5, 0.7525)).norm() < 0.006, "{}", pockets[0].centre);
    }

    #[test]
    fn a_partition_parts_pockets_and_a_ring_of_water_holds_one() {
        let partition = points(&[(0.3, 0.5), (0.3, 1.0), (0.302, 1.0), (0.302, 0.5), (0.3, 0.5)]);
        let partition = partition.into_iter().rev().collect();
        let pockets = find(vec![tank(true), partition], |place| place.y < 0.6).found;
        assert_eq!(pockets.len(), 2);
        let ring = |place: &Vector2<f64>| (0.2..0.4).contains(&(place - Vector2::new(0.5, 0.5)).norm());
        assert_eq!(find(Vec::new(), ring).found.len(), 1);
    }

    #[test]
    fn the_inside_of_a_solid_is_no_pocket() {
        // Water on the left of the outline: walked clockwise.
        let block = points(&[(0.3, 0.3), (0.3, 0.7), (0.7, 0.7), (0.7, 0.3), (0.3, 0.3)]);
        let space = find(vec![tank(false), block], |place| place.y < 0.2);
        assert_eq!(space.found, []);
        let label = |place: Vector2<f64>| {
            space.labels.index(space.labels.node_before(&place)).map(|index| space.labels.labels[index])
        };
        assert_eq!(label(Vector2::new(0.5, 0.5)), Some(NOTHING));
        assert_eq!(label(Vector2::new(0.5, 0.8)), Some(OPEN));
    }
}
