//! Walls: polylines cut into smooth chains of segments, at one instant.
//!
//! A chain is a run of segments without a sharp corner. A particle near a chain is attached to it: it knows its
//! distance, its place along the chain and the normal there. Everything that walls do is expressed with proximities.

use crate::parameters::Geometry;
use crate::walls::candidates::CandidateCells;
use kinematics::{BodySet, MaterialPoint, SurfacePoint};
use nalgebra::{DVector, Vector2};

/// Cosine of the largest kink inside a chain (30 degrees); a larger one starts a new chain.
pub const SMOOTH: f64 = 0.866;

/// Cosine of the angle between the normals of two walls up to which they are sides of one corner, not faces of a plate.
const SAME_SOLID: f64 = -0.5;

/// A straight piece of wall at one instant, fluid on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Start \[m\].
    pub start: Vector2<f64>,
    /// Unit vector along the segment.
    pub tangent: Vector2<f64>,
    /// Unit normal into the solid.
    pub normal: Vector2<f64>,
    /// Length \[m\].
    pub length: f64,
    /// Chain it belongs to.
    pub chain: u32,
    /// Arc length of the chain up to the start \[m\].
    pub arc: f64,
    /// Index of the moving panel it is, or `FIXED`.
    pub panel: u32,
}

/// Panel index of a segment that does not move.
pub const FIXED: u32 = u32::MAX;

impl Segment {
    /// The piece from `start` to `end`.
    pub fn between(start: Vector2<f64>, end: Vector2<f64>, chain: u32, arc: f64, panel: u32) -> Self {
        let along = end - start;
        let length = along.norm();
        let tangent = along / length;
        Self { start, tangent, normal: Vector2::new(tangent.y, -tangent.x), length, chain, arc, panel }
    }

    /// End \[m\].
    pub fn end(&self) -> Vector2<f64> {
        self.start + self.tangent * self.length
    }

    /// Distance of a point in front of the segment's line (negative behind) and its place along the line \[m\].
    pub fn local(&self, point: &Vector2<f64>) -> (f64, f64) {
        let relative = point - self.start;
        (-self.normal.dot(&relative), self.tangent.dot(&relative))
    }

    /// Squared distance of a point to the segment \[m2\].
    pub fn squared_distance(&self, point: &Vector2<f64>) -> f64 {
        let (distance, along) = self.local(point);
        let beyond = along - along.clamp(0.0, self.length);
        distance * distance + beyond * beyond
    }

    /// Where the straight line through `a` and `b`, on different sides, meets the segment's line.
    fn crossing(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> Vector2<f64> {
        let (before, after) = (self.local(a).0, self.local(b).0);
        a + (b - a) * (before / (before - after))
    }

    /// Whether the straight line from `a` to `b` passes through the segment.
    pub fn is_crossed(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> bool {
        let (distance_a, along_a) = self.local(a);
        let (distance_b, along_b) = self.local(b);
        if distance_a * distance_b >= 0.0 {
            return false;
        }
        let along = (along_a * distance_b - along_b * distance_a) / (distance_b - distance_a);
        (0.0..=self.length).contains(&along)
    }
}

/// A run of segments without a sharp corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// First segment.
    pub first: usize,
    /// One past the last segment.
    pub last: usize,
    /// How far behind the wall another wetted face may lie \[m\].
    pub depth: f64,
    /// Length \[m\].
    pub length: f64,
}

/// A particle's relation to a chain near it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallProximity {
    /// Chain.
    pub chain: u32,
    /// Nearest segment.
    pub segment: u32,
    /// Distance from the wall \[m\], positive in front.
    pub distance: f64,
    /// Arc length along the chain \[m\]; beyond its ends the end segments are prolonged.
    pub arc: f64,
    /// Unit normal into the solid at the nearest segment.
    pub normal: Vector2<f64>,
}

/// Which walls there are: the pieces of the fixed polylines and the bodies' panels.
#[derive(Debug, Clone)]
pub struct WallLayout {
    fixed: Vec<[Vector2<f64>; 2]>,
    /// Panels of the bodies, merged where a rigid wall is straight.
    pub panels: Vec<[SurfacePoint; 2]>,
    /// Depth behind each panel \[m\].
    panel_depth: Vec<f64>,
}

impl WallLayout {
    /// Lays out the walls of a geometry; panels of a bending beam are at most two spacings long.
    pub fn new(geometry: &Geometry, spacing: f64) -> Self {
        let pieces = geometry.fixed_walls.iter().flat_map(|wall| wall.windows(2)).map(|pair| [pair[0], pair[1]]);
        let mut layout = Self { fixed: pieces.collect(), panels: Vec::new(), panel_depth: Vec::new() };
        for (body, panel) in geometry.bodies.panels(2.0 * spacing) {
            let thickness = match panel.ends[0] {
                MaterialPoint::Beam { member, .. } => geometry.bodies.bodies()[body].members[member].thickness,
                MaterialPoint::Rigid(_) => f64::INFINITY,
            };
            layout.add_panel(panel.ends.map(|point| SurfacePoint { body, point }), thickness);
        }
        layout
    }

