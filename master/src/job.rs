//! A run with everything around it: the case, where its files go, and the report afterwards.

use crate::case::Case;
use crate::checkpoint::{self, Checkpoint, Schedule};
use crate::folder::{RunFolder, Wish, plots, tables};
use crate::progress::Progress;
use crate::record::{self, Recipe, Series, Status, Summary};
use crate::run::{self, Outcome};
use crate::target::Target;
use crate::tell;
use coupling::participant::Participant;
use report::checks::{self, Context};
use report::{Chart, Wanted};
use scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// What a scene tells the report beyond its case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReportMetadata {
    /// Discretisation of the fluid.
    pub scheme: Option<String>,
    /// Particle spacing \[m\].
    pub spacing: Option<f64>,
    /// Density \[kg/m3\] and magnitude of gravity \[m/s2\] of the water.
    pub water: Option<(f64, f64)>,
    /// Where set-up and reference come from.
    pub source: String,
    /// What differs from the source.
    pub differs: String,
}

impl ReportMetadata {
    /// What a report says of a scene.
    pub fn of(scene: &Scene) -> Self {
        let fluid = scene.fluid.as_ref();
        Self {
            scheme: fluid.map(|fluid| fluid.scheme.name().to_string()),
            spacing: fluid.map(|fluid| fluid.spacing),
            water: checks::water(scene),
            source: scene.source.clone(),
            differs: scene.differs.clone(),
        }
    }
}

/// A run to be done.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Name in the summary.
    pub name: String,
    /// What runs.
    pub case: Case,
    /// Where all files go.
    pub folder: PathBuf,
    /// Folder that reference files of checks are relative to.
    pub references: PathBuf,
    /// What the scene tells beyond the case.
    pub metadata: ReportMetadata,
    /// All that decides its numbers, as text: a run is resumed with the same inputs only.
    pub inputs: String,
    /// Whether results.parquet is written.
    pub parquet: bool,
    /// What a user should know before it runs.
    pub warnings: Vec<String>,
}

/// What a user should know of a case before it runs, and of the scene that it was made from: said by a run and by a
/// check of the set-up. Reference files are relative to `references`.
pub fn warnings(case: &Case, scene: Option<&Scene>, references: &Path) -> Vec<String> {
    let of_scene = scene.map_or_else(Vec::new, |scene| [scene.warnings(), crate::warnings::of_scene(scene)].concat());
    of_scene.into_iter().chain(checks::warnings(&case.check, references)).collect()
}

impl Job {
    /// What the run of `target` is made of, on as many threads as the command named.
    pub fn recipe(&self, target: &Target, threads: Option<usize>) -> Recipe {
        let fmus = self.case.fmu.iter().map(|fmu| (fmu.name.as_str(), fmu.path.as_path()));
        Recipe::new(&self.name, &target.set, threads, &target.references, fmus, tables())
    }

    /// What its charts show; `passes` are those of its accepted steps.
    fn wanted<'a>(&'a self, passes: &'a [(f64, f64)]) -> Wanted<'a> {
        let Case { check, output, labels, .. } = &self.case;
        Wanted { check, plot: &output.plot, labels, passes }
    }

    /// Takes what an earlier run left in the folder: the checkpoint to go on from, if the wish is to resume and there is
    /// one; else its files are removed.
    ///
    /// # Errors
    /// A complete run that is not to be overwritten, a checkpoint of other inputs, or a file that cannot be removed.
    pub fn take_folder(&self, folder: &RunFolder, wish: Wish) -> Result<Option<Checkpoint>, record::Error> {
        folder.allow(wish)?;
        let path = self.folder.join(checkpoint::FILE_NAME);
        if wish.resume && !wish.overwrite && path.is_file() {
            return Checkpoint::read(&path, &self.inputs).map(Some);
        }
        folder.clear()?;
        Ok(None)
    }

