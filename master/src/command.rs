//! The command line.

mod check;
mod create;
pub(crate) mod run;

use crate::pack;
use crate::program::Plimsoll;
use crate::progress::Style;
use crate::scene_case::{self, Places};
use crate::target::Target;
use crate::{answer, fmu, tell};
use check::CheckArguments;
use clap::{Parser, Subcommand};
use create::{NewArguments, SchemaOf};
use run::RunArguments;
use scene::Scene;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use studies::bench::{self, Bench};
use studies::compare::{self, CompareArguments};
use studies::ensemble::{self, EnsembleArguments};
use studies::reproduce::{self, Reproduce};
use studies::validate::{self, ValidateArguments};

/// What runs when nothing is asked.
const DEFAULT_SCENE: &str = "dam_break_plate";
const EXIT_CODES: &str = "Exit codes: 0 done; 1 refused, or the run failed (standard error and summary.json say why); \
    2 wrong arguments; 3 the run reached its end but missed a limit, of a check or of the watch over energy, particles and \
    speeds (standard error, and `missed` in summary.json); 130 ended by the user or by a signal to terminate. A crash within \
    an FMU ends the program by its signal, after a line that says which FMU, in which call, at what time.";
/// Exit code of a run that the user ended (128 + SIGINT).
const INTERRUPTED: u8 = 130;
/// Exit code of a run that reached its end but missed a limit.
const MISSED: u8 = 3;

/// Water and structure, two FMUs, coupled implicitly.
///
/// Without a command, packs the FMUs and runs the scene dam_break_plate.
#[derive(Debug, Parser)]
#[command(name = "plimsoll", version, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene or a case and write results, pictures and a summary.
    ///
    /// Writes into the folder: report.html (everything on one page), results.csv (time series), iterations.csv
    /// (coupling), summary.json and summary.md, plots/, frames/ (VTK for ParaView), log.txt, and what the run was made
    /// of: scene.toml and run.json, which lists all of these files. `plimsoll run FOLDER --out OTHER` repeats it to the
    /// bit. The exit code is 0 only when the run reached its end and kept its limits, those of its checks and those of
    /// `[watch]`. A complete run in the folder is replaced only with --overwrite, and a folder that holds anything that no
    /// run wrote is refused.
    Run(RunArguments),
    /// Make fluid.fmu and structure.fmu of a scene.
    ///
    /// They have the variables of that scene under its names, and start with it. Without a scene they have those of
    /// dam_break_plate and take other scenes that have no others.
    Pack {
        /// Name of a scene, or path of its file.
        scene: Option<String>,
        /// Change a value, for example --set fluid.spacing=0.002; may be repeated.
        #[arg(long, value_name = "KEY.PATH=VALUE")]
        set: Vec<String>,
        /// Folder for the FMUs.
        #[arg(long, default_value = "fmus")]
        out: PathBuf,
    },
    /// Make a System Structure Package (SSP 1.0) of a coupled scene for other masters.
    ///
    /// Holds both FMUs with the scene, all connections of an exchange without iteration (added mass included, unless
    /// coupling.added_mass = false), and the scene as the parameter set of each.
    Ssp {
        /// Name of a scene with fluid and bodies, or path of its file.
        scene: String,
        /// Change a value, for example --set fluid.spacing=0.002; may be repeated.
        #[arg(long, value_name = "KEY.PATH=VALUE")]
        set: Vec<String>,
        /// The package [default: NAME.ssp].
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Read a scene or a case, check it as a run would, draw it, and say what a run will take: a few seconds are tried, and
    /// nothing is kept.
    Check(CheckArguments),
    /// Write a commented scene to begin with.
    New(NewArguments),
    /// Print the JSON schema of scene or case files, by which editors complete and check them.
    Schema {
        /// Of which file.
        what: SchemaOf,
    },
    /// List the scenes by name.
    ListScenes,
    /// Run scenes and write one dated record of their figures against their limits.
    ///
    /// The exit code is 3 when a limit was missed.
    Validate(ValidateArguments),
    /// Run a scene several times from starts that differ a little, and say what the runs have in common.
    ///
    /// Figures of an impact are samples: one run gives one of each. The page has mean, median, the 95 % band of single runs and
    /// their repeatability for every figure, for peaks and impulses, and the histories with their bands. `plimsoll compare` of two
    /// ensembles says whether they differ. Runs that are complete in the folder are taken as they are, others go on from where
    /// they stopped; each is a run like any other, so that a cluster may make them.
    Ensemble(EnsembleArguments),
    /// Compare the schemes of the fluid and write a dated record.
    #[command(subcommand)]
    Bench(Bench),
    /// Lay the histories of several runs over each other, or over reference tables, on one page.
    Compare(CompareArguments),
    /// Run the paper's study again and write one report.
    #[command(subcommand)]
    Reproduce(Reproduce),
}

pub(crate) type Failure = Box<dyn Error>;

