//! A run with everything around it: the case, where its files go, and the report afterwards.

use crate::case::Case;
use crate::checkpoint::{self, Checkpoint, Schedule};
use crate::checks::{self, Context};
use crate::participant::Participant;
use crate::progress::Progress;
use crate::record::{self, Series, Status, Summary};
use crate::report;
use crate::run::{self, Outcome};
use crate::tell;
use scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// What a scene tells the report beyond its case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Facts {
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
    /// What a user should know before the run.
    pub warnings: Vec<String>,
}

impl Facts {
    /// The facts of a scene.
    pub fn of(scene: &Scene) -> Self {
        let fluid = scene.fluid.as_ref();
        let gravity = scene.gravity[0].hypot(scene.gravity[1]);
        Self {
            scheme: fluid.map(|fluid| fluid.scheme.name().to_string()),
            spacing: fluid.map(|fluid| fluid.spacing),
            water: fluid.map(|fluid| (fluid.density, gravity)),
            source: scene.source.clone(),
            differs: scene.differs.clone(),
            warnings: crate::warnings::of_scene(scene),
        }
    }
}

/// Files of a run's folder that a new run there removes.
const OWN_FILES: [&str; 11] = [
    "results.csv",
    "results.parquet",
    "iterations.csv",
    "summary.json",
    "summary.md",
    "report.html",
    "log.txt",
    "scene.toml",
    "run.json",
    "checkpoint.bin",
    "checkpoint.part",
];

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
    pub facts: Facts,
    /// All that decides its numbers, as text: a run is resumed with the same inputs only.
    pub inputs: String,
}

impl Job {
    /// Makes the folder and removes what an earlier run left there; with `resume`, a run that left a checkpoint goes
    /// on.
    pub fn prepare_folder(&self, resume: bool) -> Result<Option<Checkpoint>, record::Error> {
        let wrong = |error: std::io::Error| record::Error::new(&self.folder, error);
        std::fs::create_dir_all(&self.folder).map_err(wrong)?;
        let path = self.folder.join(checkpoint::FILE_NAME);
        if resume && path.is_file() {
            return Checkpoint::read(&path, &self.inputs).map(Some);
        }
        for name in OWN_FILES {
            let path = self.folder.join(name);
            if path.is_file() {
                std::fs::remove_file(path).map_err(wrong)?;
            }
        }
        for name in ["frames", "plots"] {
            remove_files(&self.folder.join(name)).map_err(wrong)?;
        }
        Ok(None)
    }

    /// Runs, then writes summary.json, plots and summary.md. The error is one from before the first step, or of a
    /// summary that cannot be written; an error on the way is part of the summary.
    pub fn execute(
        &self,
        participants: Vec<Box<dyn Participant>>,
        from: Option<Checkpoint>,
        interrupted: &AtomicBool,
        progress: &mut Progress,
    ) -> Result<(Summary, Outcome), run::Error> {
        let schedule = Schedule::new(&self.folder, self.case.output.checkpoint_interval, self.inputs.clone());
        self.facts.warnings.iter().for_each(|warning| progress.warn(warning));
        let mut outcome = run::run(&self.case, participants, &self.folder, schedule, from, interrupted, progress)?;
        outcome.warnings.splice(0..0, self.facts.warnings.iter().cloned());
        progress.finish();
        let summary = self.summary(&outcome);
        summary.write(&self.folder.join("summary.json")).map_err(|error| match &outcome.error {
            // What ended the run matters more, and would be told by the summary only.
            Some(first) => {
                record::Error { reason: format!("{}; the run had ended before: {first}", error.reason), ..error }
            }
            None => error,
        })?;
        self.report(&summary, &outcome)?;
        // Last: when a full disk takes the summary or the page, the run need not be done again.
        let path = self.folder.join(checkpoint::FILE_NAME);
        if outcome.status == Status::Complete && path.is_file() {
            std::fs::remove_file(&path).map_err(|error| record::Error::new(&path, error))?;
        }
        Ok((summary, outcome))
    }

    fn summary(&self, outcome: &Outcome) -> Summary {
        let frames = self.folder.join("frames");
        let context =
            Context { series: &outcome.series, frames: &frames, folder: &self.references, water: self.facts.water };
        let checks = checks::evaluate(&self.case.check, &context);
        let outside = checks.iter().filter_map(|(name, check)| check.missed(name));
        Summary {
            scene: self.name.clone(),
            title: self.case.title.clone(),
            status: outcome.status,
            error: outcome.error.as_ref().map(ToString::to_string),
            scheme: self.facts.scheme.clone(),
            spacing: self.facts.spacing,
            particles: particles(&outcome.series),
            steps: outcome.counts.steps,
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

    fn report(&self, summary: &Summary, outcome: &Outcome) -> Result<(), record::Error> {
        let pictures = report::draw_all(&self.case, &outcome.series, &outcome.counts, &self.folder, &self.references);
        for failure in &pictures.failures {
            tell!("warning: {failure}");
        }
        let about = [("Source", self.facts.source.as_str()), ("What differs", self.facts.differs.as_str())];
        let text = report::markdown(summary, &about, &pictures.files, &self.folder);
        let path = self.folder.join("summary.md");
        record::write_whole(&path, text)?;
        let path = self.folder.join("report.html");
        let recipe = record::Recipe::read(&self.folder)?;
        let page = report::run_page(summary, &about, recipe.as_ref(), &pictures);
        record::write_whole(&path, page)
    }
}

/// The last number of particles, of whichever participant counts them.
fn particles(series: &Series) -> Option<f64> {
    let column = series.columns.iter().find(|column| column.name.ends_with(".particles.count"))?;
    column.values.last().copied()
}

/// Removes the files of a folder that this program writes; other files and folders stay.
fn remove_files(folder: &Path) -> std::io::Result<()> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
    for entry in entries {
        let path = entry?.path();
        let ours = ["vtu", "pvd", "svg", "png", "part"];
        if path.extension().is_some_and(|extension| ours.iter().any(|known| extension == *known)) {
            std::fs::remove_file(path)?;
        }
    }
    Ok(())
}
