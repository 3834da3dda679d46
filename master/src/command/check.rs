//! `plimsoll check`: what a scene is and what its run will take, before it runs. What a run would refuse before its first
//! step, this refuses in the same words, for both set up the same.

use super::Failure;
use super::run::{located, participants, read_case};
use crate::case::Case;
use crate::estimate::{Estimate, estimate};
use crate::log::Log;
use crate::progress::Style;
use crate::scene_case::{self, Places};
use crate::target::Target;
use crate::{answer, in_process, job, run, tell};
use components::{Interface, memory};
use report::checks;
use report::{self, SetUp};
use scene::Scene;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Most particles that are drawn; of more, one in so many.
const MOST_DRAWN: usize = 20_000;

/// What to check.
#[derive(Debug, clap::Args)]
pub(super) struct CheckArguments {
    /// Name of a scene, or path of a scene or case file.
    target: String,
    /// Change a value, for example --set fluid.spacing=0.002; may be repeated.
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Picture of the set-up, PNG with an SVG beside it [default: results/NAME-set-up.png].
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Leave out the estimate of steps, time and memory, for which some seconds are tried.
    #[arg(long)]
    no_estimate: bool,
}

pub(super) fn check(arguments: &CheckArguments) -> Result<ExitCode, Failure> {
    let target = Target::find(&arguments.target)?.changed(&arguments.set);
    let overrides = target.overrides()?;
    if target.is_case() {
        return check_case(&target);
    }
    let scene = Scene::from_file_with(&target.path, &overrides)?;
    memory::check_run(&scene)?;
    set_up(&scene, &target, &overrides)?;
    // What is odd about it was said in the set-up.
    let (particles, _) = components::fluid_set_up(&scene)?;
    let (coordinates, structure) = components::structure_set_up(&scene)?;
    let (path, count) = (target.path.display(), particles.len());
    answer!("# {path}: valid; {count} particles, {coordinates} coordinates of the structure;");
    if !(particles.is_empty() || arguments.no_estimate) {
        say(estimate(&scene, &std::path::absolute(&target.path)?, &overrides, count));
    }
    let default = || Path::new("results").join(format!("{}-set-up.png", target.name));
    let mut stem = arguments.picture.clone().unwrap_or_else(default);
    if stem.extension().is_some_and(|extension| extension == "png" || extension == "svg") {
        stem.set_extension("");
    }
    if let Some(folder) = stem.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("the folder {} cannot be made: {error}", folder.display()))?;
    }
    report::prepare_font();
    let drawn = thinned(&particles);
    let picture = SetUp { scene: &scene, particles: &drawn, structure: &structure }.draw(&stem)?;
    if drawn.len() < count {
        answer!("# {} of the {count} particles are drawn;", drawn.len());
    }
    answer!("# drawn in {};", picture.display());
    answer!("# every number, defaults included:\n{}", toml::to_string(&scene)?);
    Ok(ExitCode::SUCCESS)
}

/// At most [`MOST_DRAWN`] of the particles, from everywhere alike.
fn thinned(particles: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let every = particles.len().div_ceil(MOST_DRAWN).max(1);
    particles.iter().step_by(every).copied().collect()
}

/// Sets a scene up as a run does, in process; nothing is written.
fn set_up(scene: &Scene, target: &Target, overrides: &[(String, String)]) -> Result<(), Failure> {
    let places = Places { scene: std::path::absolute(&target.path)?, fmus: PathBuf::new(), frames: PathBuf::new() };
    let mut case = scene_case::case(scene, overrides, None, &places);
    for fmu in &mut case.fmu {
        fmu.parameters.retain(|name, _| !name.starts_with("output_"));
    }
    checks::refuse_outside(&case.check, &target.references)?;
    let participants = in_process::participants(&case, &Interface::of(scene), &Log::to_terminal(Style::Bar))?;
    let mut warnings = job::warnings(&case, Some(scene), &target.references);
    warnings.extend(run::set_up(&case, participants)?.1);
    warnings.iter().for_each(|warning| tell!("warning: {warning}"));
    Ok(())
}

/// Loads the FMUs of a case, sets them up and connects them as a run does; no step is made.
fn check_case(target: &Target) -> Result<ExitCode, Failure> {
    let case = read_case(target)?;
    checks::refuse_outside(&case.check, &target.references)?;
    let mut warnings = job::warnings(&case, None, &target.references);
    let participants = participants(&case, &Log::to_terminal(Style::Bar))?;
    warnings.extend(run::set_up(&case, participants).map_err(|error| located(error, target))?.1);
    warnings.iter().for_each(|warning| tell!("warning: {warning}"));
    let text = toml::to_string(&Case::from_file(&target.path, &target.overrides()?)?)?;
    answer!("# {}: valid; every number, defaults included:\n{text}", target.path.display());
    Ok(ExitCode::SUCCESS)
}

fn say(estimate: Option<Estimate>) {
    let Some(Estimate { steps, internal, seconds, memory, seen }) = estimate else {
        answer!("# no estimate of steps and time: not even the first step could be tried;");
        return;
    };
    let water =
        if internal > 1.01 * steps { format!(" ({internal:.0} internal ones of the water)") } else { String::new() };
    let (time, megabytes) = (duration(seconds), memory / 1e6);
    answer!("# about {steps:.0} steps{water}, give or take 30 %; {megabytes:.0} MB;");
    let share = 100.0 * seen;
    let of = if seen > 0.99 { String::new() } else { format!(" of the first {share:.0} %") };
    // Other programs on the machine make a step slower than in the trial: short runs on a busy one took six times as long.
    answer!("# {time} on this machine as busy as it is now, roughly: busier ones took up to six times as long;");
    answer!("# from a coarse trial{of} and a few steps with all particles;");
}

fn duration(seconds: f64) -> String {
    match seconds {
        ..10.0 => format!("{seconds:.1} s"),
        ..120.0 => format!("{seconds:.0} s"),
        ..7200.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.0} h", seconds / 3600.0),
    }
}
