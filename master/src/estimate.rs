//! What a run will take: steps, time and memory, from two short trials in this process. How fast water gets is known by
//! no formula: a coarse trial of the whole run says it, and a few steps with all particles say what one costs here.

use crate::checkpoint::Schedule;
use crate::in_process;
use crate::log::Log;
use crate::progress::{Progress, Style};
use crate::record::Series;
use crate::run::{self, Outcome};
use crate::scene_case::{self, FLUID, Places};
use components::{Interface, memory};
use fluid::SUGGESTED_SHARE;
use scene::{Scene, Scheme};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Particles of the coarse trial.
const COARSE: f64 = 600.0;
/// Longest wall-clock times of the coarse trial and of the steps with all particles \[s\].
const COARSE_SECONDS: f64 = 5.0;
const FULL_SECONDS: f64 = 2.0;
/// Particles above which no step is tried: it would take longer than anybody waits for an estimate.
const MOST_TRIED: usize = 2_000_000;
/// Processor time of a particle in an internal step \[s\], as measured (docs/benchmarks), where no step is tried.
const STEP_SECONDS: f64 = 0.9e-6;
/// Share of the Courant number from which the speed limits a step of the trial, rather than the acceleration.
const BY_SPEED: f64 = 0.97;

/// What a run will take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Steps of the run, as its summary counts them.
    pub steps: f64,
    /// Internal steps of the water.
    pub internal: f64,
    /// Wall-clock time \[s\].
    pub seconds: f64,
    /// Memory of the process \[bytes\].
    pub memory: f64,
    /// Share of the run that the coarse trial saw.
    pub seen: f64,
}

/// Estimates the run of a valid scene with this many particles; `path` and `overrides` are those it was read with. None
/// without water, or where the trial fails at once.
pub fn estimate(scene: &Scene, path: &Path, overrides: &[(String, String)], particles: usize) -> Option<Estimate> {
    let fluid = scene.fluid.as_ref()?;
    let full = (particles <= MOST_TRIED).then(|| trial(path, overrides, None, FULL_SECONDS)).flatten();
    let finer = (particles as f64 / COARSE).sqrt();
    let finished = full.as_ref().is_some_and(|outcome| outcome.simulated >= scene.run.end * (1.0 - 1e-9));
    // A scene as coarse as the trial would be tries itself, and a body may be too thin for coarse particles.
    let coarser = [1.0, 1.5, 2.0, 3.0].map(|less| (finer / less).max(1.0));
    let coarse = coarser
        .into_iter()
        .filter(|_| !finished)
        .find_map(|factor| Some((factor, trial(path, overrides, Some(factor * fluid.spacing), COARSE_SECONDS)?)));
    let (factor, seen) = match (&coarse, &full) {
        (Some((factor, outcome)), _) => (*factor, outcome),
        (None, Some(outcome)) => (1.0, outcome),
        (None, None) => return None,
    };
    let counts = counts(scene, &seen.series, factor)?;
    let cost = full
        .as_ref()
        .and_then(|outcome| step_cost(&outcome.series, outcome.stages.advancing + outcome.stages.recording));
    let cost = cost.unwrap_or(particles as f64 * STEP_SECONDS);
    Some(Estimate {
        steps: counts.steps,
        internal: counts.internal,
        seconds: counts.internal * cost,
        memory: memory::PROGRAM + particles as f64 * memory::by_particle(scene),
        seen: (seen.simulated / scene.run.end).min(1.0),
    })
}

/// Runs the scene, or the same with another spacing \[m\], for this long \[s\]; none where nothing could be stepped.
fn trial(path: &Path, overrides: &[(String, String)], spacing: Option<f64>, cap: f64) -> Option<Outcome> {
    let mut overrides = overrides.to_vec();
    let mut change = |key: &str, value: f64| overrides.push((key.to_string(), format!("{value:?}")));
    change("output.interval", 0.0);
    change("output.record_interval", 0.0);
    if let Some(spacing) = spacing {
        change("fluid.spacing", spacing);
    }
    let scene = Scene::from_file_with(path, &overrides).ok()?;
    let folder = tempfile::tempdir().ok()?;
    let places = Places { scene: path.to_path_buf(), fmus: folder.path().into(), frames: folder.path().into() };
    let case = scene_case::case(&scene, &overrides, None, &places);
    let interface = Interface::of(&scene);
    let run = |stop: &AtomicBool| {
        let participants =
            in_process::participants(&case, &interface, &Log::default()).map_err(|error| error.to_string())?;
        let mut progress = Progress::new(case.start, case.run.end, Style::Silent);
        run::run(&case, participants, folder.path(), Schedule::never(), None, stop, &mut progress)
            .map(|(outcome, _)| outcome)
            .map_err(|error| error.to_string())
    };
    let (outcome, _) = studies::watched(run, cap, &AtomicBool::new(false));
    outcome.ok().filter(|outcome| outcome.simulated > 0.0)
}

/// Steps of a run, as its summary counts them, and internal ones of the water.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Counts {
    steps: f64,
    internal: f64,
}

