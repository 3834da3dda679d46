//! `plimsoll check`: what a scene is and what its run will take, before it runs.

use super::Failure;
use crate::case::Case;
use crate::report::{self, SetUp};
use crate::target::Target;
use crate::{answer, tell};
use components::memory;
use scene::Scene;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Most particles that are drawn; of more, one in so many.
const MOST_DRAWN: usize = 20_000;
/// Processor time of a particle in an internal step \[s\], and what each coordinate of a structure that answers adds
/// (docs/benchmarks; docs/validation).
const STEP_SECONDS: f64 = 0.9e-6;
const COORDINATE_SECONDS: f64 = 0.3e-6;
/// Wall-clock time of a coupled step whatever its size, for exchange and threads: from the dam break on a plate with 2700
/// to 42600 particles.
const COUPLING_SECONDS: f64 = 2.4e-3;
/// Speed-up by each thread beyond the first.
const THREAD_SHARE: f64 = 0.8;
/// Share of the stable step that a run takes.
const STEP_SHARE: f64 = 0.8;

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
}

pub(super) fn check(arguments: &CheckArguments) -> Result<ExitCode, Failure> {
    let target = Target::find(&arguments.target)?.changed(&arguments.set);
    let (path, overrides) = (target.path.display(), target.overrides()?);
    if target.is_case() {
        let text = toml::to_string(&Case::from_file(&target.path, &overrides)?)?;
        answer!("# {path}: valid; every number, defaults included:\n{text}");
        return Ok(ExitCode::SUCCESS);
    }
    let scene = Scene::from_file_with(&target.path, &overrides)?;
    memory::check_run(&scene)?;
    let (particles, warnings) = components::fluid_set_up(&scene)?;
    let (coordinates, structure) = components::structure_set_up(&scene)?;
    let bytes = memory::PROGRAM + particles.len() as f64 * memory::by_particle(&scene);
    let memory = (bytes / 1e6).ceil();
    let count = particles.len();
    answer!("# {path}: valid; {count} particles (about {memory} MB), {coordinates} coordinates of the structure;");
    warnings.iter().for_each(|warning| tell!("warning: {warning}"));
    if !particles.is_empty() {
        let (steps, seconds) = estimate(&scene, &particles, coordinates);
        answer!("# about {steps:.0} steps and {} on this machine, give or take a factor of two;", duration(seconds));
    }
    for warning in crate::warnings::of_scene(&scene) {
        answer!("# warning: {warning};");
    }
    let default = || Path::new("results").join(format!("{}-set-up.png", target.name));
    let mut stem = arguments.picture.clone().unwrap_or_else(default);
    if stem.extension().is_some_and(|extension| extension == "png" || extension == "svg") {
        stem.set_extension("");
    }
    if let Some(folder) = stem.parent() {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
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

/// Steps and wall-clock seconds of a run: particles are taken to move as fast as water that falls from the highest to
/// the lowest.
fn estimate(scene: &Scene, particles: &[[f32; 2]], coordinates: usize) -> (f64, f64) {
    let Some(fluid) = &scene.fluid else { return (0.0, 0.0) };
    let heights = particles.iter().map(|place| f64::from(place[1]));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    let gravity = scene.gravity[0].hypot(scene.gravity[1]);
    let start = fluid.start.velocity[0].hypot(fluid.start.velocity[1]);
    let speed = (2.0 * gravity * (high - low)).sqrt().max(start).max(f64::MIN_POSITIVE);
    let courant = match fluid.scheme {
        scene::Scheme::Accurate => fluid.accurate.courant,
        scene::Scheme::Paper => fluid.paper.courant,
    };
    let stable = STEP_SHARE * courant * fluid.spacing / speed;
    let steps = scene.run.end / stable.min(scene.run.communication_step);
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if fluid.threads == 0 { processors } else { fluid.threads.min(processors) };
    let cost = STEP_SECONDS + coordinates as f64 * COORDINATE_SECONDS;
    let water = particles.len() as f64 * cost / (1.0 + THREAD_SHARE * (threads as f64 - 1.0));
    let coupling = if coordinates > 0 { COUPLING_SECONDS } else { 0.0 };
    (steps, steps * (water + coupling))
}

fn duration(seconds: f64) -> String {
    match seconds {
        ..10.0 => format!("{seconds:.1} s"),
        ..120.0 => format!("{seconds:.0} s"),
        ..7200.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.0} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_at_most_so_many_particles() {
        let of = |count: usize| thinned(&vec![[0.0; 2]; count]).len();
        assert_eq!((of(0), of(20_000), of(20_001), of(10_000_000)), (0, 20_000, 10_001, 20_000));
    }
}
