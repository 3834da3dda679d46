//! The command line.

use crate::bench::{self, Bench};
use crate::case::Case;
use crate::compare::{self, CompareArguments};
use crate::fmu::FmuParticipant;
use crate::job::{Facts, Job};
use crate::log::Log;
use crate::pack;
use crate::participant::Participant;
use crate::progress::Progress;
use crate::record::{Status, Summary};
use crate::report::Short;
use crate::reproduce::{self, Reproduce};
use crate::run::Outcome;
use crate::scene_case::{self, Places};
use clap::{Parser, Subcommand};
use scene::Scene;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What runs when nothing is asked.
const DEFAULT_SCENE: &str = "dam_break_plate";
/// Memory of a run by particle, as measured (docs/benchmarks).
const BYTES_PER_PARTICLE: usize = 950;
/// Exit code of a run that the user ended (128 + SIGINT).
const INTERRUPTED: u8 = 130;

/// Water and structure, two FMUs, coupled implicitly.
///
/// Without a command, packs the FMUs and runs the scene dam_break_plate.
#[derive(Debug, Parser)]
#[command(name = "plimsoll", version)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene or a case and write results, pictures and a summary.
    ///
    /// Writes into the folder: report.html (everything on one page), results.csv (time series), iterations.csv (coupling),
    /// summary.json and summary.md, plots/, frames/ (VTK for ParaView), log.txt. The exit code is 0 only when the run reached its end.
    Run(RunArguments),
    /// Make fluid.fmu and structure.fmu.
    Pack {
        /// Folder for the FMUs.
        #[arg(long, default_value = "fmus")]
        out: PathBuf,
        /// Modes of the beam that the interface has room for.
        #[arg(long, default_value_t = components::DEFAULT_MODES)]
        modes: usize,
    },
    /// Make a System Structure Package (SSP 1.0) of a coupled scene for other masters.
    ///
    /// Holds both FMUs with the scene, all connections of an exchange without iteration (added mass included, unless
    /// coupling.added_mass = false), and the scene as the parameter set of each.
    Ssp {
        /// Name of a scene with fluid and structure, or path of its file.
        scene: String,
        /// Change a value, for example --set fluid.spacing=0.002; may be repeated.
        #[arg(long, value_name = "KEY.PATH=VALUE")]
        set: Vec<String>,
        /// The package [default: NAME.ssp].
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Read a scene or a case, check it, and list its numbers; nothing runs.
    Check {
        /// Name of a scene, or path of a scene or case file.
        target: String,
        /// Change a value, for example --set fluid.spacing=0.002; may be repeated.
        #[arg(long, value_name = "KEY.PATH=VALUE")]
        set: Vec<String>,
    },
    /// List the scenes by name.
    ListScenes,
    /// Compare the schemes of the fluid and write a dated record.
    #[command(subcommand)]
    Bench(Bench),
    /// Lay the histories of several runs over each other, or over reference tables, on one page.
    Compare(CompareArguments),
    /// Run the paper's study again and write one report.
    #[command(subcommand)]
    Reproduce(Reproduce),
}

/// What to run and where its results go.
#[derive(Debug, clap::Args)]
pub(crate) struct RunArguments {
    /// Name of a scene, or path of a scene or case file.
    #[arg(value_name = "SCENE-OR-CASE")]
    pub(crate) target: String,
    /// Change a value, for example --set fluid.spacing=0.002; may be repeated.
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Folder for the results [default: results/NAME].
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Threads of the fluid; 0 takes all processors [default: as the scene says].
    #[arg(long)]
    pub(crate) threads: Option<usize>,
    /// Print nothing but errors.
    #[arg(long)]
    pub(crate) quiet: bool,
}

type Failure = Box<dyn Error>;

/// Runs the program with the process's arguments.
pub fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        None => run(&RunArguments::of(DEFAULT_SCENE)),
        Some(Command::Run(arguments)) => run(&arguments),
        Some(Command::Pack { out, modes }) => pack_fmus(&out, modes),
        Some(Command::Ssp { scene, set, out }) => export_package(&scene, &set, out),
        Some(Command::Check { target, set }) => check(&target, &set),
        Some(Command::ListScenes) => list_scenes(),
        Some(Command::Bench(Bench::Accuracy(arguments))) => accuracy(&arguments),
        Some(Command::Bench(Bench::Speed(arguments))) => speed(&arguments),
        Some(Command::Compare(arguments)) => compare_runs(&arguments),
        Some(Command::Reproduce(what)) => reproduce(&what),
    };
    result.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}

impl RunArguments {
    fn of(scene: &str) -> Self {
        Self { target: scene.to_string(), set: Vec::new(), out: None, threads: None, quiet: false }
    }
}

fn run(arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption()?;
    let (summary, _, folder) = execute(arguments, &interrupted)?;
    Ok(conclude(&summary, &folder, arguments.quiet))
}

