//! One run: initialise, step to the end, record, and sum up, whatever happens on the way.

use crate::case::{self, Case};
use crate::coupling::{self, Connection, Parameters, Stepper, System};
use crate::participant::{self, Participant, Value};
use crate::progress::Progress;
use crate::record::{self, CouplingSummary, IterationCounts, IterationWriter, ResultWriter, Series, Status};
use crate::stages::Stages;
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
/// `interrupted` turning true.
pub fn run(
    case: &Case,
    participants: Vec<Box<dyn Participant>>,
    folder: &Path,
    interrupted: &AtomicBool,
    progress: &mut Progress,
) -> Result<Outcome, Error> {
    let begin = Instant::now();
    let mut system = prepare(case, participants)?;
    let parameters = parameters(case);
    let steps = coupling::steps_between(case.start, case.run.end, case.run.communication_step);
    system.initialise(case.start, case.start + steps as f64 * case.run.communication_step)?;
    let stepper = Stepper::new(&parameters, &system)?;
    let iterations = IterationWriter::create(&folder.join("iterations.csv"), &system.iterated_names())?;
    let results =
        ResultWriter::create(&folder.join("results.csv"), &system, &case.exclude, case.output.record_interval)?;
    let (counts, stages) = (IterationCounts::default(), Stages::default());
    let step_limit = case.step_limit();
    let mut run = Run { system, stepper, step_limit, iterations, results, counts, stages, warnings: Vec::new() };
    let result = run.steps(interrupted, progress);
    let (status, error) = match result {
        Ok(status) => (status, None),
        Err(error) => (Status::Failed, Some(error)),
    };
    Ok(run.finish(status, error, case.start, begin))
}

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
}

impl Run {
    fn steps(&mut self, interrupted: &AtomicBool, progress: &mut Progress) -> Result<Status, Error> {
        self.results.record(&mut self.system, self.stepper.clock().time(), true)?;
        while !self.stepper.clock().finished() {
            if interrupted.load(Ordering::Relaxed) {
                self.results.record(&mut self.system, self.stepper.clock().time(), true)?;
                return Ok(Status::Interrupted);
            }
            let start = Instant::now();
            if let Some((participant, variable)) = &self.step_limit {
                self.stepper.limit(self.system.read(participant, variable)?);
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
            progress.update(self.stepper.clock().time(), self.counts.mean());
        }
        Ok(Status::Complete)
    }

    fn record(&mut self) -> Result<(), Error> {
        let clock = self.stepper.clock();
        let start = Instant::now();
        if clock.point().is_some() {
            self.results.record(&mut self.system, clock.time(), clock.finished())?;
            self.iterations.check()?;
        }
        self.stages.recording += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn finish(mut self, status: Status, error: Option<Error>, start: f64, begin: Instant) -> Outcome {
        let flushed = self.iterations.check().map_err(Error::from);
        let ended = self.system.terminate().map_err(Error::from);
        self.stages.collect(&mut self.system);
        // A failure to end a participant matters only when nothing else failed.
        let late = flushed.and(ended).err();
        let status = if late.is_some() && status == Status::Complete { Status::Failed } else { status };
        Outcome {
            status,
            error: error.or(late),
            simulated: self.stepper.clock().time() - start,
            series: self.results.series().clone(),
            counts: self.counts,
            method: self.stepper.method(),
            stages: self.stages,
            warnings: self.warnings,
            wall: begin.elapsed().as_secs_f64(),
        }
    }
}

fn parameters(case: &Case) -> Parameters {
    let connections = case.connection.iter();
    let tolerances = connections.filter_map(|link| Some((link.from.clone(), link.tolerance_absolute?))).collect();
    Parameters {
        coupling: case.coupling.clone(),
        start: case.start,
        end: case.run.end,
        step: case.run.communication_step,
        tolerances,
    }
}

/// Sets parameters and connects.
fn prepare(case: &Case, mut participants: Vec<Box<dyn Participant>>) -> Result<System, Error> {
    for (participant, fmu) in participants.iter_mut().zip(&case.fmu) {
        for (name, value) in &fmu.parameters {
            let variable = participant.description().variable(participant.name(), name)?.clone();
            let value = typed(value).ok_or_else(|| participant::Error::WrongType {
                participant: participant.name().to_string(),
                variable: name.clone(),
                expected: variable.kind,
                got: value.to_string(),
            })?;
            participant.set(&variable, &value)?;
        }
    }
    let ends = case.ends().map_err(|(key, got)| case::Error::Range {
        name: case.title.clone(),
        key,
        got,
        expected: "fmu.variable".to_string(),
    })?;
    let connections: Vec<Connection> = ends.into_iter().map(|(from, to)| Connection { from, to }).collect();
    Ok(System::new(participants, &connections)?)
}

fn typed(value: &toml::Value) -> Option<Value> {
    match value {
        toml::Value::Float(value) => Some(Value::Real(*value)),
        toml::Value::Integer(value) => i32::try_from(*value).ok().map(Value::Integer),
        toml::Value::Boolean(value) => Some(Value::Boolean(*value)),
        toml::Value::String(value) => Some(Value::String(value.clone())),
        _ => None,
    }
}
