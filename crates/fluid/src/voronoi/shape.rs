//! From the outline of a cell to the cell: which of its corners lie in empty space, and where its free surface runs.
//!
//! Corners far from the particle belong to empty space. There the cell ends at the free surface, which runs at the same
//! distance delta outside the lines from the particle to its neighbours along the surface, and round the particle where
//! these lines turn away from each other. The cell's area is then a quadratic in delta, A = C + H delta + Phi delta^2 / 2,
//! and delta is what makes it the particle's own area: the position of the free surface follows from the volume.
//!
//! A corner is not in empty space at one instant and in water at the next: its share of emptiness grows from 0 to 1 over
//! a band of distances, and round the edge of a solid with the room that there is (`edges.rs`). A cell is the mean, over all
//! thresholds from 0 to 1, of the cells in which the corners above the threshold lie in empty space and the others do not. So
//! areas, facets and the conductance to the air are continuous in the positions, and a void that closes does so over several
//! steps: a cell that changed by a finite amount within one step would be answered with a pressure of 1/dt.

use super::cell::Cell;
use super::facet::{Facet, held, turn};
use super::polygon::{BOX, Corner, Plane, Ring, WALL};
use super::wall_clip::MOST;
use nalgebra::Vector2;
use std::f64::consts::PI;

/// Distance in spacings up to which no corner lies in empty space. Three particles of a surface a spacing apart that fold
/// together have just the room that they need when their corner is 1.12 spacings away.
pub const OPEN: f64 = 1.0;
/// The same where the cells around the corner have no room beyond what their areas fill, and the room over their areas, on
/// average, from which on it begins to fall to `OPEN`, and up to which it does.
const FULL: f64 = 1.25;
const ROOMY: [f64; 2] = [1.1, 1.3];
/// Share of `OPEN` up to which rounding does not decide whether a corner lies in empty space.
pub const INTERIOR: f64 = 0.99;
/// Distance in spacings from which on every corner does. Nearer corners are seen alike by all cells that share them,
/// since particles are looked for up to twice this distance.
pub const FAR: f64 = 1.4;
/// Largest turn of the free surface that is a corner \[rad\].
const SHARPEST: f64 = 1.9;
/// Least and largest distance of the free surface from a particle, in spacings.
const DEPTHS: [f64; 2] = [0.15, 0.9];
/// Least length of the free surface of a cell in spacings: with none the cell's pressure would be undetermined.
const LEAST_SURFACE: f64 = 0.1;
/// Walls have the labels above this many below the box.
const MOST_WALLS: u32 = MOST as u32;
/// Corners of an outline that are looked at; a cell has six on average.
pub(super) const CORNERS: usize = 64;

/// Angle from one unit vector to another, counter-clockwise, from -pi to pi.
fn turn_of(from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
    from.perp(to).atan2(from.dot(to))
}

/// What a turn of the free surface by `angle` adds to its length, over delta: straight sides meet in a point up to
/// `SHARPEST`; beyond, the surface goes round.
fn corner_bend(angle: f64) -> f64 {
    let sharp = angle.clamp(-SHARPEST, SHARPEST);
    2.0 * (0.5 * sharp).tan() + (angle - sharp).max(0.0)
}

/// A smooth step from 0 to 1 over a band.
pub(super) fn smooth_step(value: f64, [low, high]: [f64; 2]) -> f64 {
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// How an edge of the polygon bounds the cell.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Bound {
    /// Both ends in the water.
    Whole,
    /// Towards empty space, walking counter-clockwise.
    Exit,
    /// Back from empty space.
    Entry,
    /// Both ends in empty space.
    Chord,
    /// In empty space altogether.
    Nothing,
}

/// What an outline lies in.
pub struct Around<'a> {
    /// Planes of its edges.
    pub planes: &'a dyn Fn(u32) -> Plane,
    /// Area of the cell behind a label over its own; of the cell itself for the label `BOX`; 0 for a wall.
    pub relative_area: &'a dyn Fn(u32) -> f64,
    /// Particle spacing \[m\].
    pub spacing: f64,
}

