//! From a case and its participants to a system that is initialised: start values, connections, and what is odd about them.

use super::Error;
use crate::case::{self, Case};
use crate::record;
use coupling::participant::{self, Kind, Participant, Value};
use coupling::{self, Connection, Parameters, Stepper, System};
use digits::six;

/// A participant whose steps must all have the same length.
fn fixed_step(system: &System) -> Option<&str> {
    system.descriptions().find(|(_, description)| !description.variable_step).map(|(name, _)| name)
}

pub(super) fn parameters(case: &Case, system: &System) -> Parameters {
    let (start, end, asked) = (case.start, case.run.end, case.run.communication_step);
    let connections = case.connection.iter();
    let tolerances = connections.filter_map(|link| Some((link.from.clone(), link.tolerance_absolute?))).collect();
    Parameters {
        coupling: case.coupling.clone(),
        start,
        end,
        step: if fixed_step(system).is_some() { coupling::even_step(start, end, asked) } else { asked },
        tolerances,
    }
}

/// All that comes before the first step, and what a user should know then: what this refuses, a run refuses. The
/// participants are in the order of the case and bear its names.
///
/// # Errors
/// A parameter, connection, step limit or start that cannot be, with its key in the case file.
pub fn set_up(case: &Case, participants: Vec<Box<dyn Participant>>) -> Result<(System, Vec<String>), Error> {
    let mut system = prepare(case, participants)?;
    system.initialise(case.start, case.run.end)?;
    let parameters = parameters(case, &system);
    Stepper::new(&parameters, &system)?;
    if let Some((participant, variable)) = case.step_limit() {
        let read = system.read(&participant, &variable, case.start);
        read.map_err(|error| Error::from(error).of_key("step_limit".to_string()))?;
    }
    let mut warnings = missing_variables(case, &system);
    warnings.extend(another_step(case, &system, parameters.step));
    Ok((system, warnings))
}

/// Checks and plots of variables that no participant gives would be noticed at the end only.
fn missing_variables(case: &Case, system: &System) -> Vec<String> {
    let columns = record::recorded(system, &case.exclude);
    let names = || columns.iter().flatten().map(|(name, _)| name.as_str());
    let checks = case.check.iter().filter(|check| !check.variable.is_empty());
    let checks = checks.map(|check| (format!("check '{}'", check.name), &check.variable));
    let plots = case.output.plot.iter().map(|variable| ("output.plot".to_string(), variable));
    let missing = checks.chain(plots).filter(|(_, variable)| !names().any(|name| name == *variable));
    missing
        .map(|(place, variable)| {
            let near = scene::nearest(variable, names());
            let hint = near.map_or_else(String::new, |name| format!("; the nearest name is '{name}'"));
            format!("{place}: this run has no variable '{variable}'{hint}")
        })
        .collect()
}

/// What to say where another step is taken than the one asked for \[s\].
fn another_step(case: &Case, system: &System, step: f64) -> Option<String> {
    let (start, end, asked) = (case.start, case.run.end, case.run.communication_step);
    let name = fixed_step(system).filter(|_| step != asked)?;
    Some(format!(
        "run.end = {}: no multiple of run.communication_step = {} s from the start at {} s, and {name} knows steps of one \
         length only: the step is {} s",
        six(end),
        six(asked),
        six(start),
        six(step)
    ))
}

/// Sets parameters and connects.
fn prepare(case: &Case, mut participants: Vec<Box<dyn Participant>>) -> Result<System, Error> {
    for (index, (participant, fmu)) in participants.iter_mut().zip(&case.fmu).enumerate() {
        for (name, value) in &fmu.parameters {
            set(participant.as_mut(), name, value)
                .map_err(|error| Error::from(error).of_key(format!("fmu.{index}.parameters.{name}")))?;
        }
    }
    let ends = case.ends().map_err(|(key, got)| case::Error::Range {
        name: case.title.clone(),
        key,
        got,
        expected: "fmu.variable".to_string(),
    })?;
    let mut system = System::new(participants, &[])?;
    for (index, (from, to)) in ends.into_iter().enumerate() {
        let made = system.connect(&Connection { from, to });
        made.map_err(|error| Error::from(error).of_key(format!("connection.{index}")))?;
    }
    Ok(system)
}

/// Sets a parameter that a case file gives.
fn set(participant: &mut dyn Participant, name: &str, given: &toml::Value) -> Result<(), participant::Error> {
    let variable = participant.description().variable(participant.name(), name)?.clone();
    let value = typed(given, variable.kind).ok_or_else(|| participant::Error::WrongType {
        participant: participant.name().to_string(),
        variable: name.to_string(),
        expected: variable.kind,
        got: given.to_string(),
    })?;
    variable.allow(participant.name(), &value)?;
    participant.set(&variable, &value)
}

/// A value of a case file for a variable of this type. Any whole number will do for a real variable; only one of 32 bits
/// does for an integer.
fn typed(value: &toml::Value, kind: Kind) -> Option<Value> {
    match value {
        toml::Value::Float(value) => Some(Value::Real(*value)),
        toml::Value::Integer(value) if kind == Kind::Real => Some(Value::Real(*value as f64)),
        toml::Value::Integer(value) => i32::try_from(*value).ok().map(Value::Integer),
        toml::Value::Boolean(value) => Some(Value::Boolean(*value)),
        toml::Value::String(value) => Some(Value::String(value.clone())),
        _ => None,
    }
}
