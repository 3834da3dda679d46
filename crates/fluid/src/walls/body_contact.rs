//! Contact of the body with fixed walls: nothing of it is modelled here, and a structure that lets it happen is
//! stopped.

use crate::Error;
use crate::walls::{FIXED, Segment, Walls, crosses};
use kinematics::{BodySet, Motion, SurfacePoint};

/// Depth in spacings that a structure with contact forces of its own may need. A panel that is deeper in a wall at the
/// start, as one that is held there, is left alone; one that slides on a wall, as a piston does, stays on it.
const BORNE: f64 = 0.25;

/// Panels of the body and fixed walls that must not meet.
#[derive(Debug, Clone, Default)]
pub struct BodyContact {
    panels: Vec<[SurfacePoint; 2]>,
    fixed: Vec<Segment>,
    /// Depth up to which a corner may stand behind a wall, as one that is held by a contact force does \[m\].
    depth: f64,
}

impl BodyContact {
    /// From the walls as they stand at the start.
    pub fn new(panels: &[[SurfacePoint; 2]], walls: &Walls, spacing: f64) -> Self {
        let fixed: Vec<Segment> = walls.segments.iter().filter(|segment| segment.panel == FIXED).copied().collect();
        let moving = walls.segments.iter().filter(|segment| segment.panel != FIXED);
        let free = moving.filter(|panel| !fixed.iter().any(|wall| is_through(panel, wall, BORNE * spacing)));
        let panels = free.map(|segment| panels[segment.panel as usize]).collect();
        Self { panels, fixed, depth: BORNE * spacing }
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

/// Whether a panel crosses a wall and one of its ends is deeper behind it than `depth` \[m\].
fn is_through(panel: &Segment, wall: &Segment, depth: f64) -> bool {
    crosses(panel, wall) && -wall.local(&panel.start).0.min(wall.local(&panel.end()).0) > depth
}
