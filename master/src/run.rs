//! One run: initialise, step to the end, record, and sum up, whatever happens on the way.

mod set_up;

pub use set_up::set_up;

use crate::case::{self, Case};
use crate::checkpoint::{Checkpoint, Schedule};
use crate::progress::Progress;
use crate::record::{self, CouplingSummary, Grid, IterationCounts, IterationWriter, ResultWriter, Series, Status};
use crate::stages::Stages;
use crate::watch::{self, Watch};
use coupling::participant::{self, Participant};
use coupling::{self, Parameters, Stepper, System};
use digits::six;
use set_up::parameters;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use thiserror::Error;

/// A run that could not start or go on.
#[derive(Debug, Error)]
pub enum Error {
    /// The case file is wrong.
    #[error(transparent)]
    Case(#[from] case::Error),
    /// An FMU cannot be loaded.
    #[error(transparent)]
    Fmu(#[from] crate::fmu::Error),
    /// A participant failed outside a step.
    #[error(transparent)]
    Participant(#[from] participant::Error),
    /// A step failed.
    #[error(transparent)]
    Coupling(#[from] coupling::Error),
    /// A file cannot be written.
    #[error(transparent)]
    Record(#[from] record::Error),
    /// Something that a key of the case asks for cannot be.
    #[error("{key}: {error}")]
    Key {
        /// Key path in the case file.
        key: String,
        /// What is wrong.
        error: Box<Error>,
    },
}

impl Error {
    /// The same error with the key of the case file that asks for it.
    fn of_key(self, key: String) -> Self {
        Self::Key { key, error: Box::new(self) }
    }
}

/// What a run gave, complete or not.
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// The error that ended it.
    pub error: Option<Error>,
    /// Recorded variables.
    pub series: Series,
    /// Iterations.
    pub counts: IterationCounts,
    /// Coupling method, as it was used at last.
    pub method: scene::Method,
    /// Wall-clock time by stage \[s\].
    pub stages: Stages,
    /// Warnings on the way.
    pub warnings: Vec<String>,
    /// What the watch found; among the warnings too.
    pub findings: Vec<String>,
    /// Largest gain of energy that nothing supplied, over the energy of the run; none where it is not known.
    pub gain: Option<f64>,
    /// Where the run stopped \[s\], from its start.
    pub simulated: f64,
    /// Wall-clock time \[s\].
    pub wall: f64,
}

impl Outcome {
    /// The coupling part of the summary.
    pub fn coupling(&self, case: &Case) -> CouplingSummary {
        CouplingSummary {
            method: if case.connection.is_empty() { "none" } else { method_name(self.method) }.to_string(),
            mean_iterations: self.counts.mean(),
            maximum_iterations: self.counts.maximum,
            rollbacks: self.counts.rollbacks,
        }
    }
}

/// The word of a method in a case file.
pub fn method_name(method: scene::Method) -> &'static str {
    match method {
        scene::Method::Auto => "auto",
        scene::Method::Explicit => "explicit",
        scene::Method::Newton => "newton",
        scene::Method::Constant => "constant",
        scene::Method::Aitken => "aitken",
        scene::Method::IqnIls => "iqn_ils",
    }
}

/// Runs a case with these participants, which are in the order of the case and bear its names. Tables go to `folder`.
/// An error before the first step is returned; a later one ends the run and is part of the outcome, and so does
/// `interrupted` turning true. Checkpoints are written as `schedule` says; with `from`, the run goes on there. The
/// participants come back terminated: freeing them is left to whoever has written down the rest.
pub fn run(
    case: &Case,
    participants: Vec<Box<dyn Participant>>,
    folder: &Path,
    schedule: Schedule,
    from: Option<Checkpoint>,
    interrupted: &AtomicBool,
    progress: &mut Progress,
) -> Result<(Outcome, System), Error> {
    let begin = Instant::now();
    let (system, warnings) = set_up(case, participants)?;
    let parameters = parameters(case, &system);
    let mut run = match from {
        None => Run::begin(case, system, &parameters, folder, schedule, begin)?,
        Some(checkpoint) => Run::resume(case, system, &parameters, folder, schedule, begin, checkpoint)?,
    };
    warnings.into_iter().for_each(|warning| run.warn(warning, progress));
    let result = run.steps(interrupted, progress);
    let (status, error) = match result {
        Ok(status) => (status, None),
        Err(error) => (Status::Failed, Some(error)),
    };
    Ok(run.finish(status, error, case.start))
}

/// Table of the coupling in a run's folder.
const ITERATIONS: &str = "iterations.csv";
/// Table of the results in a run's folder.
const RESULTS: &str = "results.csv";

struct Run {
    system: System,
    stepper: Stepper,
    /// Participant and variable that tell the longest useful step.
    step_limit: Option<(String, String)>,
    iterations: IterationWriter,
    results: ResultWriter,
    counts: IterationCounts,
    stages: Stages,
    warnings: Vec<String>,
    watch: Watch,
    schedule: Schedule,
    begin: Instant,
    /// Wall-clock time before the checkpoint that this run goes on from \[s\].
    earlier: f64,
}

impl Run {
    fn begin(
        case: &Case,
        system: System,
        parameters: &Parameters,
        folder: &Path,
        schedule: Schedule,
        begin: Instant,
    ) -> Result<Self, Error> {
        let grid = Grid { start: case.start, interval: case.output.record_interval };
        Ok(Self {
            stepper: Stepper::new(parameters, &system)?,
            iterations: IterationWriter::create(&folder.join(ITERATIONS), &system.iterated_names())?,
            results: ResultWriter::create(&folder.join(RESULTS), &system, case.recorded(), grid)?,
            step_limit: case.step_limit(),
            counts: IterationCounts::default(),
            stages: Stages::default(),
            warnings: Vec::new(),
            watch: Watch::new(&case.watch, case.reference.as_ref(), &system, watch::Memory::default()),
            schedule,
            begin,
            earlier: 0.0,
            system,
        })
    }

    fn resume(
        case: &Case,
        mut system: System,
        parameters: &Parameters,
        folder: &Path,
        schedule: Schedule,
        begin: Instant,
        from: Checkpoint,
    ) -> Result<Self, Error> {
        system.deserialise(&from.participants)?;
        let mut stepper = Stepper::new(parameters, &system)?;
        let stood = from.memory.time();
        stepper.recall(from.memory);
        if !stepper.clock().is_at(stood) {
            let end = case.run.end;
            let place = if stood > end { "beyond" } else { "within a step that is shorter or longer with" };
            let reason = format!("the checkpoint stands at {stood} s, {place} run.end = {end} s; run without --resume");
            return Err(record::Error::new(&schedule.path, reason).into());
        }
        // Said already, and among the warnings of the checkpoint.
        stepper.take_warnings();
        let grid = Grid { start: case.start, interval: case.output.record_interval };
        Ok(Self {
            stepper,
            iterations: IterationWriter::resume(&folder.join(ITERATIONS), from.iterations)?,
            results: ResultWriter::resume(&folder.join(RESULTS), &system, case.recorded(), grid, from.results)?,
            step_limit: case.step_limit(),
            counts: from.counts,
            stages: from.stages,
            warnings: from.warnings,
            watch: Watch::new(&case.watch, case.reference.as_ref(), &system, from.watch),
            schedule,
            begin,
            earlier: from.wall,
            system,
        })
    }

    /// A warning, unless it was given before.
    fn warn(&mut self, warning: String, progress: &Progress) {
        if !self.warnings.contains(&warning) {
            progress.warn(&warning);
            self.warnings.push(warning);
        }
    }

    fn steps(&mut self, interrupted: &AtomicBool, progress: &mut Progress) -> Result<Status, Error> {
        progress.begin(self.stepper.clock().time(), self.counts.steps);
        // A run that goes on has its row, or stands between two communication points, where none is due.
        if self.counts.steps == 0 {
            self.results.record(&mut self.system, self.stepper.clock().time(), true)?;
            self.look(progress)?;
        }
        while !self.stepper.clock().finished() {
            if interrupted.load(Ordering::Relaxed) {
                // Before the row that an uninterrupted run would not have.
                self.write_checkpoint(progress);
                self.results.record(&mut self.system, self.stepper.clock().time(), true)?;
                return Ok(Status::Interrupted);
            }
            let start = Instant::now();
            if let Some((participant, variable)) = &self.step_limit {
                self.stepper.limit(self.system.read(participant, variable, self.stepper.clock().time())?);
            }
            let iterations = &mut self.iterations;
            let result = self.stepper.advance(&mut self.system, &mut |row| iterations.write(row));
            self.stages.advancing += start.elapsed().as_secs_f64();
            let warnings = self.stepper.take_warnings();
            warnings.iter().for_each(|warning| progress.warn(warning));
            self.warnings.extend(warnings);
            let report = result?;
            self.counts.add(&report);
            self.record()?;
            self.look(progress)?;
            progress.update(self.stepper.clock().time(), &self.counts);
            // None at the end: its row need not be one of a run that goes on to a later end.
            if self.schedule.due() && !self.stepper.clock().finished() {
                self.write_checkpoint(progress);
            }
        }
        Ok(Status::Complete)
    }

    /// What the watch finds at a communication point is told at once.
    fn look(&mut self, progress: &Progress) -> Result<(), Error> {
        let clock = self.stepper.clock();
        if clock.point().is_none() && !clock.finished() {
            return Ok(());
        }
        let start = Instant::now();
        let found = self.watch.look(&mut self.system, clock.time())?;
        self.stages.recording += start.elapsed().as_secs_f64();
        found.into_iter().for_each(|finding| self.warn(finding, progress));
        Ok(())
    }

    /// A run goes on without its checkpoint, but the user must know.
    fn write_checkpoint(&mut self, progress: &Progress) {
        if self.schedule.interval <= 0.0 || !self.system.serialises() {
            return;
        }
        let start = Instant::now();
        let written = self.checkpoint().and_then(|checkpoint| Ok(checkpoint.write(&self.schedule.path)?));
        if let Err(error) = written {
            let warning = format!("no checkpoint at t = {} s: {error}", six(self.stepper.clock().time()));
            progress.warn(&warning);
            self.warnings.push(warning);
        }
        self.stages.recording += start.elapsed().as_secs_f64();
        self.schedule.done();
    }

    fn checkpoint(&mut self) -> Result<Checkpoint, Error> {
        self.iterations.check()?;
        let mut stages = self.stages.clone();
        stages.collect(&mut self.system);
        Ok(Checkpoint {
            program: env!("CARGO_PKG_VERSION").to_string(),
            inputs: self.schedule.inputs.clone(),
            participants: self.system.serialise()?,
            memory: self.stepper.memory().clone(),
            results: self.results.mark()?,
            iterations: self.iterations.mark()?,
            counts: self.counts.clone(),
            stages,
            warnings: self.warnings.clone(),
            watch: self.watch.memory().clone(),
            wall: self.wall(),
        })
    }

    fn wall(&self) -> f64 {
        self.earlier + self.begin.elapsed().as_secs_f64()
    }

    fn record(&mut self) -> Result<(), Error> {
        let clock = self.stepper.clock();
        let start = Instant::now();
        self.results.gather(&mut self.system, clock.time())?;
        if clock.point().is_some() {
            self.results.record(&mut self.system, clock.time(), clock.finished())?;
            self.iterations.check()?;
        }
        self.stages.recording += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn finish(mut self, status: Status, error: Option<Error>, start: f64) -> (Outcome, System) {
        let flushed = self.iterations.check().map_err(Error::from);
        let ended = self.system.terminate().map_err(Error::from);
        self.stages.collect(&mut self.system);
        // A failure to end a participant matters only when nothing else failed.
        let late = flushed.and(ended).err();
        let status = if late.is_some() && status == Status::Complete { Status::Failed } else { status };
        let wall = self.wall();
        let outcome = Outcome {
            status,
            error: error.or(late),
            simulated: self.stepper.clock().time() - start,
            series: self.results.series().clone(),
            counts: self.counts,
            method: self.stepper.method(),
            stages: self.stages,
            warnings: self.warnings,
            findings: self.watch.memory().findings(),
            gain: self.watch.gain(),
            wall,
        };
        (outcome, self.system)
    }
}