/// Runs a scene or a case and writes everything about it into the folder that is returned.
pub(crate) fn execute(
    arguments: &RunArguments,
    interrupted: &AtomicBool,
) -> Result<(Summary, Outcome, PathBuf), Failure> {
    let overrides = overrides(&arguments.set)?;
    let path = locate(&arguments.target)?;
    let name = scene_case::scene_name(&path);
    let folder = arguments.out.clone().unwrap_or_else(|| Path::new("results").join(&name));
    let job = if scene_case::is_case(&scene::read_text(&path)?) {
        case_job(&path, name, folder, &overrides, arguments)?
    } else {
        scene_job(&path, name, folder, &overrides, arguments)?
    };
    job.prepare_folder()?;
    let log = Log::to_file(&job.folder.join("log.txt"), true)?;
    let participants = participants(&job.case, &log)?;
    if !arguments.quiet {
        eprintln!("{}: {} s", job.case.title, job.case.run.end);
    }
    let mut progress = Progress::new(job.case.start, job.case.run.end, arguments.quiet);
    let (summary, outcome) = job.execute(participants, interrupted, &mut progress)?;
    Ok((summary, outcome, job.folder))
}

fn scene_job(
    path: &Path,
    name: String,
    folder: PathBuf,
    overrides: &[(String, String)],
    arguments: &RunArguments,
) -> Result<Job, Failure> {
    let scene = Scene::from_file_with(path, overrides)?;
    let modes = scene.modes().max(components::DEFAULT_MODES);
    let fmus = pack::program_folder().join(format!("fmus-{modes}-modes"));
    for packed in pack::pack(&fmus, modes)? {
        if packed.written && !arguments.quiet {
            eprintln!("packed {}", packed.path.display());
        }
    }
    let places =
        Places { scene: std::path::absolute(path)?, fmus, frames: std::path::absolute(folder.join("frames"))? };
    let case = scene_case::case(&scene, overrides, arguments.threads, &places);
    let references = path.parent().unwrap_or(Path::new("")).to_path_buf();
    Ok(Job { name, case, folder, references, facts: Facts::of(&scene) })
}

fn case_job(
    path: &Path,
    name: String,
    folder: PathBuf,
    overrides: &[(String, String)],
    arguments: &RunArguments,
) -> Result<Job, Failure> {
    if arguments.threads.is_some() {
        return Err("--threads is for scenes; in a case set the parameter of the FMU, for example --set \
                    fmu.0.parameters.threads=2"
            .into());
    }
    let case = Case::from_file(path, overrides)?;
    let references = path.parent().unwrap_or(Path::new("")).to_path_buf();
    Ok(Job { name, case, folder, references, facts: Facts::default() })
}

fn participants(case: &Case, log: &Log) -> Result<Vec<Box<dyn Participant>>, Failure> {
    let mut participants: Vec<Box<dyn Participant>> = Vec::new();
    for fmu in &case.fmu {
        participants.push(Box::new(FmuParticipant::load(&fmu.path, &fmu.name, log)?));
    }
    Ok(participants)
}

/// A flag that the first Ctrl-C raises; the second ends the program at once.
fn watch_for_interruption() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        eprintln!("ending after this step; once more to end at once");
    })?;
    Ok(flag)
}

fn conclude(summary: &Summary, folder: &Path, quiet: bool) -> ExitCode {
    if let Some(error) = &summary.error {
        eprintln!("error: {error}");
    }
    if !quiet {
        let (steps, wall) = (summary.steps, summary.wall_seconds);
        eprintln!("{:.6} s simulated in {steps} steps, {wall:.1} s of wall-clock time", summary.simulated_seconds);
        for (name, check) in &summary.checks {
            let number = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| Short(value).to_string());
            let reference = check.reference.map_or_else(String::new, |value| format!(", reference {}", Short(value)));
            println!("{name}: {} {}{reference}", number(check.value), check.unit);
        }
        println!("report: {}", folder.join("report.html").display());
    }
    match summary.status {
        Status::Complete => ExitCode::SUCCESS,
        Status::Interrupted => ExitCode::from(INTERRUPTED),
        Status::Failed => ExitCode::FAILURE,
    }
}

fn pack_fmus(out: &Path, modes: usize) -> Result<ExitCode, Failure> {
    let range = pack::modes_range();
    if !range.contains(&modes) {
        return Err(format!("--modes {modes}: expected {} to {}", range.start(), range.end()).into());
    }
    for packed in pack::pack(out, modes)? {
        let state = if packed.written { "written" } else { "unchanged" };
        println!("{} ({} kB, {state})", packed.path.display(), packed.size / 1000);
    }
    Ok(ExitCode::SUCCESS)
}

