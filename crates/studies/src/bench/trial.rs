//! One timed run: a scene at one spacing with one scheme, without frames and plots.

use super::machine::processor_seconds;
use super::plan::Plan;
use crate::{Measured, Program, watched};
use report::checks::{self, Context};
use report::record::{CheckResult, Series, Status};
use scene::{CheckKind, Scene, Scheme};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What all runs of a comparison share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Threads of the fluid.
    pub threads: usize,
    /// Longest wall-clock time of one run \[s\].
    pub cap: f64,
}

/// A run and what it gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Discretisation.
    pub scheme: Scheme,
    /// Particle spacing \[m\].
    pub spacing: f64,
    /// Size of each error of the plan, in its order; none where there is none.
    pub errors: Vec<Option<f64>>,
    /// Unit of each error.
    pub units: Vec<String>,
    /// What went wrong; empty when nothing did.
    pub problem: String,
    /// Wall-clock time \[s\].
    pub wall: f64,
    /// Processor time of all threads \[s\], where the system tells it.
    pub processor: Option<f64>,
    /// Threads of the fluid.
    pub threads: usize,
    /// What the recorded series says.
    pub work: Work,
}

/// Work that a run did, summed over its internal steps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Work {
    /// Internal time steps.
    pub steps: f64,
    /// Particles at the end.
    pub particles: f64,
    /// Particles times internal steps.
    pub particle_steps: f64,
    /// Iterations of the pressure solver.
    pub iterations: f64,
    /// Particles removed because they left the domain.
    pub lost: f64,
    /// Change of the area of the water over its first area.
    pub area_change: Option<f64>,
}

impl Trial {
    fn unmeasured(plan: &Plan, scheme: Scheme, spacing: f64, threads: usize) -> Self {
        let count = plan.figures.len();
        Self {
            scheme,
            spacing,
            errors: vec![None; count],
            units: vec![String::new(); count],
            problem: String::new(),
            wall: 0.0,
            processor: None,
            threads,
            work: Work::default(),
        }
    }

    /// The time that counts \[s\]: processor time, which other programs on the machine hardly change, else wall-clock
    /// time.
    pub fn seconds(&self) -> f64 {
        self.processor.unwrap_or(self.wall)
    }

    /// Takes the times of a repeat where they are shorter: other programs only ever add to them.
    pub fn keep_faster(&mut self, repeat: &Self) {
        self.wall = self.wall.min(repeat.wall);
        self.processor = self.processor.zip(repeat.processor).map(|(a, b)| a.min(b));
    }
}