    fn add_panel(&mut self, ends: [SurfacePoint; 2], depth: f64) {
        if let ([MaterialPoint::Rigid(start), MaterialPoint::Rigid(end)], Some(last)) =
            (ends.map(|end| end.point), self.panels.last_mut())
            && let [MaterialPoint::Rigid(before), MaterialPoint::Rigid(joint)] = last.map(|end| end.point)
        {
            let straight = (joint - before).normalize().dot(&(end - start).normalize()) > 1.0 - 1e-9;
            if last[1].body == ends[0].body && (joint - start).norm() < 1e-12 && straight {
                last[1] = ends[1];
                return;
            }
        }
        self.panels.push(ends);
        self.panel_depth.push(depth);
    }

    /// Makes the segment of this number `factor` times as long, at its end or at its start.
    pub fn prolong(&mut self, segment: usize, at_end: bool, factor: f64) {
        let (from, moved) = if at_end { (0, 1) } else { (1, 0) };
        if let Some(piece) = self.fixed.get_mut(segment) {
            piece[moved] = piece[from] + (piece[moved] - piece[from]) * factor;
        } else if let Some(panel) = self.panels.get_mut(segment - self.fixed.len())
            && let Some(point) = SurfacePoint::between(panel[from], panel[moved], factor)
        {
            panel[moved] = point;
        }
    }
}

/// All walls at one instant.
#[derive(Debug, Clone, Default)]
pub struct Walls {
    /// Segments, chain after chain.
    pub segments: Vec<Segment>,
    /// Chains.
    pub chains: Vec<Chain>,
    /// Pairs of chains that meet in a corner with the fluid inside.
    concave: Vec<(u32, u32)>,
    cells: CandidateCells,
    radius: f64,
    spacing: f64,
}

impl Walls {
    /// Places the walls for the given coordinates of the bodies; proximities reach `radius` \[m\].
    pub fn place(&mut self, layout: &WallLayout, bodies: Option<(&BodySet, &DVector<f64>)>, radius: f64, spacing: f64) {
        self.segments.clear();
        self.chains.clear();
        (self.radius, self.spacing) = (radius, spacing);
        for (index, [start, end]) in layout.fixed.iter().enumerate() {
            let joined = index > 0 && layout.fixed[index - 1][1] == *start;
            self.add_segment(*start, *end, FIXED, f64::INFINITY, joined);
        }
        if let Some((bodies, coordinates)) = bodies {
            for (index, ends) in layout.panels.iter().enumerate() {
                let joined = index > 0 && layout.panels[index - 1][1] == ends[0];
                let place = |point| bodies.place(point, coordinates);
                self.add_segment(place(ends[0]), place(ends[1]), index as u32, layout.panel_depth[index], joined);
            }
        }
        self.find_concave_corners();
        self.cells.build(&self.segments, radius);
    }

    fn add_segment(&mut self, start: Vector2<f64>, end: Vector2<f64>, panel: u32, depth: f64, joined: bool) {
        let mut segment = Segment::between(start, end, 0, 0.0, panel);
        let smooth = |previous: &Segment| previous.tangent.dot(&segment.tangent) > SMOOTH;
        if !(joined && self.segments.last().is_some_and(smooth)) {
            let first = self.segments.len();
            self.chains.push(Chain { first, last: first, depth, length: 0.0 });
        }
        let index = self.chains.len() - 1;
        let chain = &mut self.chains[index];
        segment.chain = index as u32;
        segment.arc = chain.length;
        chain.length += segment.length;
        chain.last += 1;
        self.segments.push(segment);
    }

    /// A corner is concave when one chain ends on another and runs away from it on the other's wet side, or when two
    /// chains cross.
    fn find_concave_corners(&mut self) {
        self.concave.clear();
        for (index, chain) in self.chains.iter().enumerate() {
            let (first, last) = (&self.segments[chain.first], &self.segments[chain.last - 1]);
            let ends = [(first.start, first.tangent), (last.end(), -last.tangent)];
            for other in self.segments.iter().filter(|segment| segment.chain as usize != index) {
                let touched = ends.iter().any(|(point, away)| self.ends_on(other, point, away));
                let own = &self.segments[chain.first..chain.last];
                let crossed = || own.iter().any(|segment| crosses(segment, other));
                let pair = (other.chain.min(index as u32), other.chain.max(index as u32));
                if (touched || crossed()) && !self.concave.contains(&pair) {
                    self.concave.push(pair);
                }
            }
        }
    }

    fn ends_on(&self, segment: &Segment, point: &Vector2<f64>, away: &Vector2<f64>) -> bool {
        let near = 0.3 * self.spacing;
        segment.squared_distance(point) < near * near && segment.normal.dot(away) < -0.3
    }

    /// Whether two chains meet in a corner with the fluid inside.
    pub fn meet_in_concave_corner(&self, a: u32, b: u32) -> bool {
        self.concave.contains(&(a.min(b), a.max(b)))
    }