fn export_package(target: &str, set: &[String], out: Option<PathBuf>) -> Result<ExitCode, Failure> {
    let changes = overrides(set)?;
    let path = locate(target)?;
    let mut scene = Scene::from_file_with(&path, &changes)?;
    if scene.fluid.is_none() || scene.structure.is_none() {
        return Err(format!("{} has no fluid or no structure: there is nothing to couple", path.display()).into());
    }
    // Masters that import packages do not iterate.
    scene.coupling.method = scene::Method::Explicit;
    let name = scene_case::scene_name(&path);
    let places = Places { scene: path.clone(), fmus: PathBuf::new(), frames: PathBuf::new() };
    let case = scene_case::case(&scene, &changes, None, &places);
    let text = scene::read_text(&path)?;
    let overrides: Vec<String> = changes.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let system =
        pack::ssp::System { name: &name, scene: &scene, text: &text, overrides: &overrides.join("; "), case: &case };
    let out = out.unwrap_or_else(|| PathBuf::from(format!("{name}.ssp")));
    let size = pack::ssp::write_package(&out, &system)?;
    println!("{} ({} kB)", out.display(), size / 1000);
    Ok(ExitCode::SUCCESS)
}

fn check(target: &str, set: &[String]) -> Result<ExitCode, Failure> {
    let overrides = overrides(set)?;
    let path = locate(target)?;
    if scene_case::is_case(&scene::read_text(&path)?) {
        let text = toml::to_string(&Case::from_file(&path, &overrides)?)?;
        println!("# {}: valid; every number, defaults included:\n{text}", path.display());
        return Ok(ExitCode::SUCCESS);
    }
    let scene = Scene::from_file_with(&path, &overrides)?;
    let (particles, coordinates) = (components::particles(&scene)?, components::coordinates(&scene)?);
    let memory = (particles * BYTES_PER_PARTICLE).div_ceil(1_000_000);
    println!(
        "# {}: valid; {particles} particles (about {memory} MB), {coordinates} coordinates of the structure;",
        path.display()
    );
    println!("# every number, defaults included:\n{}", toml::to_string(&scene)?);
    Ok(ExitCode::SUCCESS)
}

fn list_scenes() -> Result<ExitCode, Failure> {
    let folder = pack::scenes_folder()?;
    for path in pack::files_with(&folder, "toml")? {
        let name = scene_case::scene_name(&path);
        match Scene::from_file(&path) {
            Ok(scene) => println!("{name:24} {}", scene.title),
            Err(error) => println!("{name:24} not valid: {error}"),
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn accuracy(arguments: &bench::AccuracyArguments) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption()?;
    let page = bench::accuracy(arguments, &pack::scenes_folder()?, &interrupted)?;
    println!("report: {}", page.display());
    let ended = interrupted.load(Ordering::Relaxed);
    Ok(if ended { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

fn compare_runs(arguments: &CompareArguments) -> Result<ExitCode, Failure> {
    println!("report: {}", compare::compare(arguments)?.display());
    Ok(ExitCode::SUCCESS)
}

fn reproduce(what: &Reproduce) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption()?;
    let (page, complete) = reproduce::run(what, &pack::scenes_folder()?, &interrupted)?;
    println!("report: {}", page.display());
    Ok(match (interrupted.load(Ordering::Relaxed), complete) {
        (true, _) => ExitCode::from(INTERRUPTED),
        (false, true) => ExitCode::SUCCESS,
        (false, false) => ExitCode::FAILURE,
    })
}

fn speed(arguments: &bench::speed::SpeedArguments) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption()?;
    let page = bench::speed::speed(arguments, &pack::scenes_folder()?, &interrupted)?;
    println!("report: {}", page.display());
    let ended = interrupted.load(Ordering::Relaxed);
    Ok(if ended { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

fn overrides(set: &[String]) -> Result<Vec<(String, String)>, Failure> {
    let mut pairs = Vec::new();
    for text in set {
        pairs.extend(scene::parse_overrides(text)?);
    }
    Ok(pairs)
}

/// A path as it is, or the scene of that name.
fn locate(target: &str) -> Result<PathBuf, Failure> {
    let path = PathBuf::from(target);
    if path.is_file() {
        return Ok(path);
    }
    let folder = pack::scenes_folder()?;
    let scene = folder.join(format!("{target}.toml"));
    if scene.is_file() {
        return Ok(scene);
    }
    let names: Vec<String> =
        pack::files_with(&folder, "toml")?.iter().map(|path| scene_case::scene_name(path)).collect();
    let hint = crate::participant::nearest(target, names.iter().map(String::as_str));
    let hint = hint.map_or_else(String::new, |name| format!("; did you mean '{name}'?"));
    let known = names.join(", ");
    Err(format!("'{target}' is neither a file nor a scene in {} ({known}){hint}", folder.display()).into())
}
