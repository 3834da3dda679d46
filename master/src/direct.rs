//! A component in process, without the C ABI: the same bits as its FMU, for tests and debugging.

use crate::log::{Level, Log};
use coupling::participant::{self, Causality, Description, Error, Kind, Outcome, Participant, Value, Variable};
use fmi::{Access, Component, Failure, Logger, Model, Snapshot, Status};
use fmi2::Instance;

/// An instance of the component `C`.
pub struct DirectParticipant<C: Component> {
    name: String,
    instance: Instance<C>,
    description: Description,
    states: Vec<Option<Snapshot<C::State>>>,
    time: f64,
}

impl<C: Component> DirectParticipant<C> {
    /// An instance of the component with this interface under the name `name`.
    pub fn new(name: &str, interface: &C::Interface, log: &Log) -> Result<Self, Error> {
        let (sink, participant) = (log.clone(), name.to_string());
        let logger = Logger::to_function(move |status, category, text| {
            let level = match status {
                Status::Ok => Level::Information,
                Status::Warning => Level::Warning,
                _ => Level::Error,
            };
            sink.write(&participant, level, category, text);
        });
        let instance =
            Instance::new(interface.clone(), None, logger).map_err(|failure| error(name, "new", 0.0, &failure))?;
        let description = describe(instance.model());
        Ok(Self { name: name.to_string(), instance, description, states: Vec::new(), time: 0.0 })
    }

    fn check<T>(&self, action: &str, result: Result<T, Failure>) -> Result<T, Error> {
        result.map_err(|failure| error(&self.name, action, self.time, &failure))
    }

    fn names(&self, references: &[u32]) -> String {
        let variables = &self.description.variables;
        let named = |reference: &u32| variables.iter().find(|variable| variable.reference == *reference);
        let names: Vec<_> = references.iter().filter_map(named).map(|variable| variable.name.as_str()).collect();
        names.join(", ")
    }
}

fn error(participant: &str, action: &str, time: f64, failure: &Failure) -> Error {
    Error::Call {
        participant: participant.to_string(),
        action: action.to_string(),
        time,
        status: fmi2::Status::from(failure.status).name().to_string(),
        message: format!(": {}", failure.message),
    }
}

fn describe<C: Component>(model: &Model<C>) -> Description {
    let unit = |simple_type: Option<&str>| {
        let known = model.types.iter().find(|simple| Some(simple.name) == simple_type);
        known.map_or_else(String::new, |simple| simple.unit.to_string())
    };
    let variable = |variable: &fmi::Variable<C>| {
        let [least, most] = participant::UNLIMITED;
        let (kind, unit, range) = match &variable.access {
            Access::Real { simple_type, minimum, maximum, .. } => {
                (Kind::Real, unit(*simple_type), [minimum.unwrap_or(least), maximum.unwrap_or(most)])
            }
            Access::Integer { minimum, maximum, .. } => {
                let range = [minimum.map_or(least, f64::from), maximum.map_or(most, f64::from)];
                (Kind::Integer, String::new(), range)
            }
            Access::Text { .. } => (Kind::String, String::new(), participant::UNLIMITED),
        };
        let causality = match variable.causality {
            fmi::Causality::Parameter => Causality::Parameter,
            fmi::Causality::Input => Causality::Input,
            fmi::Causality::Output => Causality::Output,
        };
        let (name, description) = (variable.name.clone(), variable.description.clone());
        Variable { name, reference: variable.reference, kind, causality, unit, description, range }
    };
    Description {
        variables: model.variables.iter().map(variable).collect(),
        saves_states: true,
        serialises_states: true,
        variable_step: true,
        derivatives: model.directional_derivatives,
    }
}

impl<C: Component> Participant for DirectParticipant<C> {
    fn name(&self) -> &str {
        &self.name
    }

    fn description(&self) -> &Description {
        &self.description
    }