    /// Runs, then writes summary.json, plots, summary.md and report.html, then frees the participants. The error is one
    /// from before the first step, or of a summary that cannot be written; an error on the way is part of the summary.
    pub fn execute(
        &self,
        participants: Vec<Box<dyn Participant>>,
        from: Option<Checkpoint>,
        interrupted: &AtomicBool,
        progress: &mut Progress,
    ) -> Result<(Summary, Outcome), run::Error> {
        self.warnings.iter().for_each(|warning| progress.warn(warning));
        let schedule = Schedule::new(&self.folder, self.case.output.checkpoint_interval, self.inputs.clone());
        let (mut outcome, system) =
            run::run(&self.case, participants, &self.folder, schedule, from, interrupted, progress)?;
        outcome.warnings.splice(0..0, self.warnings.iter().cloned());
        progress.finish();
        let summary = self.conclude(&outcome).map_err(|error| match &outcome.error {
            // What ended the run matters more, and would be told by the summary only.
            Some(first) => {
                record::Error { reason: format!("{}; the run had ended before: {first}", error.reason), ..error }
            }
            None => error,
        })?;
        // Last: what somebody else's FMU does when it is freed must not cost the report.
        drop(system);
        Ok((summary, outcome))
    }

    /// Everything about a run that has ended. It counts as complete from the last byte on: until then the checkpoint stays,
    /// so that a kill or a full disk costs what comes after it at most.
    fn conclude(&self, outcome: &Outcome) -> Result<Summary, record::Error> {
        let charts = report::charts(&self.wanted(&outcome.counts.history), &outcome.series, &self.references);
        let mut recipe = Recipe::read(&self.folder)?;
        let summary = self.summary(outcome);
        let path = self.folder.join("summary.json");
        if let Some(recipe) = &mut recipe {
            // A run on a full disk still has its summary where that fits.
            let listed = recipe.list(&self.folder, plots(&report::stems(&charts)));
            summary.write(&path).and(listed)?;
        } else {
            summary.write(&path)?;
        }
        self.report(&summary, charts, recipe.as_ref())?;
        if self.parquet {
            record::write_parquet(&self.folder.join("results.parquet"), &outcome.series)?;
        }
        if outcome.status == Status::Complete {
            if let Some(recipe) = &mut recipe {
                recipe.end(&self.folder)?;
            }
            checkpoint::remove(&self.folder)?;
        }
        Ok(summary)
    }

    fn summary(&self, outcome: &Outcome) -> Summary {
        let frames = self.folder.join("frames");
        let context =
            Context { series: &outcome.series, frames: &frames, folder: &self.references, water: self.metadata.water };
        let checks = checks::evaluate(&self.case.check, &context);
        let outside = checks.iter().filter_map(|(name, check)| check.missed(name));
        Summary {
            scene: self.name.clone(),
            title: self.case.title.clone(),
            status: outcome.status,
            error: outcome.error.as_ref().map(ToString::to_string),
            scheme: self.metadata.scheme.clone(),
            spacing: self.metadata.spacing,
            particles: last(&outcome.series, ".particles.count"),
            steps: outcome.counts.steps,
            jumps_per_step: last(&outcome.series, ".cells.jumps")
                .map(|jumps| jumps / outcome.counts.steps.max(1) as f64),
            simulated_seconds: outcome.simulated,
            wall_seconds: outcome.wall,
            stages: outcome.stages.table(),
            coupling: outcome.coupling(&self.case),
            energy_gain: outcome.gain,
            warnings: outcome.warnings.clone(),
            missed: outcome.findings.iter().cloned().chain(outside).collect(),
            checks,
            version: env!("CARGO_PKG_VERSION").to_string(),
        }
    }

    fn report(
        &self,
        summary: &Summary,
        charts: Vec<(String, Chart)>,
        recipe: Option<&Recipe>,
    ) -> Result<(), record::Error> {
        let pictures = report::draw_all(charts, &self.folder);
        for failure in &pictures.failures {
            tell!("warning: {failure}");
        }
        let about = [("Source", self.metadata.source.as_str()), ("What differs", self.metadata.differs.as_str())];
        let text = report::markdown(summary, &about, &pictures.files, &self.folder);
        record::write_whole(&self.folder.join("summary.md"), text)?;
        let page = report::run_page(summary, &about, recipe, &pictures);
        record::write_whole(&self.folder.join("report.html"), page)?;
        // A report is whole with all its pictures: those that a full disk refused are drawn when the run is resumed.
        let unwritten = pictures.failures.iter().find(|failure| failure.unwritten);
        unwritten.map_or(Ok(()), |failure| Err(record::Error::new(failure.path.as_ref(), &failure.reason)))
    }
}

/// The last value of a count, of whichever participant gives it.
fn last(series: &Series, ending: &str) -> Option<f64> {
    let column = series.columns.iter().find(|column| column.name.ends_with(ending))?;
    column.values.last().copied()
}
