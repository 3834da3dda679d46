//! The implicit step: guess, pass, compare, accelerate; halve the step when that does not converge.

use super::{Accelerator, Clock, Error, Pass, Predictor, Residual, Stall, System, Tolerance};

/// How steps are coupled. Validated by [`scene::Coupling`].
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Method and its numbers.
    pub coupling: scene::Coupling,
    /// Start of the run \[s\].
    pub start: f64,
    /// End of the run \[s\].
    pub end: f64,
    /// Communication step \[s\].
    pub step: f64,
    /// Absolute tolerances of single quantities by name, `participant.variable`, in place of the common one.
    pub tolerances: Vec<(String, f64)>,
}

/// One iteration of one step.
#[derive(Debug, Clone, PartialEq)]
pub struct IterationRow {
    /// Start of the step \[s\].
    pub time: f64,
    /// Its duration \[s\].
    pub duration: f64,
    /// Number within the step, from 1.
    pub iteration: usize,
    /// Whether all quantities were within tolerance.
    pub converged: bool,
    /// One entry per iterated quantity.
    pub residuals: Vec<Residual>,
}

/// What happened until a step was accepted.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReport {
    /// Start of the accepted step \[s\].
    pub time: f64,
    /// Its duration \[s\].
    pub duration: f64,
    /// Passes of the accepted step.
    pub iterations: usize,
    /// Attempts given up before it.
    pub rollbacks: usize,
}

/// Why an attempt was given up.
enum Failure {
    NotConverged { iterations: usize, residuals: Vec<Residual> },
    Refused { participant: String, reason: String },
}

/// Drives a system through its run, one accepted step at a time.
pub struct Stepper {
    clock: Clock,
    predictor: Predictor,
    accelerator: Option<Accelerator>,
    names: Vec<String>,
    tolerances: Vec<Tolerance>,
    maximum_iterations: usize,
}

impl Stepper {
    /// For an initialised system. Implicit methods need participants that save states.
    pub fn new(parameters: &Parameters, system: &System) -> Result<Self, Error> {
        let coupling = &parameters.coupling;
        let names = system.iterated_names();
        let mut accelerator = Accelerator::new(coupling.method, coupling.relaxation, coupling.reused_steps);
        if names.is_empty() {
            accelerator = None;
        }
        if accelerator.is_some() {
            require_states(system)?;
        }
        let variable = system.descriptions().all(|(_, description)| description.variable_step);
        let smallest = match coupling.smallest_step {
            _ if !variable => parameters.step,
            smallest if smallest > 0.0 => smallest,
            _ => parameters.step / 64.0,
        };
        let absolute = |name: &String| {
            let own = parameters.tolerances.iter().find(|(known, _)| known == name);
            own.map_or(coupling.tolerance_absolute, |(_, tolerance)| *tolerance)
        };
        let tolerance = |name| Tolerance { relative: coupling.tolerance_relative, absolute: absolute(name) };
        Ok(Self {
            clock: Clock::new(parameters.start, parameters.end, parameters.step, smallest),
            predictor: Predictor::new(coupling.predictor_order, system.produced()),
            accelerator,
            tolerances: names.iter().map(tolerance).collect(),
            names,
            maximum_iterations: coupling.maximum_iterations.max(1),
        })
    }

    /// Where the run stands.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Keeps the next steps no longer than `longest` \[s\], as far as the smallest step allows.
    pub fn limit(&mut self, longest: f64) {
        self.clock.limit(longest);
    }

    /// Makes one accepted step, which may be shorter than the communication step. Iterations are handed to `record`
    /// as they happen.
    pub fn advance(&mut self, system: &mut System, record: &mut dyn FnMut(&IterationRow)) -> Result<StepReport, Error> {
        let mut rollbacks = 0;
        loop {
            let (time, duration) = (self.clock.time(), self.clock.duration());
            let failure = match self.attempt(system, time, duration, record)? {
                Ok(iterations) => {
                    self.clock.advance();
                    return Ok(StepReport { time, duration, iterations, rollbacks });
                }
                Err(failure) => failure,
            };
            let Some(accelerator) = &mut self.accelerator else { return Err(failure.at(time, duration)) };
            accelerator.reject();
            system.restore()?;
            if !self.clock.halve() {
                return Err(failure.at(time, duration));
            }
            rollbacks += 1;
        }
    }

    fn attempt(
        &mut self,
        system: &mut System,
        time: f64,
        duration: f64,
        record: &mut dyn FnMut(&IterationRow),
    ) -> Result<Result<usize, Failure>, Error> {
        let mut guess = self.predictor.predict(time, duration);
        let Some(accelerator) = &mut self.accelerator else {
            let pass = Failure::check(system.pass(time, duration, &guess)?);
            self.predictor.accept(time, duration, &system.produced());
            return Ok(pass.map(|()| 1));
        };
        system.save()?;
        accelerator.start_step();
        let mut iteration = 1;
        let mut stall = Stall::default();
        loop {
            if let Err(failure) = Failure::check(system.pass(time, duration, &guess)?) {
                return Ok(Err(failure));
            }
            let produced = system.produced();
            let residuals = compare(&self.names, &self.tolerances, &guess, &produced);
            let converged = residuals.iter().all(Residual::converged);
            let row = IterationRow { time, duration, iteration, converged, residuals };
            record(&row);
            if converged {
                accelerator.accept(&guess, &produced);
                self.predictor.accept(time, duration, &produced);
                return Ok(Ok(iteration));
            }
            let stalled = accelerator.is_quasi_newton() && stall.update(iteration, &row.residuals);
            if stalled || iteration >= self.maximum_iterations {
                return Ok(Err(Failure::NotConverged { iterations: iteration, residuals: row.residuals }));
            }
            guess = accelerator.next(&guess, &produced);
            system.restore()?;
            iteration += 1;
        }
    }
}

fn compare(names: &[String], tolerances: &[Tolerance], used: &[f64], produced: &[f64]) -> Vec<Residual> {
    let values = names.iter().zip(tolerances).zip(used.iter().zip(produced));
    values.map(|((name, tolerance), (used, produced))| Residual::new(name, *used, *produced, *tolerance)).collect()
}

fn require_states(system: &System) -> Result<(), Error> {
    match system.descriptions().find(|(_, description)| !description.saves_states) {
        None => Ok(()),
        Some((name, _)) => Err(Error::Participant(crate::participant::Error::Unsupported {
            participant: name.to_string(),
            capability: "saving and restoring states".to_string(),
            hint: "; use the coupling method 'explicit'".to_string(),
        })),
    }
}

impl Failure {
    fn check(pass: Pass) -> Result<(), Self> {
        match pass {
            Pass::Done => Ok(()),
            Pass::Refused { participant, reason } => Err(Self::Refused { participant, reason }),
        }
    }

    fn at(self, time: f64, duration: f64) -> Error {
        match self {
            Self::NotConverged { iterations, residuals } => {
                Error::NotConverged { time, duration, iterations, residuals }
            }
            Self::Refused { participant, reason } => Error::StepRefused { time, duration, participant, reason },
        }
    }
}
