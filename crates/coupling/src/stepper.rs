//! The implicit step: guess, pass, compare, accelerate; halve the step when that does not converge.

use crate::{Accelerator, Clock, Error, IqnIls, Pass, Predictor, Residual, Stall, System, Tolerance};
use digits::six;
use scene::Method;
use serde::{Deserialize, Serialize};

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

/// What a stepper carries from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    clock: Clock,
    predictor: Predictor,
    accelerator: Option<Accelerator>,
    method: Method,
    /// Largest factor by which an explicit exchange multiplies errors from step to step, where it is known.
    amplification: f64,
}

impl Memory {
    /// Where it stands \[s\].
    pub fn time(&self) -> f64 {
        self.clock.time()
    }
}

/// Below this step an attempt that fails is not halved again.
fn smallest_step(parameters: &Parameters, system: &System) -> f64 {
    let variable = system.descriptions().all(|(_, description)| description.variable_step);
    match parameters.coupling.smallest_step {
        _ if !variable => parameters.step,
        smallest if smallest > 0.0 => smallest,
        _ => parameters.step / 64.0,
    }
}

/// What to say where a participant saves no states.
fn warn_of_states(system: &System) -> Option<String> {
    let (name, _) = system.descriptions().find(|(_, description)| !description.saves_states)?;
    Some(format!(
        "{name} saves no states, so steps cannot be repeated: the exchange is explicit and stable only while the \
         participants answer to each other weakly"
    ))
}

/// Drives a system through its run, one accepted step at a time.
pub struct Stepper {
    memory: Memory,
    names: Vec<String>,
    tolerances: Vec<Tolerance>,
    maximum_iterations: usize,
    /// What `iqn_ils` needs in case that it has to take over.
    relaxation: f64,
    reused_steps: usize,
    /// Things that a user should know, each said once.
    warnings: Vec<String>,
}

impl Stepper {
    /// For an initialised system. Implicit methods need participants that save states.
    pub fn new(parameters: &Parameters, system: &System) -> Result<Self, Error> {
        let coupling = &parameters.coupling;
        let names = system.iterated_names();
        let method = resolve(coupling.method, system)?;
        let mut accelerator = Accelerator::new(method, coupling.relaxation, coupling.reused_steps);
        if names.is_empty() {
            accelerator = None;
        }
        if accelerator.is_some() {
            require_states(system)?;
        }
        let absolute = |name: &String| {
            let own = parameters.tolerances.iter().find(|(known, _)| known == name);
            own.map_or(coupling.tolerance_absolute, |(_, tolerance)| *tolerance)
        };
        let tolerance = |name| Tolerance { relative: coupling.tolerance_relative, absolute: absolute(name) };
        let explicit = coupling.method == Method::Auto && !names.is_empty();
        let warnings = if explicit { warn_of_states(system).into_iter().collect() } else { Vec::new() };
        let smallest = smallest_step(parameters, system);
        let order = coupling.predictor_order.unwrap_or(usize::from(accelerator.is_some()));
        let memory = Memory {
            clock: Clock::new(parameters.start, parameters.end, parameters.step, smallest),
            predictor: Predictor::new(order, system.produced()),
            accelerator,
            method,
            amplification: 0.0,
        };
        Ok(Self {
            memory,
            tolerances: names.iter().map(tolerance).collect(),
            names,
            maximum_iterations: coupling.maximum_iterations.max(1),
            relaxation: coupling.relaxation,
            reused_steps: coupling.reused_steps,
            warnings,
        })
    }

    /// The method in use.
    pub fn method(&self) -> Method {
        self.memory.method
    }

    /// What it carries from step to step.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Goes on where another stepper of the same parameters stood; the end of the run may be another.
    pub fn recall(&mut self, memory: Memory) {
        let own = std::mem::replace(&mut self.memory, memory).clock;
        self.memory.clock.end_with(&own);
    }

    /// What a user should know and was not told yet.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Where the run stands.
    pub fn clock(&self) -> &Clock {
        &self.memory.clock
    }

    /// Keeps the next steps no longer than `longest` \[s\], as far as the smallest step allows.
    pub fn limit(&mut self, longest: f64) {
        self.memory.clock.limit(longest);
    }