    /// Segments that may be within the radius of a point.
    pub fn candidates(&self, point: &Vector2<f64>) -> &[u32] {
        self.cells.of(point)
    }

    /// The point, put just in front of a wall that it stands on or nearly so: within `reach` of it on either side.
    pub fn in_front(&self, point: &Vector2<f64>, reach: f64) -> Vector2<f64> {
        let near = self.candidates(point).iter().map(|&index| &self.segments[index as usize]);
        let on = near.filter(|segment| segment.squared_distance(point) < reach * reach);
        let nearest = on.min_by(|a, b| a.squared_distance(point).total_cmp(&b.squared_distance(point)));
        let least = 0.01 * self.spacing;
        nearest.map_or(*point, |segment| point - segment.normal * (least - segment.local(point).0).max(0.0))
    }

    /// Whether a wall stands between two points, judged by the candidates of the first.
    pub fn separates(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> bool {
        self.candidates(a).iter().any(|&segment| self.segments[segment as usize].is_crossed(a, b))
    }

    /// Whether one of the walls among `candidates` hides two points from each other. Across the corner of a solid, with
    /// less than a spacing of it between them, they see each other: the water goes round.
    pub fn hide(&self, candidates: &[u32], a: &Vector2<f64>, b: &Vector2<f64>) -> bool {
        let mut crossed: [Option<&Segment>; 2] = [None, None];
        for &segment in candidates {
            let segment = &self.segments[segment as usize];
            if segment.is_crossed(a, b) {
                match crossed {
                    [None, _] => crossed[0] = Some(segment),
                    [_, None] => crossed[1] = Some(segment),
                    _ => return true,
                }
            }
        }
        match crossed {
            [None, _] => false,
            [Some(one), Some(other)] => {
                let chord = (one.crossing(a, b) - other.crossing(a, b)).norm();
                chord > self.spacing || one.normal.dot(&other.normal) < SAME_SOLID
            }
            _ => true,
        }
    }

    /// Appends the proximities of a particle: one per chain that it is in front of and that no other wall hides.
    pub fn attach(&self, point: &Vector2<f64>, out: &mut Vec<WallProximity>) {
        let begin = out.len();
        let candidates = self.candidates(point);
        for &index in candidates {
            let segment = &self.segments[index as usize];
            let known = out[begin..].iter().position(|entry| entry.chain == segment.chain);
            match known {
                Some(at) => {
                    let best = self.segments[out[begin + at].segment as usize].squared_distance(point);
                    if segment.squared_distance(point) < best {
                        out[begin + at] = self.proximity(index, point);
                    }
                }
                None => out.push(self.proximity(index, point)),
            }
        }
        let mut keep = begin;
        for at in begin..out.len() {
            if self.counts(&out[at], point, candidates) {
                out[keep] = out[at];
                keep += 1;
            }
        }
        out.truncate(keep);
    }

    fn proximity(&self, index: u32, point: &Vector2<f64>) -> WallProximity {
        let segment = &self.segments[index as usize];
        let (distance, along) = segment.local(point);
        WallProximity {
            chain: segment.chain,
            segment: index,
            distance,
            arc: segment.arc + along,
            normal: segment.normal,
        }
    }

    fn counts(&self, entry: &WallProximity, point: &Vector2<f64>, candidates: &[u32]) -> bool {
        let chain = &self.chains[entry.chain as usize];
        let behind = 0.35 * self.spacing;
        let overhang = entry.arc - entry.arc.clamp(0.0, chain.length);
        // A particle slightly behind its own wall is still attached, so that it can be put back; one on the far side
        // of a thin solid is not.
        let lowest = if overhang == 0.0 { -behind.min(0.5 * chain.depth) } else { 0.0 };
        if entry.distance < lowest || entry.distance >= self.radius || overhang.abs() >= self.radius {
            return false;
        }
        let foot = point + entry.normal * (0.99 * entry.distance);
        !candidates.iter().any(|&other| {
            let segment = &self.segments[other as usize];
            segment.chain != entry.chain && segment.is_crossed(point, &foot)
        })
    }

    /// Whether a particle stands beside its chain, not beyond one of its ends.
    pub fn is_beside(&self, entry: &WallProximity) -> bool {
        (0.0..=self.chains[entry.chain as usize].length).contains(&entry.arc)
    }

    /// Segment of a chain at an arc length, and the fraction of its length.
    pub fn locate(&self, chain: u32, arc: f64) -> (u32, f64) {
        let chain = &self.chains[chain as usize];
        let run = &self.segments[chain.first..chain.last];
        let after = run.partition_point(|segment| segment.arc <= arc);
        let index = after.saturating_sub(1);
        let fraction = ((arc - run[index].arc) / run[index].length).clamp(0.0, 1.0);
        ((chain.first + index) as u32, fraction)
    }
}

/// Whether two segments cross each other.
pub fn crosses(a: &Segment, b: &Segment) -> bool {
    a.is_crossed(&b.start, &b.end()) && b.is_crossed(&a.start, &a.end())
}
