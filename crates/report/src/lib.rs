//! Results of runs: their series and summaries, the figures that scenes ask of them, charts, pictures and pages.

mod canvas;
mod chart;
pub mod checks;
mod field;
mod figures;
mod frame_list;
pub mod html;
mod log_chart;
pub mod machine;
mod movie;
mod page;
pub mod record;
mod set_up;
mod text;

pub use canvas::{Error, prepare_font};
pub use chart::{Band, Chart, Curve};
pub use field::{FieldFigure, Panel, Quantity};
pub use figures::{MOST_MARKERS, Pictures, Wanted, charts, draw_all, stems};
pub use frame_list::{Fields, FrameEntry, frames};
pub use log_chart::LogChart;
pub use movie::{Window, movie};
pub use page::run_page;
pub use set_up::SetUp;
pub use text::{Short, markdown, number};