    fn set(&mut self, variable: &Variable, value: &Value) -> Result<(), Error> {
        let reference = [variable.reference];
        let result = match (variable.kind, value) {
            (Kind::Real, Value::Real(value)) => self.instance.set_real(&reference, &[*value]),
            (Kind::Real, Value::Integer(value)) => self.instance.set_real(&reference, &[f64::from(*value)]),
            (Kind::Integer, Value::Integer(value)) => self.instance.set_integer(&reference, &[*value]),
            (Kind::String, Value::String(value)) => self.instance.set_string(&reference, &[value.as_str()]),
            _ => {
                return Err(Error::WrongType {
                    participant: self.name.clone(),
                    variable: variable.name.clone(),
                    expected: variable.kind,
                    got: value.to_string(),
                });
            }
        };
        self.check(&format!("setting '{}'", variable.name), result)
    }

    fn get(&mut self, variable: &Variable) -> Result<Value, Error> {
        let reference = [variable.reference];
        let (mut real, mut integer) = ([f64::NAN], [0]);
        let result = match variable.kind {
            Kind::Real => self.instance.get_real(&reference, &mut real).map(|()| Value::Real(real[0])),
            Kind::Integer => self.instance.get_integer(&reference, &mut integer).map(|()| Value::Integer(integer[0])),
            _ => self.instance.get_string(&reference).map(|texts| {
                let text = texts.first().map(|text| text.to_string_lossy().into_owned());
                Value::String(text.unwrap_or_default())
            }),
        };
        self.check(&format!("getting '{}'", variable.name), result)
    }

    fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), Error> {
        let result = self.instance.set_real(references, values);
        self.check(&format!("setting {}", self.names(references)), result)
    }

    fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        let result = self.instance.get_real(references, values);
        self.check(&format!("getting {}", self.names(references)), result)
    }

    fn enter_initialisation(&mut self, start: f64, stop: f64) -> Result<(), Error> {
        self.time = start;
        let result = self.instance.setup_experiment(None, start, Some(stop));
        self.check("fmi2SetupExperiment", result)?;
        let result = self.instance.enter_initialization_mode();
        self.check("fmi2EnterInitializationMode", result)
    }

    fn exit_initialisation(&mut self) -> Result<(), Error> {
        let result = self.instance.exit_initialization_mode();
        self.check("fmi2ExitInitializationMode", result)
    }

    fn step(&mut self, time: f64, duration: f64) -> Result<Outcome, Error> {
        self.time = time;
        match self.instance.do_step(time, duration) {
            Ok(()) => {
                self.time = time + duration;
                Ok(Outcome::Done)
            }
            Err(failure) => {
                let reason = format!("{}: {}", fmi2::Status::from(failure.status).name(), failure.message);
                Ok(Outcome::Refused { reason })
            }
        }
    }

    fn save(&mut self, slot: usize) -> Result<(), Error> {
        if self.states.len() <= slot {
            self.states.resize_with(slot + 1, || None);
        }
        // Into the memory of the earlier one: every pass saves.
        let result = match &mut self.states[slot] {
            Some(state) => self.instance.get_state_into(state),
            empty => self.instance.get_state().map(|state| *empty = Some(state)),
        };
        self.check("saving the state", result)
    }

    fn restore(&mut self, slot: usize) -> Result<(), Error> {
        let Some(Some(state)) = self.states.get(slot) else {
            return Err(Error::Unsupported {
                participant: self.name.clone(),
                capability: format!("a state in slot {slot}"),
                hint: "; save one first".to_string(),
            });
        };
        let result = self.instance.set_state(state);
        self.check("restoring the state", result)
    }

    fn serialise(&mut self) -> Result<Vec<u8>, Error> {
        let result = self.instance.get_state().and_then(|state| self.instance.serialize(&state));
        self.check("serialising the state", result)
    }

    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let result = self.instance.deserialize(bytes).and_then(|state| self.instance.set_state(&state));
        self.check("restoring a serialised state", result)
    }

    fn release(&mut self) -> Result<(), Error> {
        self.states.clear();
        Ok(())
    }

    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Error> {
        let result = self.instance.directional_derivative(unknowns, knowns, seed);
        let values = self.check(&format!("derivative of {}", self.names(unknowns)), result)?;
        sensitivity.copy_from_slice(&values);
        Ok(())
    }

    fn terminate(&mut self) -> Result<(), Error> {
        let result = self.instance.terminate();
        self.check("terminating", result)
    }
}
