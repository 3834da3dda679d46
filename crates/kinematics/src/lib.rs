//! Kinematics of rigid bodies that carry elastic beams in modal form.
//!
//! The one place that knows how the generalised coordinates, `[X, Y, theta, q_1 .. q_N]` of each body, move the surface, and
//! how forces on the surface load the coordinates. The structure and the fluid both build on it, so that the work done
//! across their interface is the same on both sides by construction.
//!
//! - [`Motion`]: coordinates, rates, accelerations, measured from the pose in the scene;
//! - [`BeamModes`]: mode shapes of a fixed-fixed or clamped-free beam;
//! - [`CoordinateLayout`]: which entry of a vector of coordinates belongs to which body and member;
//! - [`BodySet`]: all bodies of a scene, on one vector of coordinates;
//! - [`Body`]: pose, rigid walls, members; places, velocities, accelerations of [`MaterialPoint`]s, virtual work;
//! - [`Panel`]: the surface in short pieces, with the fluid on the left.
//!
//! Source: the coupled rigid-body/elastic modes model of Sun as used in the paper, section 2.2 and appendix A, derived
//! anew; misprints are named where the code departs from the print.

mod body;
mod body_set;
mod error;
mod layout;
mod modes;
mod motion;
mod panel;

pub use body::{Beam, Body, MaterialPoint};
pub use body_set::{BodySet, SurfacePoint};
pub use error::Error;
pub use layout::{Coordinate, CoordinateLayout, Part, RIGID};
pub use modes::{BeamModes, Support};
pub use motion::{Motion, MotionView, copy};
pub use panel::Panel;