    /// Makes one accepted step, which may be shorter than the communication step. Iterations are handed to `record`
    /// as they happen.
    pub fn advance(&mut self, system: &mut System, record: &mut dyn FnMut(&IterationRow)) -> Result<StepReport, Error> {
        let mut rollbacks = 0;
        loop {
            let (time, duration) = (self.memory.clock.time(), self.memory.clock.duration());
            let failure = match self.attempt(system, time, duration, record)? {
                Ok(iterations) => {
                    self.memory.clock.advance();
                    return Ok(StepReport { time, duration, iterations, rollbacks });
                }
                Err(failure) => failure,
            };
            let Some(accelerator) = &mut self.memory.accelerator else {
                return Err(failure.at(time, duration).explained(self.memory.amplification));
            };
            accelerator.reject();
            system.restore()?;
            if !self.memory.clock.halve() {
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
        let guess = self.memory.predictor.predict(time, duration);
        let Some(accelerator) = &mut self.memory.accelerator else {
            let pass =
                system.pass(time, duration, &guess).map_err(|error| error.explained(self.memory.amplification))?;
            self.memory.predictor.accept(time, duration, &system.produced());
            self.watch_amplification(system, time)?;
            return Ok(Failure::check(pass).map(|()| 1));
        };
        system.save()?;
        accelerator.start_step();
        self.iterate(system, time, duration, guess, record)
    }

    /// Passes until the iterated quantities agree, from the saved state.
    fn iterate(
        &mut self,
        system: &mut System,
        time: f64,
        duration: f64,
        mut guess: Vec<f64>,
        record: &mut dyn FnMut(&IterationRow),
    ) -> Result<Result<usize, Failure>, Error> {
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
                if let Some(accelerator) = &mut self.memory.accelerator {
                    accelerator.accept(&guess, &produced);
                }
                self.memory.predictor.accept(time, duration, &produced);
                return Ok(Ok(iteration));
            }
            self.supply_jacobian(system, time, &guess, &produced)?;
            let Some(accelerator) = &mut self.memory.accelerator else { return Ok(Ok(iteration)) };
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

impl Stepper {
    /// Gives Newton's method the Jacobian of the pass that was just made. A Jacobian that foretells wrongly is not
    /// used: `iqn_ils` takes over.
    fn supply_jacobian(&mut self, system: &mut System, time: f64, used: &[f64], produced: &[f64]) -> Result<(), Error> {
        let Some(Accelerator::Newton(newton)) = &mut self.memory.accelerator else { return Ok(()) };
        if let Some(missed) = newton.missed(used, produced) {
            self.warnings.push(format!(
                "at t = {} s the directional derivatives missed {:.0} % of the first change of the exchanged \
                 quantities, expected at most 20 %; iqn_ils takes over from newton",
                six(time),
                100.0 * missed
            ));
            self.memory.method = Method::IqnIls;
            self.memory.accelerator = Some(Accelerator::IqnIls(IqnIls::new(self.relaxation, self.reused_steps)));
        } else if newton.needs_jacobian() {
            newton.set_jacobian(system.jacobian(time)?);
        }
        Ok(())
    }

    /// An explicit exchange multiplies errors by the eigenvalues of dQ~/dQ in every step.
    fn watch_amplification(&mut self, system: &mut System, time: f64) -> Result<(), Error> {
        if self.names.is_empty() || !gives_derivatives(system) {
            return Ok(());
        }
        let eigenvalues = system.jacobian(time)?.complex_eigenvalues();
        let radius = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        if radius > 1.0 && self.memory.amplification <= 1.0 {
            self.warnings.push(format!("at t = {} s {}", six(time), amplified(radius)));
        }
        self.memory.amplification = self.memory.amplification.max(radius);
        Ok(())
    }
}

/// What an amplification above 1 means.
fn amplified(radius: f64) -> String {
    format!(
        "the explicit exchange multiplies errors by up to {radius:.3} per step, expected at most 1: the load answers to \
         the acceleration more strongly than the structure's own mass; use coupling.method 'newton' or 'iqn_ils', or \
         coupling.added_mass = true"
    )
}

impl Error {
    /// The same error with its likely cause.
    fn explained(self, amplification: f64) -> Self {
        if amplification > 1.0 {
            Self::Explained { cause: amplified(amplification), error: Box::new(self) }
        } else {
            self
        }
    }
}

fn gives_derivatives(system: &System) -> bool {
    system.descriptions().all(|(_, description)| description.derivatives)
}

/// `auto` stands for `newton` where all participants give derivatives, for `explicit` where one saves no states, and
/// else for `iqn_ils`.
fn resolve(method: Method, system: &System) -> Result<Method, Error> {
    let stateless = system.descriptions().any(|(_, description)| !description.saves_states);
    let without = system.descriptions().find(|(_, description)| !description.derivatives);
    match (method, without) {
        (Method::Auto, _) if stateless => Ok(Method::Explicit),
        (Method::Auto, None) => Ok(Method::Newton),
        (Method::Auto, Some(_)) => Ok(Method::IqnIls),
        (Method::Newton, Some((name, _))) => Err(Error::Participant(crate::participant::Error::Unsupported {
            participant: name.to_string(),
            capability: "giving directional derivatives".to_string(),
            hint: "; use the coupling method 'iqn_ils'".to_string(),
        })),
        (method, _) => Ok(method),
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
