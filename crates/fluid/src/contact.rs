//! Contact of the body with fixed walls: nothing of it is modelled here, and a structure that lets it happen is
//! stopped.

use crate::Error;
use crate::walls::{FIXED, Segment, Walls, crosses};
use kinematics::{Body, MaterialPoint, Motion};
use nalgebra::Vector2;

/// Distance in spacings from a fixed wall up to which a panel slides or stands on it from the start, as a piston does.
/// One that goes through a wall from the start is left alone too.
const JOINED: f64 = 0.5;

/// Depth in spacings that a structure with contact forces of its own may need.
const BORNE: f64 = 0.25;

/// Panels of the body and fixed walls that must not meet.
#[derive(Debug, Clone, Default)]
pub struct BodyContact {
    panels: Vec<[MaterialPoint; 2]>,
    fixed: Vec<Segment>,
    /// Depth up to which a corner may stand behind a wall, as one that is held by a contact force does \[m\].
    depth: f64,
}

impl BodyContact {
    /// From the walls as they stand at the start.
    pub fn new(panels: &[[MaterialPoint; 2]], walls: &Walls, spacing: f64) -> Self {
        let fixed: Vec<Segment> = walls.segments.iter().filter(|segment| segment.panel == FIXED).copied().collect();
        let apart = |point: &Vector2<f64>| {
            fixed.iter().all(|segment| segment.squared_distance(point) > (JOINED * spacing).powi(2))
        };
        let moving = walls.segments.iter().filter(|segment| segment.panel != FIXED);
        let crossed = |segment: &Segment| fixed.iter().any(|wall| crosses(segment, wall));
        let free = moving.filter(|segment| apart(&segment.start) && apart(&segment.end()) && !crossed(segment));
        let panels = free.map(|segment| panels[segment.panel as usize]).collect();
        Self { panels, fixed, depth: BORNE * spacing }
    }

    /// Refuses a motion that takes a panel through a fixed wall; `time` is that of the step's start.
    ///
    /// # Errors
    /// The place where they meet.
    pub fn check(&self, body: &Body, motion: &Motion, time: f64) -> Result<(), Error> {
        for panel in &self.panels {
            let [start, end] = panel.map(|point| body.position(point, motion));
            let panel = Segment::between(start, end, 0, 0.0, 0);
            let depth = |wall: &Segment| -wall.local(&start).0.min(wall.local(&end).0);
            let crossed = |wall: &&Segment| crosses(&panel, wall) && depth(wall) > self.depth;
            if let Some(wall) = self.fixed.iter().find(crossed) {
                let behind = if wall.local(&start).0 < wall.local(&end).0 { start } else { end };
                return Err(Error::Contact { x: behind.x, y: behind.y, time });
            }
        }
        Ok(())
    }
}
