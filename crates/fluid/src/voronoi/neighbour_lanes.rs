//! The particles around one, and the walk along their bisectors that is the outline of its cell.
//!
//! Seen from the particle, the neighbour at c bounds the cell by the line c.x = |c|^2 / 2. From the line of the nearest
//! neighbour, which always bounds the cell, the walk goes counter-clockwise: on the line of d, at d / 2 + t d' with d'
//! at right angles to d, the cell ends where the first other line is met,
//!
//!   t = min over c with c.d' > 0 of (|c|^2 / 2 - c.d / 2) / (c.d'),
//!
//! and goes on along that one. Every step is one pass over a few lanes without a branch.

use super::polygon::{BOX, Corner};
use crate::grid::Row;
use nalgebra::Vector2;
use pulp::Simd;
use std::ops::Range;

/// Lanes come in multiples of this.
const WIDTH: usize = 8;
/// Room for particles and the four sides of the box.
const LANES: usize = 64;
/// Bits of a number that hold the lane it comes from.
const LANE: u64 = LANES as u64 - 1;
/// The lanes as the last bits of a number.
const TAGS: [f64; LANES] = {
    let mut tags = [0.0; LANES];
    let mut lane = 0;
    while lane < LANES {
        tags[lane] = f64::from_bits(lane as u64);
        lane += 1;
    }
    tags
};
/// Place on a line, over its distance, beyond which nothing ends it.
const OPEN: f64 = 1e150;
/// Largest number of corners of a cell; six on average.
pub const MOST_CORNERS: usize = 32;
/// Room for a walk in both directions.
const RING: usize = 2 * MOST_CORNERS;

/// Places relative to the particle, lane by lane.
#[derive(Debug, Clone)]
pub struct NeighbourLanes {
    count: usize,
    x: [f64; LANES],
    y: [f64; LANES],
    half: [f64; LANES],
    label: [u32; LANES],
    /// Corners on the way round, from the middle on counter-clockwise and before it clockwise, and the lane of the edge
    /// that runs from each.
    ring: [(Vector2<f64>, usize); RING],
    /// Lane of the edge that runs from each corner that was found.
    lanes: [u8; MOST_CORNERS],
}

impl Default for NeighbourLanes {
    fn default() -> Self {
        Self {
            count: 0,
            x: [0.0; LANES],
            y: [0.0; LANES],
            half: [0.0; LANES],
            label: [BOX; LANES],
            ring: [(Vector2::zeros(), 0); RING],
            lanes: [0; MOST_CORNERS],
        }
    }
}

impl NeighbourLanes {
    /// Nothing around.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds the sides of a square box, at the distance `half`.
    #[inline(always)]
    pub fn put_box(&mut self, half: f64) {
        for (x, y) in [(2.0, 0.0), (0.0, 2.0), (-2.0, 0.0), (0.0, -2.0)] {
            let at = self.count.min(LANES - 1);
            (self.x[at], self.y[at], self.label[at]) = (x * half, y * half, BOX);
            self.count = at + 1;
        }
    }

    /// Adds those of a row of particles that stand between two distances from `here`, given by their squares, all but
    /// `own`. What finds no room does not bound a cell: with sixty around, the box is full of nearer ones.
    #[inline(always)]
    pub fn put_row(&mut self, here: &Vector2<f64>, own: u32, row: &Row, [from, to]: [f64; 2]) {
        let mut count = self.count;
        for ((&x, &y), &label) in row.x.iter().zip(row.y).zip(row.members) {
            let (x, y) = (x - here.x, y - here.y);
            let squared = x * x + y * y;
            let at = count & (LANES - 1);
            self.x[at] = x;
            self.y[at] = y;
            self.label[at] = label;
            count += usize::from((squared < to) & (squared >= from) & (label != own));
            count = count.min(LANES - 1);
        }
        self.count = count;
    }

