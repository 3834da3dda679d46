//! `plimsoll ensemble`: a scene several times, its particles displaced a little at the start by other random numbers each
//! time, and what the runs have in common. Figures of an impact are samples: one run gives one of each.

mod figures;
mod page;
pub mod statistics;

pub use figures::{Ensemble, FILE, Figure, Member};
pub use page::differences;

use crate::{Failure, FinishedRun, Program, Request};
use report::record::{Series, Status, write_whole};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// Of what to make an ensemble.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct EnsembleArguments {
    /// Name of the scene, or path of its file.
    scene: String,
    /// Number of runs.
    #[arg(long, default_value_t = 8)]
    members: usize,
    /// Change a value in all of them, for example --set fluid.spacing=0.002; may be repeated.
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// The scene's quick variant.
    #[arg(long)]
    quick: bool,
    /// Largest displacement of a particle at the start, over the spacing.
    #[arg(long, default_value_t = 0.01)]
    jitter: f64,
    /// Seed of the first run; those of the others follow.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Runs at once, with one thread each [default: one for each processor].
    #[arg(long)]
    jobs: Option<usize>,
    /// Variables whose histories, peaks and impulses are shown, with commas between them [default: pressures, loads and
    /// deflections].
    #[arg(long, value_delimiter = ',')]
    variables: Vec<String>,
    /// Folder of the ensemble, in which every run has its own [default: results/NAME-ensemble]. Runs that are complete
    /// there are taken as they are, others go on from where they stopped.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// What came out.
#[derive(Debug)]
pub struct Outcome {
    /// The page.
    pub page: PathBuf,
    /// Whether every run reached its end.
    pub complete: bool,
}

/// Makes the runs and writes the page, the table and the figures.
///
/// # Errors
/// Numbers that cannot be, no run that reached its end, or a file that cannot be written.
pub fn ensemble(
    arguments: &EnsembleArguments,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<Outcome, Failure> {
    if !(1..=10_000).contains(&arguments.members) {
        return Err(format!("--members {}: expected 1 to 10000", arguments.members).into());
    }
    if !(arguments.jitter > 0.0 && arguments.jitter <= 0.2) {
        return Err(format!("--jitter {}: expected a number above 0, up to 0.2", arguments.jitter).into());
    }
    let name = scene::name_of(Path::new(&arguments.scene));
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("results/{name}-ensemble")));
    let runs = run_all(arguments, &out, program, interrupted);
    let mut ensemble = Ensemble { scene: name, set: arguments.set.clone(), ..Ensemble::default() };
    let mut histories: Vec<Series> = Vec::new();
    for (index, run) in runs.into_iter().enumerate() {
        let Some(run) = run else { continue };
        let (seed, folder) = (seed(arguments, index), member_name(index));
        match run {
            Ok(FinishedRun { summary, series, .. }) => {
                ensemble.add(&folder, seed, &summary, &series, &arguments.variables);
                histories.extend((summary.status == Status::Complete).then_some(series));
            }
            Err(error) => ensemble.add_failure(&folder, seed, &error),
        }
    }
    if histories.is_empty() {
        let why = ensemble.members.iter().find_map(|member| member.error.clone());
        return Err(why.unwrap_or_else(|| "no run reached its end".to_string()).into());
    }
    ensemble.write(&out)?;
    let page = out.join("report.html");
    write_whole(&page, page::page(&ensemble, &histories, &arguments.variables))?;
    Ok(Outcome { page, complete: histories.len() == arguments.members })
}

fn seed(arguments: &EnsembleArguments, index: usize) -> u64 {
    arguments.seed.wrapping_add(index as u64)
}

fn member_name(index: usize) -> String {
    format!("member-{:03}", index + 1)
}

/// Every run in its folder; none of one that was not begun.
fn run_all(
    arguments: &EnsembleArguments,
    out: &Path,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Vec<Option<Result<FinishedRun, String>>> {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let jobs = arguments.jobs.unwrap_or(processors).clamp(1, arguments.members);
    let done: Vec<Mutex<Option<Result<FinishedRun, String>>>> =
        (0..arguments.members).map(|_| Mutex::new(None)).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        while !interrupted.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(slot) = done.get(index) else { break };
            let run = program.run_apart(&request(arguments, out, index), interrupted);
            let run = run.map_err(|error| error.to_string());
            let how = match &run {
                Ok(run) => format!("{:.1} s of wall-clock time", run.summary.wall_seconds),
                Err(error) => error.clone(),
            };
            program.tell(&format!("{}: {how}", member_name(index)));
            if let Ok(mut slot) = slot.lock() {
                *slot = Some(run);
            }
        }
    };
    thread::scope(|scope| (0..jobs).for_each(|_| drop(scope.spawn(work))));
    done.into_iter().map(|slot| slot.into_inner().unwrap_or_default()).collect()
}

fn request(arguments: &EnsembleArguments, out: &Path, index: usize) -> Request {
    let mut set = arguments.set.clone();
    set.push(format!("fluid.start.jitter={}", arguments.jitter));
    set.push(format!("fluid.start.seed={}", seed(arguments, index)));
    Request {
        scene: arguments.scene.clone(),
        set,
        quick: arguments.quick,
        out: out.join(member_name(index)),
        threads: Some(1),
        resume: true,
        overwrite: false,
        quiet: true,
    }
}