/// Runs the program with the process's arguments.
pub fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        // A second call finds the run complete, and says where.
        None => run::run(&RunArguments { target: DEFAULT_SCENE.to_string(), resume: true, ..RunArguments::default() }),
        Some(Command::Run(arguments)) => run::run(&arguments),
        Some(Command::Pack { scene, set, out }) => pack_fmus(scene.as_deref(), &set, &out),
        Some(Command::Ssp { scene, set, out }) => export_package(&scene, &set, out),
        Some(Command::Check(arguments)) => check::check(&arguments),
        Some(Command::New(arguments)) => create::create(&arguments),
        Some(Command::Schema { what }) => create::schema(what),
        Some(Command::ListScenes) => list_scenes(),
        Some(Command::Validate(arguments)) => validate_scenes(&arguments),
        Some(Command::Ensemble(arguments)) => make_ensemble(&arguments),
        Some(Command::Bench(Bench::Accuracy(arguments))) => accuracy(&arguments),
        Some(Command::Bench(Bench::Speed(arguments))) => speed(&arguments),
        Some(Command::Compare(arguments)) => compare_runs(&arguments),
        Some(Command::Reproduce(what)) => reproduce(&what),
    };
    result.unwrap_or_else(|error| {
        tell!("error: {error}");
        ExitCode::FAILURE
    })
}

/// A flag that the first Ctrl-C raises; the second ends the program at once.
fn watch_for_interruption(style: Style) -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            fmu::allow_exit();
            std::process::exit(i32::from(INTERRUPTED));
        }
        match style {
            Style::Json => tell!("{}", serde_json::json!({ "event": "interrupted" })),
            _ => tell!("ending after this step; once more to end at once"),
        }
    })?;
    Ok(flag)
}

fn pack_fmus(scene: Option<&str>, set: &[String], out: &Path) -> Result<ExitCode, Failure> {
    let packed = match scene {
        None if !set.is_empty() => return Err("--set changes a scene, and none is given".into()),
        None => pack::pack(out)?,
        Some(target) => {
            let target = Target::find(target)?.changed(set);
            pack::pack_scene(out, &Scene::from_file_with(&target.path, &target.overrides()?)?)?
        }
    };
    for packed in packed {
        let state = if packed.written { "written" } else { "unchanged" };
        answer!("{} ({} kB, {state})", packed.path.display(), packed.size / 1000);
    }
    Ok(ExitCode::SUCCESS)
}

fn export_package(target: &str, set: &[String], out: Option<PathBuf>) -> Result<ExitCode, Failure> {
    let target = Target::find(target)?.changed(set);
    let (changes, path) = (target.overrides()?, target.path);
    let mut scene = Scene::from_file_with(&path, &changes)?;
    if scene.fluid.is_none() || scene.body.is_empty() {
        return Err(format!("{} has no fluid or no body: there is nothing to couple", path.display()).into());
    }
    // Masters that import packages do not iterate.
    scene.coupling.method = scene::Method::Explicit;
    let name = scene::name_of(&path);
    let places = Places { scene: path.clone(), fmus: PathBuf::new(), frames: PathBuf::new() };
    let case = scene_case::case(&scene, &changes, None, &places);
    let text = scene::read_text(&path)?;
    let overrides: Vec<String> = changes.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let system =
        pack::ssp::System { name: &name, scene: &scene, text: &text, overrides: &overrides.join("; "), case: &case };
    let out = out.unwrap_or_else(|| PathBuf::from(format!("{name}.ssp")));
    let size = pack::ssp::write_package(&out, &system)?;
    answer!("{} ({} kB)", out.display(), size / 1000);
    Ok(ExitCode::SUCCESS)
}

fn list_scenes() -> Result<ExitCode, Failure> {
    let folder = pack::scenes_folder()?;
    for path in pack::files_with(&folder, "toml")? {
        let name = scene::name_of(&path);
        match Scene::from_file(&path) {
            Ok(scene) => answer!("{name:24} {}", scene.title),
            Err(error) => answer!("{name:24} not valid: {error}"),
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn accuracy(arguments: &bench::AccuracyArguments) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption(Style::default())?;
    let page = bench::accuracy(arguments, &pack::scenes_folder()?, &Plimsoll, &interrupted)?;
    answer!("report: {}", page.display());
    Ok(ended(&interrupted, true))
}

fn validate_scenes(arguments: &ValidateArguments) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption(Style::default())?;
    let validation = validate::validate(arguments, &Plimsoll, &interrupted)?;
    answer!("record: {}", validation.record.display());
    match ended(&interrupted, validation.complete) {
        ExitCode::SUCCESS if validation.missed > 0 => Ok(ExitCode::from(MISSED)),
        code => Ok(code),
    }
}

fn make_ensemble(arguments: &EnsembleArguments) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption(Style::default())?;
    let outcome = ensemble::ensemble(arguments, &Plimsoll, &interrupted)?;
    answer!("report: {}", outcome.page.display());
    Ok(ended(&interrupted, outcome.complete))
}

fn compare_runs(arguments: &CompareArguments) -> Result<ExitCode, Failure> {
    answer!("report: {}", compare::compare(arguments)?.display());
    Ok(ExitCode::SUCCESS)
}

fn reproduce(what: &Reproduce) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption(Style::default())?;
    let (page, complete) = reproduce::run(what, &Plimsoll, &interrupted)?;
    answer!("report: {}", page.display());
    Ok(ended(&interrupted, complete))
}

fn ended(interrupted: &AtomicBool, complete: bool) -> ExitCode {
    match (interrupted.load(Ordering::Relaxed), complete) {
        (true, _) => ExitCode::from(INTERRUPTED),
        (false, true) => ExitCode::SUCCESS,
        (false, false) => ExitCode::FAILURE,
    }
}

fn speed(arguments: &bench::speed::SpeedArguments) -> Result<ExitCode, Failure> {
    let interrupted = watch_for_interruption(Style::default())?;
    let page = bench::speed::speed(arguments, &pack::scenes_folder()?, &Plimsoll, &interrupted)?;
    answer!("report: {}", page.display());
    Ok(ended(&interrupted, true))
}
