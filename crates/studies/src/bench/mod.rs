//! `plimsoll bench`: the schemes of the fluid compared by error and by run time, and what a step costs, as dated
//! records.

pub mod comparison;
pub mod page;
pub mod pictures;
pub mod plan;
pub mod rates;
pub mod sheet;
pub mod speed;
pub mod trial;

use crate::Program;
use comparison::Comparison;
use plan::Plan;
use report::machine::{self, Circumstances};
use report::record;
use report::{Short, prepare_font};
use scene::{Scene, Scheme};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use trial::Limits;

/// Scene of a quick try when none is named.
const SMOKE_SCENE: &str = "stretching_drop";

/// What to measure.
#[derive(Debug, clap::Subcommand)]
pub enum Bench {
    /// Measure error against spacing and against run time, for both schemes in turn.
    ///
    /// Runs scenes that have a reference at several spacings with each scheme, one run after the other, without frames
    /// and plots. Writes into the folder: accuracy.md (tables, orders of convergence, run times at equal error),
    /// accuracy.csv (one row per run and figure), and two pictures per scene: error against spacing and error against
    /// run time. A run that fails, or takes longer than the cap, is a row that says so. Ctrl-C ends the run at hand
    /// and writes what there is.
    Accuracy(AccuracyArguments),
    /// Time an internal step, stage by stage, from 10^3 to 10^6 particles, and what parts of the method cost.
    ///
    /// Writes into the folder: speed.md and speed.csv. Counts nothing but internal steps: no output is written and no
    /// figure is read meanwhile. With --against, the times of an earlier table stand beside these as a ratio; on
    /// another machine that ratio says more of the machines than of the program.
    Speed(speed::SpeedArguments),
}

/// What to compare and how long.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct AccuracyArguments {
    /// Scenes to run [default: all that have a plan: hydrostatic, standing_wave, rotating_square, oscillating_drop,
    /// stretching_drop, dam_break_peers, dam_break_front, forced_sloshing].
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Schemes to run, separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "voronoi,mps", value_parser = scheme)]
    pub schemes: Vec<Scheme>,
    /// Spacings per scene, from the coarsest of its plan on (2 to 4).
    #[arg(long, default_value_t = 3, value_parser = levels)]
    pub levels: usize,
    /// Runs of each kind; the fastest one counts.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub repeats: u32,
    /// Threads of the fluid; 0 takes all processors. One thread gives the most repeatable times.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
    /// Longest wall-clock time of one run, in seconds; a longer one is ended.
    #[arg(long, value_name = "SECONDS", default_value_t = 120.0, value_parser = cap)]
    pub cap: f64,
    /// Folder for the record.
    #[arg(long, default_value = "results/bench_accuracy")]
    pub out: PathBuf,
    /// A quick try of the bench itself: the coarsest spacing and twice that, and only stretching_drop unless scenes are
    /// named.
    #[arg(long)]
    pub smoke: bool,
}

fn scheme(text: &str) -> Result<Scheme, String> {
    let known = [Scheme::Voronoi, Scheme::Mps].into_iter().find(|scheme| scheme.name() == text);
    known.ok_or_else(|| "expected 'voronoi' or 'mps'".to_string())
}

fn levels(text: &str) -> Result<usize, String> {
    let levels = text.parse().map_err(|_| "expected a whole number".to_string())?;
    if (2..=4).contains(&levels) { Ok(levels) } else { Err("expected 2 to 4".to_string()) }
}

fn cap(text: &str) -> Result<f64, String> {
    let cap: f64 = text.parse().map_err(|_| "expected a number of seconds".to_string())?;
    if cap.is_finite() && cap > 0.0 { Ok(cap) } else { Err("expected a finite number above 0".to_string()) }
}

impl AccuracyArguments {
    fn plans(&self) -> Result<Vec<Plan>, String> {
        if self.scenes.is_empty() && self.smoke {
            return Ok(vec![plan::find(SMOKE_SCENE)?]);
        }
        if self.scenes.is_empty() {
            return Ok(plan::PLANS.to_vec());
        }
        self.scenes.iter().map(|scene| plan::find(scene)).collect()
    }
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
    /// One per scene.
    pub comparisons: Vec<Comparison>,
}

/// Runs everything and writes the record; gives the path of its page. The scenes are those of the folder `scenes`.
pub fn accuracy(
    arguments: &AccuracyArguments,
    scenes: &Path,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<PathBuf, Box<dyn Error>> {
    let plans = arguments.plans()?;
    std::fs::create_dir_all(&arguments.out).map_err(|error| record::Error::new(&arguments.out, error))?;
    let (circumstances, before) = (Circumstances::now(), machine::load());
    let mut comparisons = Vec::new();
    for plan in plans {
        comparisons.push(compare(plan, arguments, scenes, program, interrupted)?);
        if interrupted.load(Ordering::Relaxed) {
            break;
        }
    }
    let repeats = arguments.repeats;
    let record = Record { circumstances, load: (before, machine::load()), repeats, comparisons };
    write(&record, &arguments.out)
}

/// One scene: at every spacing one scheme after the other, as often as repeats are asked for, so that whatever else
/// the machine does meets both alike.
fn compare(
    plan: Plan,
    arguments: &AccuracyArguments,
    scenes: &Path,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<Comparison, Box<dyn Error>> {
    let scene = Scene::from_file(&scenes.join(format!("{}.toml", plan.scene)))?;
    let limits = Limits { threads: arguments.threads, cap: arguments.cap };
    let mut comparison = Comparison { plan, title: scene.title, scene_end: scene.run.end, trials: Vec::new() };
    for spacing in plan.levels(arguments.levels, arguments.smoke) {
        let first = comparison.trials.len();
        for repeat in 0..arguments.repeats {
            for (index, scheme) in arguments.schemes.iter().enumerate() {
                let trial = trial::trial(&plan, scenes, *scheme, spacing, &limits, program, interrupted)?;
                program.tell(&line(&plan, &trial));
                if repeat == 0 {
                    comparison.trials.push(trial);
                } else {
                    comparison.trials[first + index].keep_faster(&trial);
                }
                if interrupted.load(Ordering::Relaxed) {
                    return Ok(comparison);
                }
            }
        }
    }
    Ok(comparison)
}

/// One line on the terminal per run.
fn line(plan: &Plan, trial: &trial::Trial) -> String {
    let error = trial.errors[0].map_or_else(|| "-".to_string(), |error| Short(error).to_string());
    let (scheme, problem) = (trial.scheme.name(), &trial.problem);
    let times = format!("{:.2} s, processor {:.2} s", trial.wall, trial.seconds());
    format!("{} {scheme} {} m: error {error}, {times} {problem}", plan.scene, trial.spacing)
}

fn write(record: &Record, folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    sheet::write(record, &folder.join("accuracy.csv"))?;
    prepare_font();
    for comparison in &record.comparisons {
        pictures::draw(comparison, folder)?;
    }
    let page = folder.join("accuracy.md");
    std::fs::write(&page, page::markdown(record)).map_err(|error| record::Error::new(&page, error))?;
    Ok(page)
}
