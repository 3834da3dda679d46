//! `plimsoll reproduce`: the paper's study run again, as one report.

pub mod cabin;
pub mod page;

use crate::record::{Series, Summary};
use std::path::PathBuf;

/// What to run again.
#[derive(Debug, clap::Subcommand)]
pub enum Reproduce {
    /// The damaged cabin with bulkheads of four stiffnesses (sections 3.2 and 3.3).
    ///
    /// Runs the scene damaged_cabin as models I to IV, each into its own folder, and writes report.html, which opens by
    /// itself: every history of the four side by side, the pressure along the bulkhead, the paper's table 2 beside ours, and
    /// each of its trends as found or not found, with the numbers.
    Cabin(CabinArguments),
}

/// How to run the cabins.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct CabinArguments {
    /// Particle spacing \[m\].
    #[arg(long, default_value_t = 0.01)]
    pub spacing: f64,
    /// End of each run \[s\].
    #[arg(long, default_value_t = 1.5)]
    pub end: f64,
    /// Threads of the fluid; 0 takes all processors.
    #[arg(long)]
    pub threads: Option<usize>,
    /// Folder for the runs and the report.
    #[arg(long, default_value = "results/reproduce_cabin")]
    pub out: PathBuf,
}

/// One of the paper's models and what its run gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Its number in the paper.
    pub name: &'static str,
    /// Young's modulus of the bulkhead \[Pa\]; infinite for the rigid one.
    pub youngs_modulus: f64,
    /// Summary of the run.
    pub summary: Summary,
    /// Recorded variables.
    pub series: Series,
}
