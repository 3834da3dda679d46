//! The cell of one particle: facets to neighbours and walls, and the free surface where nothing else bounds it.
//!
//! Corners farther from the particle than `OPEN` spacings belong to empty space. There the cell ends at the free
//! surface, which runs at the same distance delta outside the lines from the particle to its neighbours along the
//! surface, and round the particle where these lines turn away from each other. The cell's area is then a quadratic
//! in delta, A = C + H delta + Phi delta^2 / 2, and delta is what makes it the particle's own area: the position of
//! the free surface follows from the volume.

use super::notch::MOST;
use super::polygon::{BOX, Corner, Plane, Ring, WALL};
use nalgebra::Vector2;
use std::f64::consts::PI;

/// Distance in spacings from which on a corner lies in empty space. A rectangular lattice stretched 2:1 just closes.
pub const OPEN: f64 = 1.1;
/// Share of `OPEN` up to which rounding does not decide whether a corner lies in empty space.
pub const SURE: f64 = 0.99;
/// Distance in spacings from which on it always does. Nearer corners are seen alike by all cells that share them, since
/// particles are looked for up to twice this distance.
pub const FAR: f64 = 1.4;
/// Mean room of the cells around such a corner, over their areas, from which on the corner lies in empty space.
const ROOMY: f64 = 1.35;
/// Largest distance in spacings of two particles that touch though both ends of their facet lie in empty space.
const TOUCHING: f64 = 1.6;
/// Largest turn of the free surface that is a corner \[rad\].
const SHARPEST: f64 = 1.9;
/// Ratio of |S| to the length of the surface at and below which the surface counts as round.
const ROUND: f64 = 0.8;
/// Walls have the labels above this many below the box.
const MOST_WALLS: u32 = MOST as u32;
/// Least and largest distance of the free surface from a particle, in spacings.
const DEPTHS: [f64; 2] = [0.15, 0.8];

/// A facet between two particles, or of a particle on a wall, seen from the particle. Places along it count from the
/// foot of the perpendicular from the particle, counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// The other particle; for a wall the index of its plane.
    pub neighbour: u32,
    /// How the facet meets the free surface.
    pub bound: Bound,
    /// Unit vector to the neighbour or into the wall.
    pub normal: Vector2<f64>,
    /// Distance of the facet's line from the particle, half the distance to the neighbour \[m\].
    pub height: f64,
    /// Start along the line \[m\].
    pub from: f64,
    /// End along the line \[m\].
    pub to: f64,
}

impl Facet {
    /// Length \[m\].
    #[inline]
    pub fn length(&self) -> f64 {
        self.to - self.from
    }

    /// Length over the distance of the two particles.
    #[inline]
    pub fn weight(&self) -> f64 {
        (self.to - self.from) / (2.0 * self.height)
    }

    /// From the particle to the middle \[m\].
    #[inline]
    pub fn middle(&self) -> Vector2<f64> {
        self.normal * self.height + turn(&self.normal) * (0.5 * (self.from + self.to))
    }

    /// From the middle to the neighbour \[m\].
    #[inline]
    pub fn beyond(&self) -> Vector2<f64> {
        self.normal * self.height - turn(&self.normal) * (0.5 * (self.from + self.to))
    }

    /// The part of the facet that the neighbour sees in its facet `seen` too.
    pub fn common(&self, seen: &Self) -> Option<Self> {
        let (from, to) = (self.from.max(-seen.to), self.to.min(-seen.from));
        (to > from).then_some(Self { from, to, ..*self })
    }

    /// Ends the facet where the free surface crosses it, `depth` outside the foot.
    pub fn end_at(&mut self, depth: f64) {
        match self.bound {
            Bound::Exit => self.to = depth.max(self.from),
            Bound::Entry => self.from = (-depth).min(self.to),
            Bound::Chord => (self.from, self.to) = (-depth, depth),
            _ => {}
        }
    }
}

/// The rest of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Cell {
    /// Area \[m2\].
    pub area: f64,
    /// From the particle to the centroid of its cell \[m\].
    pub centroid: Vector2<f64>,
    /// Distance of the free surface from the particle \[m\]; 0 for a cell without.
    pub depth: f64,
    /// Length of the free surface \[m\]; 0 for a cell without.
    pub surface: f64,
    /// Integral of the outward normal over the free surface \[m\].
    pub outward: Vector2<f64>,
    /// Weight of the particle's pressure in the force that the free surface puts on the cell \[m\].
    pub lift: Vector2<f64>,
    /// Whether its facets might not be those of its neighbours: beside walls and where corners may lie in empty space.
    pub odd: bool,
}