/// Room for the outline of one cell.
#[derive(Debug)]
pub struct ShapeBuffers {
    /// Corners of the polygon, counter-clockwise.
    pub(super) corners: [Corner; CORNERS],
    /// How far each corner lies in empty space, 0 to 1, or the water ends before it.
    pub(super) empty: [f64; CORNERS],
    /// How far the particle and the one behind each edge hold together where both ends of the edge lie in empty space.
    held: [f64; CORNERS],
}

/// The outline of one cell with what lies around it.
pub struct Shape<'a> {
    pub(super) buffers: &'a mut ShapeBuffers,
    /// Number of its corners.
    pub(super) count: usize,
    pub(super) around: Around<'a>,
}

/// A cell at one threshold of emptiness.
#[derive(Clone, Copy, Default)]
struct Level {
    area: f64,
    depth: f64,
    surface: f64,
}

impl Default for ShapeBuffers {
    fn default() -> Self {
        let nowhere = Corner { place: Vector2::zeros(), label: BOX };
        Self { corners: [nowhere; CORNERS], empty: [0.0; CORNERS], held: [1.0; CORNERS] }
    }
}

impl<'a> Shape<'a> {
    /// An outline with its corners counter-clockwise, written to `buffers`.
    pub fn new(corners: &[Corner], around: Around<'a>, buffers: &'a mut ShapeBuffers) -> Self {
        let count = corners.len().min(CORNERS);
        buffers.corners[..count].copy_from_slice(&corners[..count]);
        let mut shape = Self { buffers, count, around };
        (0..count).for_each(|k| shape.buffers.empty[k] = shape.emptiness(k));
        if (0..count).any(|k| shape.is_wall(k)) {
            shape.part_at_edges();
        }
        (0..count).for_each(|k| shape.buffers.held[k] = shape.hold(k));
        shape
    }

    fn place(&self, k: usize) -> Vector2<f64> {
        self.buffers.corners[self.wrapped(k)].place
    }

    pub(super) fn wrapped(&self, k: usize) -> usize {
        if k == self.count { 0 } else { k }
    }

    /// Whether the other cells might see other facets than this one.
    pub fn is_asymmetric(&self, walls: usize) -> bool {
        let limit = (INTERIOR * OPEN * self.around.spacing).powi(2);
        walls > 0 || self.buffers.corners[..self.count].iter().any(|corner| corner.place.norm_squared() > limit)
    }

    /// How far corner k lies in empty space: far from its particles, the nearer the more room these have beyond what
    /// their areas fill.
    fn emptiness(&self, k: usize) -> f64 {
        let distance = self.buffers.corners[k].place.norm() / self.around.spacing;
        if distance <= OPEN || distance >= FAR {
            return f64::from(u8::from(distance >= FAR));
        }
        let relative_area = self.around.relative_area;
        let (mut sum, mut cells) = (relative_area(BOX), 1.0);
        for label in [self.buffers.corners[(k + self.count - 1) % self.count].label, self.buffers.corners[k].label] {
            let area = if label == BOX { 0.0 } else { relative_area(label) };
            if area > 0.0 {
                (sum, cells) = (sum + area, cells + 1.0);
            }
        }
        let begin = FULL - (FULL - OPEN) * smooth_step(sum / cells, ROOMY);
        smooth_step(distance, [begin, FAR])
    }

    /// Whether edge k is a wall.
    pub(super) fn is_wall(&self, k: usize) -> bool {
        let label = self.buffers.corners[k].label;
        label > BOX - MOST_WALLS && label != BOX
    }

    /// Whether edge k is a wall that the particle stands behind: the far side of a solid's corner.
    pub(super) fn is_hidden(&self, k: usize) -> bool {
        self.is_wall(k) && (self.around.planes)(self.buffers.corners[k].label).distance <= 0.0
    }

    /// Edge k of the polygon as a facet.
    fn facet(&self, k: usize) -> Facet {
        let neighbour = self.buffers.corners[k].label;
        let plane = (self.around.planes)(neighbour);
        let along = turn(&plane.normal);
        let ends = [along.dot(&self.buffers.corners[k].place), along.dot(&self.place(k + 1))];
        Facet::new(neighbour, plane.normal, plane.distance, ends)
    }

    /// How far the water holds together across edge k when both its ends lie in empty space.
    fn hold(&self, k: usize) -> f64 {
        if self.buffers.corners[k].label == BOX
            || self.buffers.empty[k].min(self.buffers.empty[self.wrapped(k + 1)]) == 0.0
        {
            return 1.0;
        }
        let Facet { height, from, to, .. } = self.facet(k);
        let reaches = height > 0.0 && from < 0.0 && to > 0.0;
        if reaches { held(2.0 * height / self.around.spacing) } else { 0.0 }
    }