    /// Number of lanes in use.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Of the lanes from `first` on, keeps those nearer than the square `near`, and those that `keep` says.
    pub fn retain(&mut self, first: usize, near: f64, keep: impl Fn(usize) -> bool) {
        let mut kept = first;
        for at in first..self.count {
            let squared = self.x[at] * self.x[at] + self.y[at] * self.y[at];
            if squared < near || self.label[at] == BOX || keep(self.label[at] as usize) {
                self.x[kept] = self.x[at];
                self.y[kept] = self.y[at];
                self.label[kept] = self.label[at];
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Unit vector and distance of the bisector whose edge runs from corner k of the outline found last.
    #[inline(always)]
    pub fn bisector(&self, k: usize) -> (Vector2<f64>, f64) {
        let lane = usize::from(self.lanes[k]);
        let distance = (2.0 * self.half[lane]).sqrt();
        (Vector2::new(self.x[lane] / distance, self.y[lane] / distance), 0.5 * distance)
    }

    /// Walks round the cell, both ways at once from the nearest neighbour: half as many steps wait for each other.
    /// Appends its corners, counter-clockwise; edges shorter than `slack` \[m\] are left out. Returns the largest
    /// squared distance of a corner, infinite where nothing closes the cell.
    #[inline(always)]
    pub fn walk<S: Simd>(&mut self, simd: S, own: u32, slack: f64, corners: &mut Vec<Corner>) -> f64 {
        let lanes = self.complete(own, slack);
        if lanes == 0 {
            return f64::INFINITY;
        }
        let (mut low, mut high) = (MOST_CORNERS, MOST_CORNERS);
        let first = self.nearest(simd, lanes);
        let (mut ahead, mut behind) = (first, first);
        while low > 0 && high < RING {
            let (on, next) = self.follow(simd, ahead, lanes, 1.0);
            let (back, last) = self.follow(simd, behind, lanes, -1.0);
            if on.max(back) > OPEN {
                return f64::INFINITY;
            }
            if last != ahead || next == behind {
                self.ring[high] = (self.place(ahead, on), next);
                high += 1;
            }
            if next != behind {
                low -= 1;
                self.ring[low] = (self.place(behind, -back), behind);
            }
            if next == behind || last == ahead || next == last {
                break;
            }
            (ahead, behind) = (next, last);
        }
        self.put_down(low..high, slack, corners)
    }

    /// Appends the corners that begin an edge longer than `slack`.
    #[inline(always)]
    fn put_down(&mut self, ring: Range<usize>, slack: f64, corners: &mut Vec<Corner>) -> f64 {
        let (begin, mut reach) = (corners.len(), 0.0_f64);
        let mut before = self.ring[ring.end - 1];
        for corner in &self.ring[ring] {
            let kept = corners.len() - begin;
            if (corner.0 - before.0).norm_squared() > slack * slack && kept < MOST_CORNERS {
                reach = reach.max(before.0.norm_squared());
                self.lanes[kept] = before.1 as u8;
                corners.push(Corner { place: before.0, label: self.label[before.1] });
            }
            before = *corner;
        }
        reach
    }

    /// The place on the line of a lane at `share` of its distance to the left of its foot.
    #[inline(always)]
    fn place(&self, lane: usize, share: f64) -> Vector2<f64> {
        let (x, y) = (self.x[lane], self.y[lane]);
        Vector2::new(0.5 * x - share * y, 0.5 * y + share * x)
    }

    /// Half squared distances, and lanes that bound nothing up to a full block; returns how many there are. A particle
    /// that coincides with this one, which `own` is the label of, is parted from it along x.
    #[inline(always)]
    fn complete(&mut self, own: u32, coincide: f64) -> usize {
        let lanes = self.count.next_multiple_of(WIDTH);
        for at in self.count..lanes {
            (self.x[at], self.y[at]) = (f64::MAX.sqrt(), 0.0);
        }
        let mut least = f64::MAX;
        for ((half, x), y) in self.half[..lanes].iter_mut().zip(&self.x).zip(&self.y) {
            *half = 0.5 * (x * x + y * y);
            least = if *half < least { *half } else { least };
        }
        if least < 0.5 * coincide * coincide {
            for at in 0..self.count {
                if self.half[at] < 0.5 * coincide * coincide {
                    let x = if own < self.label[at] { 2.0 * coincide } else { -2.0 * coincide };
                    (self.x[at], self.y[at], self.half[at]) = (x, 0.0, 0.5 * x * x);
                }
            }
        }
        for at in self.count..lanes {
            self.x[at] = 0.0;
        }
        lanes
    }

    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, lanes: usize) -> usize {
        let mut best = simd.splat_f64s(f64::MAX);
        let clear = simd.splat_f64s(f64::from_bits(!LANE));
        let (half, tags) = (S::as_simd_f64s(&self.half[..lanes]).0, S::as_simd_f64s(&TAGS[..lanes]).0);
        for (&half, &tag) in half.iter().zip(tags) {
            best = simd.min_f64s(best, simd.or_f64s(simd.and_f64s(half, clear), tag));
        }
        lane_of(simd.reduce_min_f64s(best))
    }

    /// Where on the line of a lane the cell ends, counter-clockwise for `way` 1, clockwise for -1, and the lane whose
    /// line it meets there. The lane travels in the last bits of the number: a relative change of 1e-14.
    #[inline(always)]
    fn follow<S: Simd>(&self, simd: S, lane: usize, lanes: usize, way: f64) -> (f64, usize) {
        let (x, y) = (S::as_simd_f64s(&self.x[..lanes]).0, S::as_simd_f64s(&self.y[..lanes]).0);
        let (half, tags) = (S::as_simd_f64s(&self.half[..lanes]).0, S::as_simd_f64s(&TAGS[..lanes]).0);
        let (dx, dy) = (simd.splat_f64s(way * self.x[lane]), simd.splat_f64s(way * self.y[lane]));
        let (half_dx, half_dy) = (simd.splat_f64s(0.5 * self.x[lane]), simd.splat_f64s(0.5 * self.y[lane]));
        let (zero, never) = (simd.splat_f64s(0.0), simd.splat_f64s(f64::MAX));
        let clear = simd.splat_f64s(f64::from_bits(!LANE));
        let mut best = never;
        for (((&x, &y), &half), &tag) in x.iter().zip(y).zip(half).zip(tags) {
            let across = simd.sub_f64s(simd.mul_f64s(y, dx), simd.mul_f64s(x, dy));
            let along = simd.add_f64s(simd.mul_f64s(x, half_dx), simd.mul_f64s(y, half_dy));
            let share = simd.div_f64s(simd.sub_f64s(half, along), across);
            let met = simd.select_f64s(simd.greater_than_f64s(across, zero), share, never);
            best = simd.min_f64s(best, simd.or_f64s(simd.and_f64s(met, clear), tag));
        }
        let best = simd.reduce_min_f64s(best);
        (best, lane_of(best))
    }
}

#[inline(always)]
fn lane_of(value: f64) -> usize {
    (value.to_bits() & LANE) as usize
}

#[cfg(test)]
mod tests {
    use super::super::polygon;
    use super::*;
    use pulp::{Arch, Scalar, WithSimd};

    /// Corners of the cell of a particle at the origin among others, inside a box with sides 2.8.
    struct Walk<'a>(&'a [(f64, f64)]);

    impl WithSimd for Walk<'_> {
        type Output = (f64, Vec<Corner>);

        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let (x, y): (Vec<f64>, Vec<f64>) = self.0.iter().copied().unzip();
            let members: Vec<u32> = (1..=x.len() as u32).collect();
            let mut around = NeighbourLanes::default();
            around.clear();
            around.put_box(1.4);
            around.put_row(&Vector2::zeros(), 0, &Row { members: &members, x: &x, y: &y }, [0.0, 8.0]);
            let mut corners = Vec::new();
            let reach = around.walk(simd, 0, 1e-9, &mut corners);
            (reach, corners)
        }
    }

    fn scattered(seed: usize) -> Vec<(f64, f64)> {
        let noise = |k: usize| (((k + 17 * seed) * 7919 + 31) % 1009) as f64 / 252.25 - 2.0;
        (0..14).map(|k| (noise(2 * k), noise(2 * k + 1))).collect()
    }

    #[test]
    fn a_square_lattice_gives_a_square() {
        let lattice: Vec<_> =
            (0..9).filter(|k| *k != 4).map(|k| (f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0)).collect();
        let (reach, corners) = Arch::new().dispatch(Walk(&lattice));
        assert_eq!(corners.len(), 4, "corners that touch a cell in a point only are left out");
        assert!((reach - 0.5).abs() < 1e-13 && (polygon::area(&corners) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_corner_is_as_far_from_its_neighbours_and_no_particle_is_nearer() {
        for seed in 0..200 {
            let others = scattered(seed);
            let (_, corners) = Arch::new().dispatch(Walk(&others));
            assert!(polygon::area(&corners) > 0.0, "seed {seed}");
            for corner in &corners {
                let own = corner.place.norm();
                for &(x, y) in &others {
                    let distance = (corner.place - Vector2::new(x, y)).norm();
                    assert!(distance > own - 1e-9, "seed {seed}: ({x}, {y}) is nearer to a corner");
                }
                if corner.label != BOX {
                    let (x, y) = others[corner.label as usize - 1];
                    let distance = (corner.place - Vector2::new(x, y)).norm();
                    assert!((distance - own).abs() < 1e-9, "seed {seed}");
                }
            }
        }
    }

    #[test]
    fn vectors_of_any_width_give_the_same_bits() {
        for seed in 0..200 {
            let others = scattered(seed);
            let (wide, narrow) = (Arch::new().dispatch(Walk(&others)), Walk(&others).with_simd(Scalar));
            let bits = |corners: &[Corner]| -> Vec<(u64, u64, u32)> {
                corners.iter().map(|it| (it.place.x.to_bits(), it.place.y.to_bits(), it.label)).collect()
            };
            assert_eq!(bits(&wide.1), bits(&narrow.1), "seed {seed}");
        }
    }
}