impl Cell {
    /// Whether the cell has a free surface.
    pub fn is_open(&self) -> bool {
        self.surface > 0.0
    }

    /// 1 where the free surface is straight or there is none, 0 where it turns by a right angle or more.
    pub fn flatness(&self) -> f64 {
        if !self.is_open() {
            return 1.0;
        }
        ((self.outward.norm() / self.surface - ROUND) / (1.0 - ROUND)).clamp(0.0, 1.0)
    }
}

/// A vector turned counter-clockwise by a right angle.
#[inline]
pub fn turn(vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-vector.y, vector.x)
}

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

/// How an edge of the polygon bounds the cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
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

/// One polygon with the planes of its edges.
pub struct Shape<'a> {
    /// Corners of the polygon, counter-clockwise.
    pub corners: &'a [Corner],
    pub planes: &'a dyn Fn(u32) -> Plane,
    /// Area of the cell behind a label over its own; of the cell itself for the label `BOX`; 0 for a wall.
    pub fullness: &'a dyn Fn(u32) -> f64,
    pub spacing: f64,
}

impl Shape<'_> {
    fn place(&self, k: usize) -> Vector2<f64> {
        self.corners[if k == self.corners.len() { 0 } else { k }].place
    }

    /// Whether any corner lies in empty space.
    pub fn is_open(&self) -> bool {
        (0..self.corners.len()).any(|k| self.is_empty(k))
    }

    /// Whether the other cells might see other facets than this one.
    pub fn is_odd(&self, walls: usize) -> bool {
        let limit = (SURE * OPEN * self.spacing).powi(2);
        walls > 0 || self.corners.iter().any(|corner| corner.place.norm_squared() > limit)
    }

    /// Edge k of the polygon as a facet.
    fn facet(&self, k: usize, bound: Bound) -> Facet {
        let neighbour = self.corners[k].label;
        let plane = (self.planes)(neighbour);
        let along = turn(&plane.normal);
        let (from, to) = (along.dot(&self.corners[k].place), along.dot(&self.place(k + 1)));
        Facet { neighbour, bound, normal: plane.normal, height: plane.distance, from, to }
    }

    /// A closed cell: `add` receives its facets.
    pub fn close(&self, mut add: impl FnMut(Facet)) -> Cell {
        let mut outline = Ring::default();
        for (k, corner) in self.corners.iter().enumerate() {
            outline.walk(corner.place);
            add(self.facet(k, Bound::Whole));
        }
        let (area, centroid) = outline.close();
        Cell { area, centroid, ..Cell::default() }
    }

    /// Whether corner k lies in empty space: far from its particles, and these have more room than their areas fill.
    fn is_empty(&self, k: usize) -> bool {
        let squared = self.corners[k].place.norm_squared() / (self.spacing * self.spacing);
        if squared <= OPEN * OPEN || squared > FAR * FAR {
            return squared > FAR * FAR;
        }
        let count = self.corners.len();
        let (before, after) = (self.corners[(k + count - 1) % count].label, self.corners[k].label);
        if before == BOX || after == BOX {
            return true;
        }
        let (mut sum, mut cells) = ((self.fullness)(BOX), 1.0);
        for room in [(self.fullness)(before), (self.fullness)(after)] {
            if room > 0.0 {
                (sum, cells) = (sum + room, cells + 1.0);
            }
        }
        sum > ROOMY * cells
    }

    /// Whether edge k is a wall that the particle stands behind: the far side of a solid's corner.
    fn is_hidden(&self, k: usize) -> bool {
        let label = self.corners[k].label;
        label > BOX - MOST_WALLS && label != BOX && (self.planes)(label).distance <= 0.0
    }

    /// Whether the water ends before corner k. It does not reach round the corner of a solid along a wall whose other
    /// end lies in empty space.
    fn is_beyond(&self, k: usize) -> bool {
        let count = self.corners.len();
        let (before, after) = ((k + count - 1) % count, (k + 1) % count);
        let round = |edge: usize, end: usize| self.is_hidden(edge) && self.is_empty(end);
        self.is_empty(k) || round(k, after) || round(before, before)
    }

    fn bound(&self, k: usize) -> Bound {
        let (a, b) = (self.corners[k].place, self.place(k + 1));
        let label = self.corners[k].label;
        match (self.is_beyond(k), self.is_beyond((k + 1) % self.corners.len())) {
            _ if label == BOX => Bound::Nothing,
            (false, false) => Bound::Whole,
            (false, true) => Bound::Exit,
            (true, false) => Bound::Entry,
            (true, true) => {
                let plane = (self.planes)(label);
                let along = turn(&plane.normal);
                let reaches = along.dot(&a) < 0.0 && along.dot(&b) > 0.0;
                let touches = plane.distance > 0.0 && 2.0 * plane.distance < TOUCHING * self.spacing;
                if reaches && touches { Bound::Chord } else { Bound::Nothing }
            }
        }
    }

    /// A cell with a free surface, of the area `volume` if the surface can be placed so; `add` receives its facets.
    pub fn surface(&self, volume: f64, add: impl FnMut(Facet)) -> Cell {
        let (constant, linear, bend) = self.area_of_depth();
        let lack = volume - constant;
        let root = (linear * linear + 2.0 * bend * lack).max(0.0).sqrt();
        let wanted = 2.0 * lack / (linear + root).max(1e-12 * self.spacing);
        let depth = wanted.clamp(DEPTHS[0] * self.spacing, DEPTHS[1] * self.spacing);
        let surface = (linear + bend * depth).max(0.2 * self.spacing);
        let area = constant + linear * depth + 0.5 * bend * depth * depth;
        let centroid = self.finish(depth, add);
        Cell { area, centroid, depth, surface, ..Cell::default() }
    }

    /// Whether the edges between entry and exit of a cell with one free surface turn clockwise all in all: those of a
    /// solid's corner, round which the free surface makes more than a full turn.
    fn turns_backwards(&self) -> bool {
        let (mut gaps, mut turned) = (0, 0.0);
        let (mut first, mut last): (Option<Vector2<f64>>, Option<Vector2<f64>>) = (None, None);
        for k in 0..self.corners.len() {
            let bound = self.bound(k);
            if bound == Bound::Nothing {
                continue;
            }
            let normal = (self.planes)(self.corners[k].label).normal;
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
    fn area_of_depth(&self) -> (f64, f64, f64) {
        let (mut constant, mut linear, mut bend) = (0.0, 0.0, 0.0);
        let mut last_exit: Option<Vector2<f64>> = None;
        let mut first_entry: Option<Vector2<f64>> = None;
        let backwards = self.turns_backwards();
        let mut turn_between = |from: &Vector2<f64>, to: &Vector2<f64>| {
            let angle = turn_of(from, to);
            let angle = if angle <= 1e-9 || backwards { angle + 2.0 * PI } else { angle };
            bend += corner_bend(angle - PI);
        };
        for k in 0..self.corners.len() {
            let bound = self.bound(k);
            if bound == Bound::Nothing {
                continue;
            }
            let Facet { normal, height: h, from, to, .. } = self.facet(k, bound);
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

    /// Emits the facets of a cell whose free surface stands at `depth`, and returns its centroid.
    fn finish(&self, depth: f64, mut add: impl FnMut(Facet)) -> Vector2<f64> {
        let mut outline = Ring::default();
        for k in 0..self.corners.len() {
            let bound = self.bound(k);
            if bound == Bound::Nothing {
                continue;
            }
            let mut facet = self.facet(k, bound);
            let (from, to) = (facet.from, facet.to);
            facet.end_at(depth);
            if facet.neighbour > BOX - MOST_WALLS {
                // A wall may end before the free surface meets its line.
                (facet.from, facet.to) = (facet.from.max(from), facet.to.min(to));
            }
            let (foot, along) = (facet.normal * facet.height, turn(&facet.normal));
            if matches!(bound, Bound::Entry | Bound::Chord) {
                outline.walk(along * -depth);
            }
            outline.walk(foot + along * facet.from);
            outline.walk(foot + along * facet.to);
            if matches!(bound, Bound::Exit | Bound::Chord) {
                outline.walk(along * depth);
            }
            add(facet);
        }
        outline.close().1
    }
}

/// Whether a label is a wall's, and its index.
pub fn wall_of(label: u32, walls: usize) -> Option<usize> {
    let index = (WALL - label.min(WALL)) as usize;
    (index < walls).then_some(index)
}