    /// How edge k bounds the cell whose corners above `threshold` lie in empty space.
    fn bound(&self, k: usize, threshold: f64) -> Bound {
        let label = self.buffers.corners[k].label;
        match (self.buffers.empty[k] > threshold, self.buffers.empty[self.wrapped(k + 1)] > threshold) {
            _ if label == BOX => Bound::Nothing,
            (false, false) => Bound::Whole,
            (false, true) => Bound::Exit,
            (true, false) => Bound::Entry,
            (true, true) if self.buffers.held[k] > threshold => Bound::Chord,
            (true, true) => Bound::Nothing,
        }
    }

    /// The cell, of the area `volume` where it is open and the surface can be placed so; `add` receives its facets.
    pub fn cell(&self, volume: f64, mut add: impl FnMut(Facet)) -> Cell {
        let empty = &self.buffers.empty[..self.count];
        let openness = empty.iter().copied().fold(0.0, f64::max);
        let mut cell = self.closed_part(1.0 - openness);
        cell.openness = openness;
        cell.filled = cell.area + openness * volume;
        let mut threshold = 0.0;
        while threshold < openness {
            let held = &self.buffers.held[..empty.len()];
            let above = empty.iter().chain(held).copied().filter(|&share| share > threshold);
            let next = above.fold(openness, f64::min);
            let (share, level) = (next - threshold, self.level(threshold, volume));
            cell.area += share * level.area;
            cell.depth += share * level.depth / openness;
            cell.surface += share * level.surface;
            cell.centroid += self.centroid(threshold, level.depth) * share;
            threshold = next;
        }
        for k in 0..self.count {
            self.add_facet(k, cell.depth, &mut add);
        }
        cell
    }

    /// `share` of the cell that is closed all round.
    fn closed_part(&self, share: f64) -> Cell {
        if share == 0.0 {
            return Cell::default();
        }
        let mut outline = Ring::default();
        self.buffers.corners[..self.count].iter().for_each(|corner| outline.walk(corner.place));
        let (area, centroid) = outline.close();
        Cell::closed(share * area, centroid * share)
    }

    /// Passes on edge k as a facet. Those to particles end at the free surface once the depths of both cells are known;
    /// those on walls end here.
    fn add_facet(&self, k: usize, depth: f64, add: &mut impl FnMut(Facet)) {
        let label = self.buffers.corners[k].label;
        let ends = [self.buffers.empty[k], self.buffers.empty[self.wrapped(k + 1)]];
        if label == BOX || (ends == [1.0; 2] && self.bound(k, 0.0) == Bound::Nothing) {
            return;
        }
        let mut facet = self.facet(k).with_empty_ends(ends);
        if label > BOX - MOST_WALLS {
            self.end_on_wall(&mut facet, depth);
        }
        add(facet);
    }

    /// Ends a facet at `depth`; a wall may end before the free surface meets its line.
    fn end_on_wall(&self, facet: &mut Facet, depth: f64) {
        let (from, to) = (facet.from, facet.to);
        facet.end_at(depth, self.around.spacing);
        (facet.from, facet.to) = (facet.from.max(from), facet.to.min(to));
    }

    /// Area, depth and length of the free surface of the cell whose corners above `threshold` lie in empty space.
    fn level(&self, threshold: f64, volume: f64) -> Level {
        let spacing = self.around.spacing;
        let (constant, linear, bend) = self.area_of_depth(threshold);
        let lack = volume - constant;
        let root = (linear * linear + 2.0 * bend * lack).max(0.0).sqrt();
        let wanted = 2.0 * lack / (linear + root).max(1e-12 * spacing);
        // A surface that turns inwards has no length left where its sides meet: there it closes.
        let closes = if bend < 0.0 { (-linear / bend).max(DEPTHS[0] * spacing) } else { f64::INFINITY };
        let depth = wanted.clamp(DEPTHS[0] * spacing, closes.min(DEPTHS[1] * spacing));
        let surface = (linear + bend * depth).max(LEAST_SURFACE * spacing);
        Level { area: constant + linear * depth + 0.5 * bend * depth * depth, depth, surface }
    }

