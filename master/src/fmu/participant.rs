//! An FMU as a participant.

use super::abi;
use super::library::{ByteFunctions, StateFunctions};
use super::logger::Environment;
use super::watch::{Inside, Watched};
use super::{Archive, Error as FmuError, Library, Model};
use crate::case::Limits;
use crate::log::Log;
use coupling::participant::{Description, Error, Kind, Outcome, Participant, Value, Variable};
use fmi2::ffi::{CallbackFunctions, Component, FALSE, FmuState, Status, TRUE, Type};
use std::ffi::{CStr, CString, c_int};
use std::path::Path;
use std::ptr::null_mut;
use std::rc::Rc;

/// The C type of the getters and setters of one type.
type Get<T> = unsafe extern "C" fn(Component, *const u32, usize, *mut T) -> Status;
type Set<T> = unsafe extern "C" fn(Component, *const u32, usize, *const T) -> Status;

/// State slot through which states go to and from bytes.
const AS_BYTES: usize = 1;

/// One instance of an FMU. Dropping it frees its states and the instance, then unloads the library.
pub struct FmuParticipant {
    model: Model,
    library: Library,
    component: Component,
    states: Vec<FmuState>,
    time: f64,
    // Addresses of both are known to the FMU: they stay in place until the instance is freed.
    environment: Rc<Environment>,
    _callbacks: Rc<CallbackFunctions>,
    // After the library, so that the files outlive it.
    _archive: Archive,
    // Last, so that the end of the library is watched too.
    watched: Watched,
}

impl FmuParticipant {
    /// Unpacks, loads and instantiates the FMU at `path` under the name `name`.
    pub fn load(path: &Path, name: &str, log: &Log) -> Result<Self, FmuError> {
        Self::load_within(path, name, log, &Limits::default())
    }

    /// The same with limits of what the FMU may take.
    pub fn load_within(path: &Path, name: &str, log: &Log, limits: &Limits) -> Result<Self, FmuError> {
        let archive = Archive::unpack(path, limits)?;
        let model = Model::parse(&archive.description()?)
            .map_err(|reason| FmuError::Description { path: archive.path.clone(), reason })?;
        let watched = Watched::new(name);
        let library = {
            let _inside = watched.enter(&"loading its library", 0.0);
            Library::load(&archive, &model.identifier, &model.description)?
        };
        let environment = Rc::new(Environment { log: log.clone(), participant: name.to_string() });
        let callbacks = Rc::new(CallbackFunctions {
            logger: Some(abi::plimsoll_logger),
            allocate_memory: Some(abi::calloc),
            free_memory: Some(abi::free),
            step_finished: None,
            component_environment: Rc::as_ptr(&environment).cast_mut().cast(),
        });
        let component = {
            let _inside = watched.enter(&"fmi2Instantiate", 0.0);
            instantiate(&library, &model, &archive, name, &callbacks)
        };
        if component.is_null() {
            let message = log.take_problem().map_or_else(String::new, |text| format!(": {text}"));
            return Err(FmuError::Instantiate { path: archive.path, instance: name.to_string(), message });
        }
        let states = Vec::new();
        Ok(Self {
            model,
            library,
            component,
            states,
            time: 0.0,
            environment,
            _callbacks: callbacks,
            _archive: archive,
            watched,
        })
    }

    /// Notes that a function of the FMU is called, until the value is dropped.
    fn inside(&self, call: &'static &'static str) -> Inside {
        self.watched.enter(call, self.time)
    }

    fn check(&self, action: impl FnOnce() -> String, status: Status) -> Result<(), Error> {
        if status == Status::OK || status == Status::WARNING {
            return Ok(());
        }
        Err(Error::Call {
            participant: self.environment.participant.clone(),
            action: action(),
            time: self.time,
            status: status.name().to_string(),
            message: self.problem(),
        })
    }

    fn problem(&self) -> String {
        self.environment.log.take_problem().map_or_else(String::new, |text| format!(": {text}"))
    }

