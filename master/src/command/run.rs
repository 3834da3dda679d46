//! `plimsoll run`: a scene, a case, or an earlier run again.

use super::{Failure, INTERRUPTED, MISSED, watch_for_interruption};
use crate::case::Case;
use crate::fmu::FmuParticipant;
use crate::folder::{RunFolder, Wish};
use crate::job::{self, Job, ReportMetadata};
use crate::log::Log;
use crate::pack;
use crate::progress::{Progress, Style};
use crate::record::{Recipe, Status, Summary};
use crate::run::Outcome;
use crate::scene_case::{self, Places};
use crate::target::Target;
use crate::{answer, fmu, tell};
use components::Interface;
use coupling::participant::Participant;
use report::checks;
use report::{Short, number};
use scene::Scene;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// The change that makes a scene its quick variant.
const QUICK: &str = "quick.active=true";

/// What to run and where its results go.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct RunArguments {
    /// Name of a scene, path of a scene or case file, or folder of an earlier run, to repeat it.
    #[arg(value_name = "SCENE-OR-CASE")]
    pub(crate) target: String,
    /// Change a value, for example --set fluid.spacing=0.002; may be repeated.
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Run the scene's quick variant: coarser and shorter, with limits of its own.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Folder for the results, of this run alone [default: results/NAME].
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Threads of the fluid; 0 takes all processors [default: as the scene says].
    #[arg(long)]
    pub(crate) threads: Option<usize>,
    /// Go on from the checkpoint in the folder for the results, if there is one, with the same bits as without the
    /// stop; threads, checkpoint interval and end of the run may be others. Without a checkpoint it begins anew.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Replace a complete run in the folder for the results. Only files that its run.json lists are removed; a folder that
    /// holds anything else is refused.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// What is said on standard error.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) log: Style,
    /// Print nothing but warnings and errors: --log quiet, and no figures.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Write results.parquet beside results.csv.
    #[arg(long)]
    pub(crate) parquet: bool,
}

impl RunArguments {
    fn style(&self) -> Style {
        if self.quiet { Style::Quiet } else { self.log }
    }

    fn folder(&self, target: &Target) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("results").join(&target.name))
    }
}

pub(super) fn run(arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let target = find(arguments)?;
    if arguments.resume
        && !arguments.overwrite
        && let Some(summary) = done(arguments, &target)?
    {
        let folder = arguments.folder(&target);
        crate::folder::tidy(&folder)?;
        tell!("the run in {} is complete already; --overwrite does it again", folder.display());
        summary.missed.iter().for_each(|limit| tell!("warning: {limit}"));
        if arguments.style() == Style::Bar {
            answer!("report: {}", folder.join("report.html").display());
        }
        return Ok(code(&summary));
    }
    let interrupted = watch_for_interruption(arguments.style())?;
    let (summary, _, folder) = execute_target(arguments, &target, &interrupted)?;
    Ok(conclude(&summary, &folder, arguments))
}

/// The summary of the same run, by the same version, if it is complete in its folder, its report with it.
fn done(arguments: &RunArguments, target: &Target) -> Result<Option<Summary>, Failure> {
    let folder = arguments.folder(target);
    let Some(recipe) = Recipe::read(&folder)?.filter(Recipe::is_whole) else { return Ok(None) };
    let same = recipe.set == target.set && recipe.version == env!("CARGO_PKG_VERSION");
    let text = std::fs::read_to_string(Recipe::scene_in(&folder)).unwrap_or_default();
    if !same || text != target.text {
        return Ok(None);
    }
    let summary = Summary::read(&folder.join("summary.json"));
    Ok(Some(summary.map_err(|error| format!("{error}; --overwrite does the run again"))?))
}

/// Runs a scene or a case and writes everything about it into the folder that is returned.
pub(crate) fn execute(
    arguments: &RunArguments,
    interrupted: &AtomicBool,
) -> Result<(Summary, Outcome, PathBuf), Failure> {
    execute_target(arguments, &find(arguments)?, interrupted)
}

