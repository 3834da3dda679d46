//! Pictures and text of a run.

mod canvas;
mod chart;
mod field;
mod figures;
mod frames;
pub mod html;
mod log_chart;
mod movie;
mod page;
mod set_up;
mod text;

pub use canvas::{Error, prepare_font};
pub use chart::{Band, Chart, Curve};
pub use field::{FieldFigure, Panel, Quantity};
pub(crate) use figures::MOST_MARKERS;
pub use figures::{Pictures, charts, draw_all, stems};
pub use frames::{Fields, FrameEntry, frames};
pub use log_chart::LogChart;
pub use movie::{Window, movie};
pub use page::run_page;
pub use set_up::SetUp;
pub(crate) use text::number;
pub use text::{Short, markdown};