/// Counts of the whole run with a spacing that is smaller by `factor` than that of the trial which gave `series`: the
/// speeds stay, the steps that they allow shrink with the spacing, those that the acceleration allows with its root.
/// What the trial did not see goes on like its second half.
fn counts(scene: &Scene, series: &Series, factor: f64) -> Option<Counts> {
    let fluid = scene.fluid.as_ref()?;
    let courant = match fluid.scheme {
        Scheme::Voronoi => fluid.voronoi.courant,
        Scheme::Mps => fluid.mps.courant,
    };
    let coarse = factor * fluid.spacing;
    let column = |name: &str| series.column(&format!("{FLUID}.{name}")).map(|column| &column.values);
    let (suggested, speeds) = (column("time_step.suggested")?, column("maximum_speed")?);
    let coupled = scene.moves();
    let mut parts = Vec::new();
    // The first row is the start, before any step.
    for (row, (suggested, speed)) in suggested.iter().zip(speeds).enumerate().skip(1) {
        let stable = suggested / SUGGESTED_SHARE;
        let by_speed = courant * coarse / speed.max(1e-12);
        let allowed = if stable >= BY_SPEED * by_speed {
            stable / factor
        } else {
            (by_speed / factor).min(stable / factor.sqrt())
        };
        let allowed = if coupled { SUGGESTED_SHARE * allowed } else { allowed };
        let step = (series.times[row] - series.times[row - 1]).min(scene.run.communication_step);
        parts.push((series.times[row], (step / allowed - 1e-9).ceil().max(1.0)));
    }
    let (last, _) = *parts.last()?;
    let sum = |from: f64| parts.iter().filter(|(time, _)| *time > from).map(|(_, parts)| parts).sum::<f64>();
    let half = parts[parts.len() / 2].0;
    let rate = if last > half { sum(half) / (last - half) } else { sum(0.0) / last };
    let internal = sum(f64::NEG_INFINITY) + rate * (scene.run.end - last).max(0.0);
    let whole = (scene.run.end / scene.run.communication_step - 1e-6).ceil();
    Some(Counts { steps: if coupled { internal.max(whole) } else { whole }, internal })
}

/// Wall-clock time of an internal step \[s\], repeats and records included, of a trial that took `seconds`.
fn step_cost(series: &Series, seconds: f64) -> Option<f64> {
    let substeps = &series.column(&format!("{FLUID}.solver.substeps"))?.values;
    let steps: f64 = substeps.iter().skip(1).sum();
    (steps > 0.0).then(|| seconds / steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Column;

    const SCENE: &str = "title = 'tank'\n[run]\nend = 1.0\ncommunication_step = 0.1\n[fluid]\nspacing = 0.01\n\
        water = [{ polygon = [[0,0],[1,0],[1,0.5],[0,0.5]] }]\n";

    /// Rows every 0.1 s up to `end`, with these steps suggested \[s\] and speeds \[m/s\].
    fn series(suggested: &[f64], speeds: &[f64]) -> Series {
        let column = |name: &str, values: &[f64]| Column {
            name: format!("{FLUID}.{name}"),
            unit: String::new(),
            values: values.to_vec(),
        };
        let times = (0..suggested.len()).map(|row| 0.1 * row as f64).collect();
        Series { times, columns: vec![column("time_step.suggested", suggested), column("maximum_speed", speeds)] }
    }

    #[test]
    fn steps_shrink_with_the_spacing_where_the_speed_limits_them_and_with_its_root_elsewhere() {
        let scene = Scene::from_str(SCENE, "t").unwrap();
        // 0.4 * 0.04 m / 1.6 m/s = 10 ms, suggested 8 ms: with a quarter of the spacing 2.5 ms, 40 steps in 0.1 s.
        let fast = counts(&scene, &series(&[0.0; 11].map(|_| 8e-3), &[1.6; 11]), 4.0).unwrap();
        assert_eq!((fast.steps, fast.internal.round()), (10.0, 400.0));
        // At rest the same 10 ms come from the acceleration: 5 ms.
        let still = counts(&scene, &series(&[8e-3; 11], &[0.0; 11]), 4.0).unwrap();
        assert_eq!((still.steps, still.internal.round()), (10.0, 200.0));
        // Half of it seen, which sped up after a quarter: the rest goes on as fast.
        let suggested = [8e-3, 80e-3, 80e-3, 8e-3, 8e-3, 8e-3];
        let half = counts(&scene, &series(&suggested, &[1.6, 0.16, 0.16, 1.6, 1.6, 1.6]), 1.0).unwrap();
        assert_eq!(half.internal.round(), 2.0 + 30.0 + 50.0);
    }

    #[test]
    fn coupled_steps_are_those_that_the_fluid_suggests() {
        let text =
            format!("{SCENE}[[body]]\nname = 'box'\nfree = ['y']\nmass = 1.0\nwall = [{{ points = [[0,0],[1,0]] }}]\n");
        let scene = Scene::from_str(&text, "t").unwrap();
        // 10 ms are stable, 8 ms suggested: 13 steps in 0.1 s.
        let coupled = counts(&scene, &series(&[8e-3; 11], &[1.6; 11].map(|speed| speed / 4.0)), 1.0).unwrap();
        assert_eq!((coupled.steps.round(), coupled.internal.round()), (130.0, 130.0));
    }
}