/// The target with the changes asked for.
fn find(arguments: &RunArguments) -> Result<Target, Failure> {
    let variant = arguments.quick.then(|| QUICK.to_string());
    Ok(Target::find(&arguments.target)?.changed(variant.as_slice()).changed(&arguments.set))
}

fn execute_target(
    arguments: &RunArguments,
    target: &Target,
    interrupted: &AtomicBool,
) -> Result<(Summary, Outcome, PathBuf), Failure> {
    let folder = arguments.folder(target);
    let (job, packing) = if target.is_case() {
        (case_job(target, folder, arguments)?, None)
    } else {
        scene_job(target, folder, arguments)?
    };
    checks::refuse_outside(&job.case.check, &job.references)?;
    let held = RunFolder::open(&job.folder)?;
    let wish = Wish { resume: arguments.resume, overwrite: arguments.overwrite };
    let checkpoint = job.take_folder(&held, wish)?;
    if let Some(packing) = packing {
        packing.pack(arguments.style())?;
    }
    let mut recipe = job.recipe(target, arguments.threads);
    if let (Some(_), Some(begun)) = (&checkpoint, held.recipe()) {
        recipe.go_on_with(begun);
    }
    recipe.write(&job.folder, &target.text)?;
    let style = arguments.style();
    let log = Log::to_file(&job.folder.join("log.txt"), style, checkpoint.is_some())?;
    let participants = participants(&job.case, &log)?;
    let _watch = fmu::watch(job.case.limits.step_limit_seconds);
    if style == Style::Bar {
        tell!("{}: {} s", job.case.title, job.case.run.end);
    }
    let mut progress = Progress::new(job.case.start, job.case.run.end, style).logged(&log);
    if let Some(note) = held.note() {
        progress.warn(note);
    }
    let executed = job.execute(participants, checkpoint, interrupted, &mut progress);
    let (summary, outcome) = executed.map_err(|error| located(error, target))?;
    Ok((summary, outcome, job.folder))
}

/// FMUs that a run needs, not packed yet.
struct Packing {
    folder: PathBuf,
    interface: Interface,
}

impl Packing {
    fn pack(&self, style: Style) -> Result<(), Failure> {
        for packed in pack::pack_interface(&self.folder, &self.interface)? {
            if packed.written && style == Style::Bar {
                tell!("packed {}", packed.path.display());
            }
        }
        Ok(())
    }
}

fn scene_job(target: &Target, folder: PathBuf, arguments: &RunArguments) -> Result<(Job, Option<Packing>), Failure> {
    let overrides = target.overrides()?;
    let scene = Scene::from_file_with(&target.path, &overrides)?;
    components::memory::check_run(&scene)?;
    let interface = Interface::of(&scene);
    let fmus = pack::fmus_folder(&interface, &folder)?;
    let frames = std::path::absolute(folder.join("frames"))?;
    if frames.to_str().is_none() {
        return Err(format!("{}: no UTF-8, which is all that an FMU takes for a path", frames.display()).into());
    }
    let packing = Packing { folder: fmus.clone(), interface };
    let places = Places { scene: std::path::absolute(&target.path)?, fmus, frames };
    let case = scene_case::case(&scene, &overrides, arguments.threads, &places);
    let inputs = toml::to_string(&scene.for_resuming())?;
    let (name, references) = (target.name.clone(), target.references.clone());
    let warnings = job::warnings(&case, Some(&scene), &references);
    let (metadata, parquet) = (ReportMetadata::of(&scene), arguments.parquet);
    Ok((Job { name, case, folder, references, metadata, inputs, parquet, warnings }, Some(packing)))
}