    /// Whether the edges between entry and exit of a cell with one free surface turn clockwise all in all: those of a
    /// solid's corner, round which the free surface makes more than a full turn.
    fn turns_backwards(&self, threshold: f64) -> bool {
        let (mut gaps, mut turned) = (0, 0.0);
        let (mut first, mut last): (Option<Vector2<f64>>, Option<Vector2<f64>>) = (None, None);
        for k in 0..self.count {
            let bound = self.bound(k, threshold);
            if bound == Bound::Nothing {
                continue;
            }
            let normal = (self.around.planes)(self.buffers.corners[k].label).normal;
            if matches!(bound, Bound::Entry | Bound::Chord) {
                gaps += 1;
            } else {
                match last {
                    Some(before) => turned += turn_of(&before, &normal),
                    None => first = Some(normal),
                }
            }
            last = Some(normal);
        }
        if let (Some(last), Some(first)) = (last, first) {
            turned += turn_of(&last, &first);
        }
        gaps == 1 && turned < -1e-9
    }

    /// C, H and Phi of the area C + H delta + Phi delta^2 / 2 that the cell has with its free surface at delta.
    fn area_of_depth(&self, threshold: f64) -> (f64, f64, f64) {
        let (mut constant, mut linear, mut bend) = (0.0, 0.0, 0.0);
        let mut last_exit: Option<Vector2<f64>> = None;
        let mut first_entry: Option<Vector2<f64>> = None;
        let backwards = self.turns_backwards(threshold);
        let mut turn_between = |from: &Vector2<f64>, to: &Vector2<f64>| {
            let angle = turn_of(from, to);
            let angle = if angle <= 1e-9 || backwards { angle + 2.0 * PI } else { angle };
            bend += corner_bend(angle - PI);
        };
        for k in 0..self.count {
            let bound = self.bound(k, threshold);
            if bound == Bound::Nothing {
                continue;
            }
            let Facet { normal, height: h, from, to, .. } = self.facet(k);
            match bound {
                Bound::Whole => constant += 0.5 * h * (to - from),
                Bound::Exit => (constant, linear) = (constant - 0.5 * h * from, linear + h),
                Bound::Entry => (constant, linear) = (constant + 0.5 * h * to, linear + h),
                _ => linear += 2.0 * h,
            }
            if matches!(bound, Bound::Entry | Bound::Chord) {
                match last_exit.take() {
                    Some(exit) => turn_between(&exit, &normal),
                    None => first_entry = Some(normal),
                }
            }
            if matches!(bound, Bound::Exit | Bound::Chord) {
                last_exit = Some(normal);
            }
        }
        match (last_exit, first_entry) {
            (Some(exit), Some(entry)) => turn_between(&exit, &entry),
            (None, None) if linear == 0.0 => bend = 2.0 * PI,
            _ => {}
        }
        (constant, linear, bend)
    }

    /// Centroid of the cell whose corners above `threshold` lie in empty space and whose free surface stands at `depth`.
    fn centroid(&self, threshold: f64, depth: f64) -> Vector2<f64> {
        let mut outline = Ring::default();
        for k in 0..self.count {
            let bound = self.bound(k, threshold);
            if bound == Bound::Nothing {
                continue;
            }
            let ends = [matches!(bound, Bound::Entry | Bound::Chord), matches!(bound, Bound::Exit | Bound::Chord)];
            let mut facet = self.facet(k).with_empty_ends(ends.map(|empty| f64::from(u8::from(empty))));
            if facet.neighbour > BOX - MOST_WALLS {
                self.end_on_wall(&mut facet, depth);
            } else {
                facet.end_at(depth, self.around.spacing);
            }
            let (foot, along) = (facet.normal * facet.height, turn(&facet.normal));
            if ends[0] {
                outline.walk(along * -depth);
            }
            outline.walk(foot + along * facet.from);
            outline.walk(foot + along * facet.to);
            if ends[1] {
                outline.walk(along * depth);
            }
        }
        outline.close().1
    }
}

/// Whether a label is a wall's, and its index.
pub fn wall_of(label: u32, walls: usize) -> Option<usize> {
    let index = (WALL - label.min(WALL)) as usize;
    (index < walls).then_some(index)
}