    fn get_one<T: Copy>(&self, get: Get<T>, variable: &Variable, mut value: T) -> Result<T, Error> {
        let _inside = self.inside(&"fmi2Get");
        // SAFETY: one reference and room for one value of the type that the function writes.
        let status = unsafe { get(self.component, &raw const variable.reference, 1, &raw mut value) };
        self.check(|| format!("getting '{}'", variable.name), status)?;
        Ok(value)
    }

    fn set_one<T>(&self, set: Set<T>, variable: &Variable, value: &T) -> Result<(), Error> {
        let _inside = self.inside(&"fmi2Set");
        // SAFETY: one reference and one value of the type that the function reads.
        let status = unsafe { set(self.component, &raw const variable.reference, 1, value) };
        self.check(|| format!("setting '{}'", variable.name), status)
    }

    fn state_functions(&self) -> Result<StateFunctions, Error> {
        self.library.states.ok_or_else(|| Error::Unsupported {
            participant: self.environment.participant.clone(),
            capability: "canGetAndSetFMUstate".to_string(),
            hint: "; use the coupling method 'explicit'".to_string(),
        })
    }

    fn byte_functions(&self) -> Result<ByteFunctions, Error> {
        self.library.bytes.ok_or_else(|| Error::Unsupported {
            participant: self.environment.participant.clone(),
            capability: "canSerializeFMUstate".to_string(),
            hint: "; the run cannot be resumed".to_string(),
        })
    }

    /// Names of real variables, for messages.
    fn names(&self, references: &[u32]) -> String {
        let real = |reference: &u32| {
            let variables = &self.model.description.variables;
            let found = variables.iter().find(|v| v.kind == Kind::Real && v.reference == *reference);
            found.map_or_else(|| format!("reference {reference}"), |variable| format!("'{}'", variable.name))
        };
        references.iter().map(real).collect::<Vec<_>>().join(", ")
    }
}

fn instantiate(
    library: &Library,
    model: &Model,
    archive: &Archive,
    name: &str,
    callbacks: &CallbackFunctions,
) -> Component {
    let text = |text: &str| CString::new(text.replace('\0', "")).unwrap_or_default();
    let (name, guid, resources) = (text(name), text(&model.guid), text(&archive.resource_location()));
    // SAFETY: all strings are terminated and live through the call; the callbacks live until the instance is freed.
    unsafe {
        (library.instantiate)(
            name.as_ptr(),
            Type::CO_SIMULATION,
            guid.as_ptr(),
            resources.as_ptr(),
            callbacks,
            FALSE,
            TRUE,
        )
    }
}

impl Participant for FmuParticipant {
    fn name(&self) -> &str {
        &self.environment.participant
    }

    fn description(&self) -> &Description {
        &self.model.description
    }

    fn set(&mut self, variable: &Variable, value: &Value) -> Result<(), Error> {
        match (variable.kind, value) {
            (Kind::Real, Value::Real(value)) => self.set_one(self.library.set_real, variable, value),
            (Kind::Real, Value::Integer(value)) => self.set_one(self.library.set_real, variable, &f64::from(*value)),
            (Kind::Integer, Value::Integer(value)) => self.set_one(self.library.set_integer, variable, value),
            (Kind::Boolean, Value::Boolean(value)) => {
                self.set_one(self.library.set_boolean, variable, &if *value { TRUE } else { FALSE })
            }
            (Kind::String, Value::String(value)) => {
                let text = CString::new(value.replace('\0', "")).unwrap_or_default();
                self.set_one(self.library.set_string, variable, &text.as_ptr())
            }
            _ => Err(Error::WrongType {
                participant: self.name().to_string(),
                variable: variable.name.clone(),
                expected: variable.kind,
                got: value.to_string(),
            }),
        }
    }

