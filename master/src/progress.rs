//! How far a run is: a bar, lines of JSON, or nothing.

use crate::log::Log;
use crate::record::IterationCounts;
use crate::tell;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Ticks of a full bar.
const LENGTH: u64 = 10_000;
/// Wall-clock time between two lines of JSON.
const PAUSE: Duration = Duration::from_secs(1);

/// What a run says of itself on standard error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Style {
    /// A bar on a terminal, warnings and errors everywhere.
    #[default]
    Bar,
    /// One JSON object per line: progress, warnings, the end.
    Json,
    /// Warnings and errors only.
    Quiet,
    /// Nothing, for trials.
    #[value(skip)]
    Silent,
}

/// Shows how far a run is and when it will be done.
pub struct Progress {
    style: Style,
    bar: ProgressBar,
    /// Start and end of the run \[s\].
    span: (f64, f64),
    /// Where this process began: time \[s\], steps, and when.
    begin: (f64, u64, Instant),
    last: Instant,
    /// Where warnings are kept.
    log: Option<Log>,
}

impl Progress {
    /// For a run from `start` to `end` \[s\].
    pub fn new(start: f64, end: f64, style: Style) -> Self {
        let bar = if style == Style::Bar { ProgressBar::new(LENGTH) } else { ProgressBar::hidden() };
        let template = "{wide_bar} {percent:>3} %  {msg}  elapsed {elapsed}, left {eta}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let now = Instant::now();
        Self { style, bar, span: (start, end), begin: (start, 0, now), last: now, log: None }
    }

    /// The same, with warnings kept in `log` too.
    pub fn logged(mut self, log: &Log) -> Self {
        self.log = Some(log.clone());
        self
    }

    /// The run goes from `time` \[s\] on, with `steps` done before.
    pub fn begin(&mut self, time: f64, steps: u64) {
        self.begin = (time, steps, Instant::now());
        self.bar.set_position(self.position(time));
        self.bar.reset_eta();
        self.bar.enable_steady_tick(Duration::from_millis(500));
        self.line(&json!({ "event": "start", "time": time, "end": self.span.1, "steps": steps }));
    }

    /// Shows the time reached \[s\], steps per second and iterations.
    pub fn update(&mut self, time: f64, counts: &IterationCounts) {
        let (from, steps, since) = self.begin;
        let elapsed = since.elapsed().as_secs_f64();
        let rate = (counts.steps - steps) as f64 / elapsed.max(1e-9);
        let iterations = counts.mean();
        if self.style == Style::Bar {
            self.bar.set_position(self.position(time));
            self.bar.set_message(format!("t = {time:.4} s, {rate:.1} steps/s, {iterations:.1} iterations a step"));
        }
        if self.style == Style::Json && self.last.elapsed() >= PAUSE {
            self.last = Instant::now();
            let left = elapsed * (self.span.1 - time) / (time - from).max(f64::MIN_POSITIVE);
            self.line(&json!({
                "event": "progress", "time": time, "end": self.span.1, "steps": counts.steps, "steps_per_second": rate,
                "iterations_per_step": iterations, "elapsed_seconds": elapsed, "left_seconds": left,
            }));
        }
    }

    /// Shows a warning, above the bar if there is one.
    pub fn warn(&self, text: &str) {
        if let Some(log) = &self.log {
            log.note(text);
        }
        match self.style {
            Style::Silent => {}
            Style::Json => self.line(&json!({ "event": "warning", "text": text })),
            _ => self.bar.suspend(|| tell!("warning: {text}")),
        }
    }

    /// Takes the bar off the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn position(&self, time: f64) -> u64 {
        let (start, end) = self.span;
        (((time - start) / (end - start)).clamp(0.0, 1.0) * LENGTH as f64) as u64
    }

    fn line(&self, object: &Value) {
        if self.style == Style::Json {
            tell!("{object}");
        }
    }
}
