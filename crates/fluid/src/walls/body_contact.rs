//! Contact of the body with fixed walls: nothing of it is modelled here, and a structure that lets it happen is
//! stopped.

use crate::Error;
use crate::grid::bounding_box;
use crate::walls::sides::is_closed;
use crate::walls::{FIXED, Segment, Walls, crosses};
use kinematics::{BodySet, MaterialPoint, Motion, SurfacePoint};
use nalgebra::Vector2;

/// Depth in spacings that a structure with contact forces of its own may need. A panel that is deeper in a wall at the
/// start, as one that is held there, is left alone; one that slides on a wall, as a piston does, stays on it.
const BORNE: f64 = 0.25;

/// Panels of the body and fixed walls that must not meet.
#[derive(Debug, Clone, Default)]
pub struct BodyContact {
    panels: Vec<[SurfacePoint; 2]>,
    /// All panels of each body, where there are several bodies.
    bodies: Vec<Vec<[SurfacePoint; 2]>>,
    /// Whether the rigid walls of a body come back to their first points: then it has an inside.
    closed: Vec<bool>,
    fixed: Vec<Segment>,
    /// Depth up to which a corner may stand behind a wall, as one that is held by a contact force does \[m\].
    depth: f64,
}

impl BodyContact {
    /// From the walls as they stand at the start.
    pub fn new(all: &[[SurfacePoint; 2]], bodies: &BodySet, walls: &Walls, spacing: f64) -> Self {
        let fixed: Vec<Segment> = walls.segments.iter().filter(|segment| segment.panel == FIXED).copied().collect();
        let moving = walls.segments.iter().filter(|segment| segment.panel != FIXED);
        let free = moving.filter(|panel| !fixed.iter().any(|wall| is_through(panel, wall, BORNE * spacing)));
        let panels = free.map(|segment| all[segment.panel as usize]).collect();
        let closed = bodies.bodies().iter().map(|body| body.walls.iter().all(|wall| is_closed(wall))).collect();
        Self { panels, bodies: by_body(all), closed, fixed, depth: BORNE * spacing }
    }

    /// Refuses a motion in which bodies stand in one another. Where the boxes around them do not meet, nothing else is
    /// looked at.
    ///
    /// # Errors
    /// A place where they do.
    pub fn check_apart(&self, bodies: &BodySet, motion: &Motion, time: f64) -> Result<(), Error> {
        let segments = |panels: &Vec<[SurfacePoint; 2]>| -> Vec<Segment> {
            let placed = panels.iter().map(|panel| panel.map(|point| bodies.position(point, motion)));
            placed.map(|[start, end]| Segment::between(start, end, 0, 0.0, 0)).collect()
        };
        let placed: Vec<Vec<Segment>> = self.bodies.iter().map(segments).collect();
        let solid = |k: usize| -> Vec<Segment> {
            let rigid = self.bodies[k].iter().zip(&placed[k]).filter(|_| self.closed[k]);
            rigid
                .filter(|(panel, _)| matches!(panel[0].point, MaterialPoint::Rigid(_)))
                .map(|(_, segment)| *segment)
                .collect()
        };
        let boxes: Vec<_> = placed.iter().map(|body| around(body)).collect();
        for (k, one) in placed.iter().enumerate() {
            for (l, other) in placed.iter().enumerate().skip(k + 1) {
                let apart = boxes[k].1.x < boxes[l].0.x || boxes[l].1.x < boxes[k].0.x;
                if apart || boxes[k].1.y < boxes[l].0.y || boxes[l].1.y < boxes[k].0.y {
                    continue;
                }
                let pairs = one.iter().flat_map(|a| other.iter().map(move |b| (a, b)));
                let mut crossing = pairs.filter(|(a, b)| is_through(a, b, self.depth) || is_through(b, a, self.depth));
                let within = crossing.next().map(|(a, _)| a.start);
                // Sides that run along each other do not cross.
                let within = within.or_else(|| deep_within(one, &solid(l), self.depth));
                if let Some(place) = within.or_else(|| deep_within(other, &solid(k), self.depth)) {
                    return Err(Error::Overlap { x: place.x, y: place.y, time });
                }
            }
        }
        Ok(())
    }

    /// Refuses a motion that takes a panel through a fixed wall; `time` is that of the step's start.
    ///
    /// # Errors
    /// The place where they meet.
    pub fn check(&self, bodies: &BodySet, motion: &Motion, time: f64) -> Result<(), Error> {
        for panel in &self.panels {
            let [start, end] = panel.map(|point| bodies.position(point, motion));
            let panel = Segment::between(start, end, 0, 0.0, 0);
            if let Some(wall) = self.fixed.iter().find(|wall| is_through(&panel, wall, self.depth)) {
                let behind = if wall.local(&start).0 < wall.local(&end).0 { start } else { end };
                return Err(Error::Contact { x: behind.x, y: behind.y, time });
            }
        }
        Ok(())
    }
}

/// The panels of each body; none where there is one body alone.
fn by_body(panels: &[[SurfacePoint; 2]]) -> Vec<Vec<[SurfacePoint; 2]>> {
    let count = panels.iter().map(|panel| panel[0].body + 1).max().unwrap_or(0);
    if count < 2 {
        return Vec::new();
    }
    let of = |body: usize| panels.iter().filter(|panel| panel[0].body == body).copied().collect();
    (0..count).map(of).collect()
}

/// The middle of a panel that lies within a solid, given by its surface, deeper than `depth` \[m\].
fn deep_within(panels: &[Segment], solid: &[Segment], depth: f64) -> Option<Vector2<f64>> {
    let is_within = |point: &Vector2<f64>| {
        let passes = |wall: &&Segment| {
            let (a, b) = (wall.start, wall.end());
            (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
        };
        solid.iter().filter(passes).count() % 2 == 1
            && solid.iter().all(|wall| wall.squared_distance(point) > depth * depth)
    };
    panels.iter().map(|panel| 0.5 * (panel.start + panel.end())).find(is_within)
}

/// Lowest and highest corner of the box around a surface \[m\].
fn around(segments: &[Segment]) -> (Vector2<f64>, Vector2<f64>) {
    let corners: Vec<_> = segments.iter().flat_map(|segment| [segment.start, segment.end()]).collect();
    if corners.is_empty() { (Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN)) } else { bounding_box(&corners) }
}

/// Whether a panel crosses a wall and one of its ends is deeper behind it than `depth` \[m\].
fn is_through(panel: &Segment, wall: &Segment, depth: f64) -> bool {
    crosses(panel, wall) && -wall.local(&panel.start).0.min(wall.local(&panel.end()).0) > depth
}
