//! The progress bar.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Ticks of a full bar.
const LENGTH: u64 = 10_000;

/// Shows how far a run is and when it will be done; hidden when quiet or not on a terminal.
pub struct Progress {
    bar: ProgressBar,
    start: f64,
    end: f64,
}

impl Progress {
    /// For a run from `start` to `end` \[s\].
    pub fn new(start: f64, end: f64, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(LENGTH) };
        let template = "{wide_bar} {percent:>3} %  {msg}  elapsed {elapsed}, left {eta}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        Self { bar, start, end }
    }

    /// Shows the time reached \[s\] and the mean number of iterations.
    pub fn update(&mut self, time: f64, iterations: f64) {
        let share = ((time - self.start) / (self.end - self.start)).clamp(0.0, 1.0);
        self.bar.set_position((share * LENGTH as f64) as u64);
        self.bar.set_message(format!("t = {time:.4} s, {iterations:.1} iterations a step"));
    }

    /// Shows a warning above the bar, on standard error.
    pub fn warn(&self, text: &str) {
        self.bar.suspend(|| eprintln!("warning: {text}"));
    }

    /// Takes the bar off the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
