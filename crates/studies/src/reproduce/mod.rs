//! `plimsoll reproduce`: the paper's study run again, as one report.

pub mod balance;
pub mod cabin;
pub mod hull;
mod notes;
mod page;
mod plate;
mod runs;
pub mod study;

pub use runs::run;

use crate::FinishedRun;
use std::path::PathBuf;

/// What to run again.
#[derive(Debug, clap::Subcommand)]
pub enum Reproduce {
    /// The damaged cabin with bulkheads of four stiffnesses (sections 3.2 and 3.3).
    ///
    /// Runs the scene damaged_cabin as models I to IV, each into its own folder, and writes report.html, which opens by
    /// itself: every history of the four side by side, the pressure along the bulkhead, the paper's table 2 beside
    /// ours, each of its trends as found or not found, with the numbers, the field, and an animation.
    Cabin(CabinArguments),
    /// Everything: the dam break on an elastic plate at three spacings and the four cabins.
    Paper(PaperArguments),
    /// Beyond the paper: load of the bulkhead against its stiffness, thickness, and the opening, with error bars.
    Stiffness(StudyArguments),
}

/// How to run the cabins.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct CabinArguments {
    /// Particle spacing in metres.
    #[arg(long, default_value_t = 0.01)]
    pub spacing: f64,
    /// End of each run in seconds.
    #[arg(long, default_value_t = 1.5)]
    pub end: f64,
    /// Where the damage is.
    #[arg(long, value_enum, default_value_t = hull::Variant::Side)]
    pub variant: hull::Variant,
    /// Folder of another `reproduce cabin`, for a section on convergence; may be repeated.
    #[arg(long, value_name = "FOLDER")]
    pub against: Vec<PathBuf>,
    /// Threads, folder, and what is kept.
    #[command(flatten)]
    pub common: Common,
}

/// What all of them need.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct Common {
    /// Threads of the fluid; 0 takes all processors.
    #[arg(long)]
    pub threads: Option<usize>,
    /// Keep runs that are complete in the folder already, and go on with those that were stopped.
    #[arg(long)]
    pub keep: bool,
    /// Do runs again that are complete in the folder already.
    #[arg(long, conflicts_with = "keep")]
    pub overwrite: bool,
    /// Folder for the runs and the report [default: results/reproduce_NAME].
    #[arg(long)]
    pub out: Option<PathBuf>,
}

/// How to run everything.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct PaperArguments {
    /// Particle spacing of the cabins in metres.
    #[arg(long, default_value_t = 0.01)]
    pub spacing: f64,
    /// Particle spacings of the dam break in metres.
    #[arg(long, value_delimiter = ',', default_values_t = [0.004, 0.002, 0.001])]
    pub plate: Vec<f64>,
    /// Ends of the runs in seconds, for a quick look; missing, as the scenes say.
    #[arg(long)]
    pub end: Option<f64>,
    /// Threads, folder, and what is kept.
    #[command(flatten)]
    pub common: Common,
}

/// How to run the study of the stiffness.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct StudyArguments {
    /// Particle spacing in metres.
    #[arg(long, default_value_t = 0.014)]
    pub spacing: f64,
    /// End of each run in seconds.
    #[arg(long, default_value_t = 1.2)]
    pub end: f64,
    /// Runs of each point, with particles displaced differently at the start.
    #[arg(long, default_value_t = 3)]
    pub repeats: usize,
    /// Parts of the study; missing, all.
    #[arg(long, value_enum, value_delimiter = ',')]
    pub parts: Vec<study::Part>,
    /// Threads, folder, and what is kept.
    #[command(flatten)]
    pub common: Common,
}

/// One of the paper's models and what its run gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Its number in the paper.
    pub name: &'static str,
    /// Young's modulus of the bulkhead \[Pa\]; infinite for the rigid one.
    pub youngs_modulus: f64,
    /// Its run.
    pub done: FinishedRun,
}
