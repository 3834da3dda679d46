//! `plimsoll validate`: scenes one after the other, and one dated record of the figures that they ask of themselves.

use crate::{Failure, Program, Request};
use report::machine::{self, Circumstances};
use report::record::{CheckResult, Status, Summary, write_whole};
use report::{Short, number};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// What to validate.
#[derive(Debug, clap::Args)]
pub struct ValidateArguments {
    /// Scenes by name or path [default: all].
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Their quick variants: coarser and shorter, with limits of their own.
    #[arg(long)]
    quick: bool,
    /// Folder for the runs, each in one of its own name; complete ones are replaced.
    #[arg(long, default_value = "results/validate")]
    out: PathBuf,
    /// File of the record [default: record.md in the folder for the runs].
    #[arg(long)]
    record: Option<PathBuf>,
    /// Threads of the fluid; 0 takes all processors [default: as the scenes say].
    #[arg(long)]
    threads: Option<usize>,
}

/// What came out.
#[derive(Debug)]
pub struct Validation {
    /// File of the record.
    pub record: PathBuf,
    /// Whether every run reached its end.
    pub complete: bool,
    /// Limits that were missed.
    pub missed: usize,
}

/// One scene: its summary, or why there is none.
struct Trial {
    scene: String,
    outcome: Result<Summary, String>,
}

/// Runs the scenes and writes the record, anew after each of them: what is there when a run is ended stays.
///
/// # Errors
/// No scenes, or a record that cannot be written. A scene that does not run is a line of the record.
pub fn validate(
    arguments: &ValidateArguments,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<Validation, Failure> {
    let scenes = if arguments.scenes.is_empty() { all_scenes(program)? } else { arguments.scenes.clone() };
    let record = arguments.record.clone().unwrap_or_else(|| arguments.out.join("record.md"));
    let (circumstances, load) = (Circumstances::now(), machine::load());
    let mut trials = Vec::new();
    for scene in &scenes {
        if interrupted.load(Ordering::Relaxed) {
            break;
        }
        let trial = run(scene, arguments, program, interrupted);
        program.tell(&format!("{:24} {}", trial.scene, trial.verdict()));
        trials.push(trial);
        if let Some(folder) = record.parent() {
            std::fs::create_dir_all(folder)?;
        }
        write_whole(&record, page(&trials, &circumstances, load, arguments.quick))?;
    }
    let complete = trials.len() == scenes.len() && trials.iter().all(Trial::is_complete);
    Ok(Validation { record, complete, missed: trials.iter().map(|trial| trial.missed().len()).sum() })
}

fn all_scenes(program: &dyn Program) -> Result<Vec<String>, Failure> {
    Ok(program.scenes()?.iter().map(|path| scene::name_of(path)).collect())
}

fn run(scene: &str, arguments: &ValidateArguments, program: &dyn Program, interrupted: &AtomicBool) -> Trial {
    let name = scene::name_of(Path::new(scene));
    let request = Request {
        scene: scene.to_string(),
        quick: arguments.quick,
        out: arguments.out.join(&name),
        threads: arguments.threads,
        overwrite: true,
        quiet: true,
        ..Request::default()
    };
    let outcome = program.run(&request, interrupted).map(|run| run.summary).map_err(|error| error.to_string());
    Trial { scene: name, outcome }
}

impl Trial {
    fn is_complete(&self) -> bool {
        self.outcome.as_ref().is_ok_and(|summary| summary.status == Status::Complete)
    }

    fn missed(&self) -> &[String] {
        self.outcome.as_ref().map_or(&[], |summary| &summary.missed)
    }

    fn verdict(&self) -> String {
        match &self.outcome {
            Err(error) => format!("refused: {error}"),
            Ok(summary) => match (&summary.error, summary.missed.is_empty()) {
                (Some(error), _) => format!("failed: {error}"),
                (None, false) => format!("missed: {}", summary.missed.join("; ")),
                (None, true) => format!("{} figures, {:.1} s", summary.checks.len(), summary.wall_seconds),
            },
        }
    }

    fn row(&self) -> String {
        let Ok(summary) = &self.outcome else { return format!("| {} | - | - | - | - |\n", self.scene) };
        let particles = summary.particles.map_or_else(|| "-".to_string(), |count| format!("{count:.0}"));
        format!(
            "| {} | {particles} | {} | {:.2} | {:.1} |\n",
            self.scene, summary.steps, summary.coupling.mean_iterations, summary.wall_seconds
        )
    }
}

fn page(trials: &[Trial], circumstances: &Circumstances, load: Option<f64>, quick: bool) -> String {
    let what = if quick { "quick variants of the scenes" } else { "scenes" };
    let date = circumstances.date.split(' ').next().unwrap_or_default();
    let mut text = format!("# {date}: {what}\n\n{}", machine::table(circumstances, (load, machine::load()), 1));
    let missed: Vec<String> = trials
        .iter()
        .filter(|trial| !trial.is_complete() || !trial.missed().is_empty())
        .map(|trial| format!("- {}: {}\n", trial.scene, trial.verdict()))
        .collect();
    let figures = || trials.iter().filter_map(|trial| Some((trial, trial.outcome.as_ref().ok()?)));
    let limits = figures().flat_map(|(_, summary)| summary.checks.values()).filter(|check| check.limit.is_some());
    let _ = writeln!(text, "{} scenes, {} limits.\n\n## Missed\n", trials.len(), limits.count());
    text += &if missed.is_empty() { "Nothing.\n".to_string() } else { missed.concat() };
    text += "\n## Figures\n\n| scene | figure | value | reference | error | limit | unit |\n|---|---|---|---|---|---|---|\n";
    for (trial, summary) in figures() {
        summary.checks.iter().for_each(|(name, check)| text += &row(&trial.scene, name, check));
    }
    text += "\n## Runs\n\n| scene | particles | steps | passes per step | wall-clock time \\[s\\] |\n|---|---|---|---|---|\n";
    trials.iter().for_each(|trial| text += &trial.row());
    text
}

fn row(scene: &str, name: &str, check: &CheckResult) -> String {
    let optional = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| Short(value).to_string());
    let limit = match (check.limit, check.passed) {
        (Some(limit), Some(false)) => format!("**{}**", Short(limit)),
        (limit, _) => optional(limit),
    };
    let value = check.problem.clone().unwrap_or_else(|| number(check.value));
    let (reference, error) = (optional(check.reference), optional(check.error));
    format!("| {scene} | {name} | {value} | {reference} | {error} | {limit} | {} |\n", check.unit)
}
