//! Walls: where they stand, which of them are near, what is in front of and behind them, and what they stop.

mod body_contact;
mod candidates;
pub mod check;
pub mod gaps;
mod panel_motion;
pub mod sides;
pub mod stop;
mod wall_set;

pub use body_contact::BodyContact;
pub use panel_motion::PanelMotion;
pub use wall_set::*;
