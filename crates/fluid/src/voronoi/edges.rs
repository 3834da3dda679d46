//! Edges of solids in the outline of a cell: there the free surface lets go of a wall without a jump.

use super::polygon::BOX;
use super::shape::{CORNERS, Shape, smooth_step};

/// Distances in spacings over which the edge of a solid lets the surface go: of the edge from the foot of the particle on its
/// wall, and of the edge from the next facet.
const EDGE: f64 = 0.5;
const APERTURE: f64 = 0.4;

impl Shape<'_> {
    /// Changes how far corners at the edges of solids lie in empty space.
    pub(super) fn part_at_edges(&mut self) {
        let own = self.buffers.empty;
        for k in 0..self.count {
            if self.is_hidden(k) {
                let next = self.wrapped(k + 1);
                self.let_go(&own, [k, next], false);
                self.let_go(&own, [next, k], true);
            }
        }
        (0..self.count).for_each(|k| self.leave_edge(&own, k));
    }

    /// The water does not reach round the edge of a solid, a corner at the `start` of a hidden side whose `end` lies in empty
    /// space: the nearer the particle stands to seeing that side, and the less room there is between the edge and the next
    /// facet, the more it does. Looks on in the order of the corners, or `back`.
    fn let_go(&mut self, own: &[f64; CORNERS], [start, end]: [usize; 2], back: bool) {
        let count = self.count;
        let step = |k: usize| if back { (k + count - 1) % count } else { (k + 1) % count };
        // Edges are named by the corner that they start from.
        let (hidden, other) = if back { (end, start) } else { (start, (start + count - 1) % count) };
        if own[end] == 0.0 || !self.is_wall(other) {
            return;
        }
        let spacing = self.around.spacing;
        let mut edge = step(hidden);
        let bounds = |edge: usize| self.buffers.corners[edge].label != BOX && !self.is_hidden(edge);
        while !bounds(edge) && edge != hidden {
            edge = step(edge);
        }
        let tip = self.buffers.corners[start].place;
        let plane = (self.around.planes)(self.buffers.corners[edge].label);
        let gap = if edge == hidden { APERTURE * spacing } else { plane.distance - plane.normal.dot(&tip) };
        let behind = -(self.around.planes)(self.buffers.corners[hidden].label).distance / spacing;
        let unseen = smooth_step(behind, [0.0, EDGE]);
        let room = 1.0 - own[end] * unseen * (1.0 - smooth_step(gap / spacing, [0.0, APERTURE]));
        let share = own[end] * room * unseen;
        if room < 1.0 {
            let across = tip + plane.normal * gap;
            let last = if back { self.wrapped(edge + 1) } else { edge };
            let mut corner = end;
            while corner != start {
                self.buffers.corners[corner].place = across + (self.buffers.corners[corner].place - across) * room;
                self.buffers.empty[corner] *= room;
                corner = if corner == last { start } else { step(corner) };
            }
        }
        self.buffers.empty[start] = self.buffers.empty[start].max(share);
    }

    /// The edge of a solid, corner k, that stands in a facet leaves it when nothing of its sides is left in the cell: before, the
    /// surface lets go of them if the facet ends in empty space.
    fn leave_edge(&mut self, own: &[f64; CORNERS], k: usize) {
        let (before, after) = ((k + self.count - 1) % self.count, self.wrapped(k + 1));
        let first = (before + self.count - 1) % self.count;
        let same = self.buffers.corners[first].label == self.buffers.corners[after].label;
        if self.count < 5 || !same || !self.is_wall(before) || !self.is_wall(k) {
            return;
        }
        let length =
            |from: usize, to: usize| (self.buffers.corners[to].place - self.buffers.corners[from].place).norm();
        let size = length(before, k).max(length(k, after)) / self.around.spacing;
        let far = own[first].max(own[self.wrapped(after + 1)]);
        let share = far * (1.0 - smooth_step(size, [0.0, APERTURE]));
        for corner in [before, k, after] {
            self.buffers.empty[corner] = self.buffers.empty[corner].max(share);
        }
    }
}
