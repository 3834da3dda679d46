//! `plimsoll bench speed`: what an internal step costs, stage by stage, as a dated record.

pub mod cases;
pub mod measure;
pub mod page;

use super::machine::{self, Circumstances};
use crate::Program;
use cases::{Case, FEATURES, FLOWS, Feature, SIZES};
use measure::{Run, Timing};
use report::record;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Steps of a feature's series, and of the comparison of passes.
const STEPS: usize = 60;
/// Time from which features are compared \[s\].
const FROM: f64 = 0.05;

/// What to time.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct SpeedArguments {
    /// Numbers of threads, separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    pub threads: Vec<usize>,
    /// Runs of each kind; the fastest one counts.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub repeats: u32,
    /// Table of an earlier record (speed.csv): its times stand beside these as a ratio.
    #[arg(long, value_name = "FILE")]
    pub against: Option<PathBuf>,
    /// Folder for the record.
    #[arg(long, default_value = "results/bench_speed")]
    pub out: PathBuf,
    /// A quick try of the bench itself: the smallest case on one thread.
    #[arg(long)]
    pub smoke: bool,
}

/// A case on a number of threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the case.
    pub name: String,
    /// Threads.
    pub threads: usize,
    /// What was measured.
    pub timing: Timing,
    /// Time per particle and step of the record that this one is compared with \[ns\].
    pub before: Option<f64>,
}

impl Row {
    /// Time per particle and step \[ns\].
    pub fn total(&self) -> f64 {
        self.timing.per_particle_step(self.timing.wall)
    }
}

/// A feature with and without, each the time per particle and step \[ns\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureCost {
    /// The feature.
    pub feature: Feature,
    /// With it.
    pub with: f64,
    /// Without it.
    pub without: f64,
}

/// A whole record.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// When, where and of what.
    pub circumstances: Circumstances,
    /// Mean number of running processes before and after.
    pub load: (Option<f64>, Option<f64>),
    /// Runs of each kind.
    pub repeats: u32,
    /// Cases.
    pub rows: Vec<Row>,
    /// Features.
    pub features: Vec<FeatureCost>,
    /// First pass of a communication step and a later one \[s\].
    pub passes: Option<[f64; 2]>,
}

/// Times everything and writes the record; gives the path of its page. The scenes are those of the folder `scenes`.
pub fn speed(
    arguments: &SpeedArguments,
    scenes: &Path,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<PathBuf, Box<dyn Error>> {
    std::fs::create_dir_all(&arguments.out).map_err(|error| record::Error::new(&arguments.out, error))?;
    let before = arguments.against.as_deref().map(page::read).transpose()?.unwrap_or_default();
    let (circumstances, load) = (Circumstances::now(), machine::load());
    let mut record = Record {
        circumstances,
        load: (load, None),
        repeats: arguments.repeats,
        rows: Vec::new(),
        features: Vec::new(),
        passes: None,
    };
    let cases: Vec<Case> = if arguments.smoke { vec![SIZES[0]] } else { SIZES.into_iter().chain(FLOWS).collect() };
    let threads = if arguments.smoke { &[1][..] } else { &arguments.threads };
    for (case, &threads) in cases.iter().flat_map(|case| threads.iter().map(move |threads| (case, threads))) {
        if interrupted.load(Ordering::Relaxed) {
            break;
        }
        let timing = time(case, threads, arguments.repeats, scenes)?;
        let known = before.iter().find(|(name, number, _)| name == case.name && *number == threads);
        let row = Row { name: case.name.to_string(), threads, timing, before: known.map(|(_, _, total)| *total) };
        program.tell(&format!("{}, {threads} threads: {:.0} ns per particle-step", row.name, row.total()));
        record.rows.push(row);
    }
    if !arguments.smoke && !interrupted.load(Ordering::Relaxed) {
        record.features =
            FEATURES.into_iter().map(|it| cost(it, arguments.repeats, scenes, program)).collect::<Result<_, _>>()?;
        let plate = FLOWS[2];
        let mut run = Run::new(scenes, plate.scene, plate.changes, 1)?;
        record.passes = Some(run.time_passes(STEPS)?);
    }
    record.load.1 = machine::load();
    page::write(&record, &arguments.out)
}

fn time(case: &Case, threads: usize, repeats: u32, scenes: &Path) -> Result<Timing, Box<dyn Error>> {
    let once = || -> Result<Timing, Box<dyn Error>> {
        let mut run = Run::new(scenes, case.scene, case.changes, threads)?;
        run.flow_to(case.from)?;
        run.time(case.steps)
    };
    let mut timing = once()?;
    for _ in 1..repeats {
        timing = timing.faster(once()?);
    }
    Ok(timing)
}

/// A feature with and without, in turn, on one thread.
fn cost(feature: Feature, repeats: u32, scenes: &Path, program: &dyn Program) -> Result<FeatureCost, Box<dyn Error>> {
    let mut cost = FeatureCost { feature, with: f64::INFINITY, without: f64::INFINITY };
    for _ in 0..repeats {
        for (changes, least) in [(feature.with, &mut cost.with), (feature.without, &mut cost.without)] {
            let mut run = Run::new(scenes, feature.scene, changes, 1)?;
            run.flow_to(FROM)?;
            let timing = run.time(STEPS)?;
            *least = least.min(timing.per_particle_step(timing.wall));
        }
    }
    program.tell(&format!("{}: {:.0} ns with, {:.0} ns without", feature.name, cost.with, cost.without));
    Ok(cost)
}