    fn get(&mut self, variable: &Variable) -> Result<Value, Error> {
        Ok(match variable.kind {
            Kind::Real => Value::Real(self.get_one(self.library.get_real, variable, f64::NAN)?),
            Kind::Integer => Value::Integer(self.get_one::<c_int>(self.library.get_integer, variable, 0)?),
            Kind::Boolean => Value::Boolean(self.get_one(self.library.get_boolean, variable, FALSE)? != FALSE),
            Kind::String => {
                let text = self.get_one(self.library.get_string, variable, std::ptr::null())?;
                // SAFETY: fmi2GetString gives NULL or a terminated string that lives until the next call.
                let text = if text.is_null() { c"" } else { unsafe { CStr::from_ptr(text) } };
                Value::String(text.to_string_lossy().into_owned())
            }
        })
    }

    fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), Error> {
        debug_assert_eq!(references.len(), values.len());
        let _inside = self.inside(&"fmi2SetReal");
        // SAFETY: both slices have the length given.
        let status =
            unsafe { (self.library.set_real)(self.component, references.as_ptr(), references.len(), values.as_ptr()) };
        self.check(|| format!("setting {}", self.names(references)), status)
    }

    fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        debug_assert_eq!(references.len(), values.len());
        let _inside = self.inside(&"fmi2GetReal");
        // SAFETY: both slices have the length given.
        let status = unsafe {
            (self.library.get_real)(self.component, references.as_ptr(), references.len(), values.as_mut_ptr())
        };
        self.check(|| format!("getting {}", self.names(references)), status)
    }

    fn enter_initialisation(&mut self, start: f64, stop: f64) -> Result<(), Error> {
        self.time = start;
        let inside = self.inside(&"fmi2SetupExperiment");
        // SAFETY: the instance is alive and in the state that the standard asks for.
        let status = unsafe { (self.library.setup_experiment)(self.component, FALSE, 0.0, start, TRUE, stop) };
        self.check(|| "fmi2SetupExperiment".to_string(), status)?;
        drop(inside);
        let _inside = self.inside(&"fmi2EnterInitializationMode");
        // SAFETY: as above.
        let status = unsafe { (self.library.enter_initialisation)(self.component) };
        self.check(|| "fmi2EnterInitializationMode".to_string(), status)
    }

    fn exit_initialisation(&mut self) -> Result<(), Error> {
        let _inside = self.inside(&"fmi2ExitInitializationMode");
        // SAFETY: the instance is alive.
        let status = unsafe { (self.library.exit_initialisation)(self.component) };
        self.check(|| "fmi2ExitInitializationMode".to_string(), status)
    }

    fn step(&mut self, time: f64, duration: f64) -> Result<Outcome, Error> {
        self.time = time;
        let _inside = self.inside(&"fmi2DoStep");
        // SAFETY: the instance is alive. States before this point may be restored, hence FALSE.
        let status = unsafe { (self.library.do_step)(self.component, time, duration, FALSE) };
        if status == Status::DISCARD || status == Status::ERROR {
            return Ok(Outcome::Refused { reason: format!("{}{}", status.name(), self.problem()) });
        }
        self.check(|| format!("fmi2DoStep of {duration} s"), status)?;
        self.time = time + duration;
        Ok(Outcome::Done)
    }

    fn save(&mut self, slot: usize) -> Result<(), Error> {
        let functions = self.state_functions()?;
        if self.states.len() <= slot {
            self.states.resize(slot + 1, null_mut());
        }
        let _inside = self.inside(&"fmi2GetFMUstate");
        // SAFETY: the handle is NULL or one that this instance gave and that was not freed.
        let status = unsafe { (functions.get)(self.component, &raw mut self.states[slot]) };
        self.check(|| "fmi2GetFMUstate".to_string(), status)
    }

    fn restore(&mut self, slot: usize) -> Result<(), Error> {
        let functions = self.state_functions()?;
        let handle = self.states.get(slot).copied().unwrap_or(null_mut());
        if handle.is_null() {
            return Err(Error::Unsupported {
                participant: self.name().to_string(),
                capability: format!("a state in slot {slot}"),
                hint: "; save one first".to_string(),
            });
        }
        let _inside = self.inside(&"fmi2SetFMUstate");
        // SAFETY: the handle was given by this instance and not freed.
        let status = unsafe { (functions.set)(self.component, handle) };
        self.check(|| "fmi2SetFMUstate".to_string(), status)
    }

    fn serialise(&mut self) -> Result<Vec<u8>, Error> {
        let functions = self.byte_functions()?;
        self.save(AS_BYTES)?;
        let (handle, mut size) = (self.states[AS_BYTES], 0);
        let _inside = self.inside(&"fmi2SerializeFMUstate");
        // SAFETY: the handle was just given by this instance.
        let status = unsafe { (functions.size)(self.component, handle, &raw mut size) };
        self.check(|| "fmi2SerializedFMUstateSize".to_string(), status)?;
        let mut bytes = vec![0_u8; size];
        // SAFETY: as above; the buffer has the size that the FMU asked for.
        let status = unsafe { (functions.serialise)(self.component, handle, bytes.as_mut_ptr().cast(), size) };
        self.check(|| format!("fmi2SerializeFMUstate of {size} bytes"), status)?;
        Ok(bytes)
    }

    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let functions = self.byte_functions()?;
        self.states.resize(self.states.len().max(AS_BYTES + 1), null_mut());
        let inside = self.inside(&"fmi2DeSerializeFMUstate");
        let handle = &raw mut self.states[AS_BYTES];
        // SAFETY: the buffer has the size given; the handle is NULL or one of this instance.
        let status = unsafe { (functions.deserialise)(self.component, bytes.as_ptr().cast(), bytes.len(), handle) };
        self.check(|| format!("fmi2DeSerializeFMUstate of {} bytes", bytes.len()), status)?;
        drop(inside);
        self.restore(AS_BYTES)
    }

    fn release(&mut self) -> Result<(), Error> {
        let Some(functions) = self.library.states else { return Ok(()) };
        for mut handle in std::mem::take(&mut self.states) {
            let _inside = self.inside(&"fmi2FreeFMUstate");
            // SAFETY: the handle is NULL or one that this instance gave; it is forgotten after this call.
            let status = unsafe { (functions.free)(self.component, &raw mut handle) };
            self.check(|| "fmi2FreeFMUstate".to_string(), status)?;
        }
        Ok(())
    }

    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Error> {
        debug_assert_eq!((knowns.len(), unknowns.len()), (seed.len(), sensitivity.len()));
        let Some(derivative) = self.library.derivative else {
            return Err(Error::Unsupported {
                participant: self.name().to_string(),
                capability: "providesDirectionalDerivative".to_string(),
                hint: "; use the coupling method 'iqn_ils'".to_string(),
            });
        };
        let _inside = self.inside(&"fmi2GetDirectionalDerivative");
        // SAFETY: the slices have the lengths given, the seed that of the knowns, the result that of the unknowns.
        let status = unsafe {
            derivative(
                self.component,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                sensitivity.as_mut_ptr(),
            )
        };
        self.check(|| format!("derivative of {} by {}", self.names(unknowns), self.names(knowns)), status)
    }

    fn terminate(&mut self) -> Result<(), Error> {
        let _inside = self.inside(&"fmi2Terminate");
        // SAFETY: the instance is alive.
        let status = unsafe { (self.library.terminate)(self.component) };
        self.check(|| "fmi2Terminate".to_string(), status)
    }
}

impl Drop for FmuParticipant {
    fn drop(&mut self) {
        // A failure to free has no remedy here; the message is in the log.
        let _ = self.release();
        let _inside = self.inside(&"fmi2FreeInstance");
        // SAFETY: the instance was created by this library and is not used afterwards.
        unsafe { (self.library.free_instance)(self.component) };
    }
}