/// Runs a scene of the folder `scenes`. A run that fails, or is ended by `cap` or `interrupted`, says so in
/// `problem`; the error is a scene that cannot be read.
pub fn trial(
    plan: &Plan,
    scenes: &Path,
    scheme: Scheme,
    spacing: f64,
    limits: &Limits,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<Trial, Box<dyn Error>> {
    let path = std::path::absolute(scenes.join(format!("{}.toml", plan.scene)))?;
    let overrides = overrides(plan, &Scene::from_file(&path)?, scheme, spacing);
    let scene = Scene::from_file_with(&path, &overrides)?;
    let folder = tempfile::tempdir()?;
    let begin = Instant::now();
    let processor = processor_seconds();
    let run = |stop: &AtomicBool| program.measure(&scene, &path, &overrides, limits.threads, folder.path(), stop);
    let (outcome, capped) = watched(run, limits.cap, interrupted);
    let wall = begin.elapsed().as_secs_f64();
    let processor = processor.zip(processor_seconds()).map(|(before, after)| after - before);
    let mut trial = Trial { wall, processor, ..Trial::unmeasured(plan, scheme, spacing, limits.threads) };
    match outcome {
        Err(reason) => trial.problem = reason,
        Ok(outcome) => {
            trial.work = work(&outcome.series);
            trial.problem = problem(&outcome, capped.then_some(limits.cap), trial.work.particles);
            let context = Context {
                series: &outcome.series,
                frames: &folder.path().join("frames"),
                folder: scenes,
                water: checks::water(&scene),
            };
            trial.take_errors(plan, &checks::evaluate(&scene.check, &context));
        }
    }
    Ok(trial)
}

impl Trial {
    /// Takes the figures of a run that reached its end.
    fn take_errors(&mut self, plan: &Plan, results: &BTreeMap<String, CheckResult>) {
        for (index, figure) in plan.figures.iter().enumerate() {
            let Some(result) = results.get(*figure) else { continue };
            self.units[index].clone_from(&result.unit);
            if !self.problem.is_empty() {
                continue;
            }
            // A distance from a curve is an error without a reference.
            self.errors[index] = result.error.or(result.value).map(f64::abs);
        }
        let missing = plan.figures.iter().filter_map(|figure| {
            let reason = results.get(*figure).map_or(Some("the scene has no such check"), |it| it.problem.as_deref());
            Some(format!("no '{figure}': {}", reason?))
        });
        if self.problem.is_empty() {
            self.problem = missing.collect::<Vec<_>>().join("; ");
        }
    }
}

/// Changes to the scene. Frames are written only where an error is computed from them, and then one at the end.
fn overrides(plan: &Plan, scene: &Scene, scheme: Scheme, spacing: f64) -> Vec<(String, String)> {
    let end = plan.end.unwrap_or(scene.run.end);
    let chosen = scene.check.iter().filter(|check| plan.figures.contains(&check.name.as_str()));
    let frames = chosen.into_iter().any(|check| check.kind == CheckKind::HydrostaticPressure);
    let pair = |key: &str, value: String| (key.to_string(), value);
    vec![
        pair("fluid.scheme", format!("'{}'", scheme.name())),
        pair("fluid.spacing", format!("{spacing:?}")),
        pair("run.end", format!("{end:?}")),
        pair(
            "run.communication_step",
            format!("{:?}", plan.communication_step(spacing, scene.run.communication_step, end)),
        ),
        pair("output.interval", format!("{:?}", if frames { end } else { 0.0 })),
        pair("output.record_interval", "0.0".to_string()),
    ]
}

fn problem(outcome: &Measured, cap: Option<f64>, particles: f64) -> String {
    let at = outcome.simulated;
    match (outcome.status, &outcome.error, cap) {
        (Status::Failed, Some(error), _) => format!("failed at {at:.4} s: {error}"),
        (Status::Failed, None, _) => format!("failed at {at:.4} s"),
        (Status::Interrupted, _, Some(cap)) => format!("ended at {at:.4} s by the cap of {cap} s"),
        (Status::Interrupted, _, None) => format!("interrupted at {at:.4} s"),
        (Status::Complete, ..) if particles < 1.0 => "no particle is left".to_string(),
        (Status::Complete, ..) => String::new(),
    }
}

/// Sums over the recorded communication steps; the first row is the start, before any step.
fn work(series: &Series) -> Work {
    let column = |name: &str| series.column(&format!("fluid.{name}")).map_or(&[][..], |column| &column.values);
    let (counts, substeps, area) = (column("particles.count"), column("solver.substeps"), column("area"));
    let ends = area.first().zip(area.last()).filter(|(first, _)| **first != 0.0);
    Work {
        steps: substeps.iter().skip(1).sum(),
        particles: counts.last().copied().unwrap_or(0.0),
        particle_steps: counts.iter().zip(substeps).skip(1).map(|(count, steps)| count * steps).sum(),
        iterations: column("solver.iterations").iter().skip(1).sum(),
        lost: column("particles.lost").iter().copied().fold(0.0, f64::max),
        area_change: ends.map(|(first, last)| (last - first) / first),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::plan::PLANS;
    use report::record::Column;

    fn result(value: Option<f64>, error: Option<f64>, problem: Option<&str>) -> CheckResult {
        let (unit, source) = ("m".to_string(), String::new());
        let problem = problem.map(str::to_string);
        CheckResult {
            value,
            reference: None,
            error,
            unit,
            limit: None,
            passed: None,
            details: BTreeMap::new(),
            source,
            problem,
        }
    }

    fn empty(plan: &Plan) -> Trial {
        Trial { wall: 2.0, processor: Some(1.5), ..Trial::unmeasured(plan, Scheme::Voronoi, 0.01, 1) }
    }

    #[test]
    fn errors_are_distances_and_what_is_missing_is_said() {
        let plan = Plan { figures: &["period", "curve", "energy"], ..PLANS[0] };
        let mut trial = empty(&plan);
        let results = BTreeMap::from([
            ("period".to_string(), result(Some(0.99), Some(-0.01), None)),
            ("curve".to_string(), result(Some(0.2), None, None)),
            ("energy".to_string(), result(None, None, Some("the value is NaN"))),
        ]);
        trial.take_errors(&plan, &results);
        assert_eq!(trial.errors, [Some(0.01), Some(0.2), None]);
        assert_eq!(trial.problem, "no 'energy': the value is NaN");
        let mut failed = Trial { problem: "failed at 0.1 s".to_string(), ..empty(&plan) };
        failed.take_errors(&plan, &results);
        assert_eq!((failed.errors, failed.problem.as_str()), (vec![None; 3], "failed at 0.1 s"));
    }

    #[test]
    fn work_is_summed_over_steps_and_not_over_the_start() {
        let column = |name: &str, values: &[f64]| Column {
            name: format!("fluid.{name}"),
            unit: String::new(),
            values: values.to_vec(),
        };
        let columns = vec![
            column("particles.count", &[100.0, 100.0, 90.0]),
            column("solver.substeps", &[7.0, 2.0, 3.0]),
            column("solver.iterations", &[9.0, 10.0, 20.0]),
            column("particles.lost", &[0.0, 0.0, 10.0]),
            column("area", &[2.0, 2.0, 1.8]),
        ];
        let work = work(&Series { times: vec![0.0, 0.1, 0.2], columns });
        assert_eq!((work.steps, work.particles, work.particle_steps), (5.0, 90.0, 470.0));
        assert_eq!((work.iterations, work.lost), (30.0, 10.0));
        assert!((work.area_change.unwrap() + 0.1).abs() < 1e-12);
    }

    #[test]
    fn the_faster_repeat_counts() {
        let mut trial = empty(&PLANS[0]);
        trial.keep_faster(&Trial { wall: 3.0, processor: Some(1.25), ..empty(&PLANS[0]) });
        assert_eq!((trial.wall, trial.seconds()), (2.0, 1.25));
    }
}