fn case_job(target: &Target, folder: PathBuf, arguments: &RunArguments) -> Result<Job, Failure> {
    if arguments.threads.is_some() {
        return Err("--threads is for scenes; in a case set the parameter of the FMU, for example --set \
                    fmu.0.parameters.threads=2"
            .into());
    }
    let case = read_case(target)?;
    let inputs = toml::to_string(&case.for_resuming())?;
    let (name, references) = (target.name.clone(), target.references.clone());
    let warnings = job::warnings(&case, None, &references);
    let (metadata, parquet) = (ReportMetadata::default(), arguments.parquet);
    Ok(Job { name, case, folder, references, metadata, inputs, parquet, warnings })
}

/// The case of a file, with FMUs where they are now.
pub(super) fn read_case(target: &Target) -> Result<Case, Failure> {
    let mut case = Case::from_file(&target.path, &target.overrides()?)?;
    // A copy of the case in the results of an earlier run names FMUs relative to where the case was.
    if target.path.parent() != Some(&target.references) {
        let folder = target.path.parent().unwrap_or(Path::new(""));
        for fmu in &mut case.fmu {
            if let Ok(relative) = fmu.path.strip_prefix(folder) {
                fmu.path = target.references.join(relative);
            }
        }
    }
    Ok(case)
}

/// The FMUs of a case, loaded.
pub(super) fn participants(case: &Case, log: &Log) -> Result<Vec<Box<dyn Participant>>, Failure> {
    let mut participants: Vec<Box<dyn Participant>> = Vec::new();
    for fmu in &case.fmu {
        participants.push(Box::new(FmuParticipant::load_within(&fmu.path, &fmu.name, log, &case.limits)?));
    }
    Ok(participants)
}

/// The error of a run with file and line, where a key of a case file asked for what cannot be.
pub(super) fn located(error: crate::run::Error, target: &Target) -> Failure {
    let crate::run::Error::Key { key, .. } = &error else { return error.into() };
    if !target.is_case() {
        return error.into();
    }
    let file = scene::file_name(&target.path);
    let overrides = target.overrides().unwrap_or_default();
    let line = scene::line_unless_set(&target.text, key, &overrides);
    let line = line.map_or_else(String::new, |line| format!(", line {line}"));
    format!("{file}{line}: {error}").into()
}

fn conclude(summary: &Summary, folder: &Path, arguments: &RunArguments) -> ExitCode {
    let report = folder.join("report.html");
    let (steps, wall, simulated) = (summary.steps, summary.wall_seconds, summary.simulated_seconds);
    match (arguments.style(), &summary.error) {
        (Style::Json, error) => tell!(
            "{}",
            json!({
                "event": "end", "status": summary.status, "error": error, "steps": steps, "simulated_seconds": simulated,
                "wall_seconds": wall, "checks": summary.checks, "missed": summary.missed, "report": report,
            })
        ),
        (_, Some(error)) => tell!("error: {error}"),
        // What the watch found was told when it was found.
        (_, None) => {
            let outside = summary.checks.iter().filter_map(|(name, check)| check.missed(name));
            outside.for_each(|limit| tell!("warning: {limit}"));
        }
    }
    if arguments.style() == Style::Bar {
        tell!("{simulated:.6} s simulated in {steps} steps, {wall:.1} s of wall-clock time");
        for (name, check) in &summary.checks {
            let reference = check.reference.map_or_else(String::new, |value| format!(", reference {}", Short(value)));
            answer!("{name}: {} {}{reference}", number(check.value), check.unit);
        }
        answer!("report: {}", report.display());
    }
    if arguments.style() == Style::Bar && folder.join(crate::checkpoint::FILE_NAME).is_file() {
        tell!("to go on from the last checkpoint: the same command with --resume");
    }
    code(summary)
}

fn code(summary: &Summary) -> ExitCode {
    match summary.status {
        Status::Complete if !summary.missed.is_empty() => ExitCode::from(MISSED),
        Status::Complete => ExitCode::SUCCESS,
        Status::Interrupted => ExitCode::from(INTERRUPTED),
        Status::Failed => ExitCode::FAILURE,
    }
}
