//! The functions of an FMU's shared library.

use super::{Archive, Error};
use coupling::participant::Description;
use fmi2::ffi;
use object::{Object, ObjectSegment};
use std::error::Error as _;
use std::ffi::CStr;
use std::path::Path;

/// Loaded functions. The library stays loaded as long as this value lives.
pub struct Library {
    pub(super) instantiate: ffi::Instantiate,
    pub(super) free_instance: ffi::FreeInstance,
    pub(super) setup_experiment: ffi::SetupExperiment,
    pub(super) enter_initialisation: ffi::ComponentFunction,
    pub(super) exit_initialisation: ffi::ComponentFunction,
    pub(super) terminate: ffi::ComponentFunction,
    pub(super) get_real: ffi::GetReal,
    pub(super) set_real: ffi::SetReal,
    pub(super) get_integer: ffi::GetInteger,
    pub(super) set_integer: ffi::SetInteger,
    pub(super) get_boolean: ffi::GetBoolean,
    pub(super) set_boolean: ffi::SetBoolean,
    pub(super) get_string: ffi::GetString,
    pub(super) set_string: ffi::SetString,
    pub(super) do_step: ffi::DoStep,
    pub(super) states: Option<StateFunctions>,
    pub(super) bytes: Option<ByteFunctions>,
    pub(super) derivative: Option<ffi::GetDirectionalDerivative>,
    _library: libloading::Library,
}

/// Functions that only FMUs with canGetAndSetFMUstate need to have.
#[derive(Clone, Copy)]
pub(super) struct StateFunctions {
    pub get: ffi::GetFmuState,
    pub set: ffi::SetFmuState,
    pub free: ffi::FreeFmuState,
}

/// Functions that only FMUs with canSerializeFMUstate need to have.
#[derive(Clone, Copy)]
pub(super) struct ByteFunctions {
    pub size: ffi::SerializedFmuStateSize,
    pub serialise: ffi::SerializeFmuState,
    pub deserialise: ffi::DeSerializeFmuState,
}

impl Library {
    /// Loads the binary of this platform and resolves the functions that the description promises.
    pub fn load(archive: &Archive, identifier: &str, description: &Description) -> Result<Self, Error> {
        let binary = archive.binary(identifier)?;
        let refuse = |reason: String| Error::Library { path: archive.path.clone(), reason };
        check_whole(&binary).map_err(|reason| refuse(format!("the shared library cannot be read: {reason}")))?;
        // SAFETY: loading runs the library's initialisers; the user chose to run this FMU.
        let library = unsafe { libloading::Library::new(binary) }.map_err(|error| refuse(with_cause(&error)))?;
        let loader = Loader { library: &library, path: &archive.path };
        loader.check_version()?;
        let states = if description.saves_states { Some(loader.states()?) } else { None };
        let bytes = if description.serialises_states { Some(loader.bytes()?) } else { None };
        let derivative =
            if description.derivatives { Some(loader.function("fmi2GetDirectionalDerivative")?) } else { None };
        Ok(Self {
            instantiate: loader.function("fmi2Instantiate")?,
            free_instance: loader.function("fmi2FreeInstance")?,
            setup_experiment: loader.function("fmi2SetupExperiment")?,
            enter_initialisation: loader.function("fmi2EnterInitializationMode")?,
            exit_initialisation: loader.function("fmi2ExitInitializationMode")?,
            terminate: loader.function("fmi2Terminate")?,
            get_real: loader.function("fmi2GetReal")?,
            set_real: loader.function("fmi2SetReal")?,
            get_integer: loader.function("fmi2GetInteger")?,
            set_integer: loader.function("fmi2SetInteger")?,
            get_boolean: loader.function("fmi2GetBoolean")?,
            set_boolean: loader.function("fmi2SetBoolean")?,
            get_string: loader.function("fmi2GetString")?,
            set_string: loader.function("fmi2SetString")?,
            do_step: loader.function("fmi2DoStep")?,
            states,
            bytes,
            derivative,
            _library: library,
        })
    }
}

/// Whether all that a shared library promises to have is in the file: to load one that was cut off would end the
/// process.
fn check_whole(binary: &Path) -> Result<(), String> {
    let content = std::fs::read(binary).map_err(|error| error.to_string())?;
    let file = object::File::parse(&*content).map_err(|error| error.to_string())?;
    file.segments().try_for_each(|segment| segment.data().map(|_| ())).map_err(|error| error.to_string())
}

/// What the system says is in the source of the loader's error, not in its text.
fn with_cause(error: &libloading::Error) -> String {
    explained(error.source().map_or_else(|| error.to_string(), |cause| format!("{error}: {cause}")))
}

/// What to do where the library needs another one that it does not name.
fn explained(reason: String) -> String {
    let Some((_, rest)) = reason.split_once("undefined symbol: ") else { return reason };
    let symbol = rest.split([',', ' ', ')']).next().unwrap_or_default().to_string();
    let (what, library) = if symbol.starts_with("Py") || symbol.starts_with("_Py") {
        ("a Python interpreter that it does not load itself", "libpython3.N.so of the Python that it was made with")
    } else {
        ("another shared library that it does not load itself", "the library that has it")
    };
    format!("{reason}; the FMU needs {what}: preload it, LD_PRELOAD=PATH plimsoll ..., with the path of {library}")
}

struct Loader<'a> {
    library: &'a libloading::Library,
    path: &'a str,
}

impl Loader<'_> {
    /// Resolves one function; `T` must be its C type.
    fn function<T: Copy>(&self, name: &str) -> Result<T, Error> {
        // SAFETY: callers pass the type that the standard gives to this name; the library outlives the copy because
        // both live in one `Library`.
        let symbol = unsafe { self.library.get::<T>(name.as_bytes()) };
        symbol.map(|symbol| *symbol).map_err(|error| Error::Library {
            path: self.path.to_string(),
            reason: format!("the library has no function {name}: {error}"),
        })
    }

    fn states(&self) -> Result<StateFunctions, Error> {
        Ok(StateFunctions {
            get: self.function("fmi2GetFMUstate")?,
            set: self.function("fmi2SetFMUstate")?,
            free: self.function("fmi2FreeFMUstate")?,
        })
    }

    fn bytes(&self) -> Result<ByteFunctions, Error> {
        Ok(ByteFunctions {
            size: self.function("fmi2SerializedFMUstateSize")?,
            serialise: self.function("fmi2SerializeFMUstate")?,
            deserialise: self.function("fmi2DeSerializeFMUstate")?,
        })
    }

    fn check_version(&self) -> Result<(), Error> {
        let version: ffi::GetText = self.function("fmi2GetVersion")?;
        // SAFETY: fmi2GetVersion takes nothing and returns a static string or NULL.
        let text = unsafe { version() };
        if text.is_null() {
            return Err(Error::Library { path: self.path.to_string(), reason: "fmi2GetVersion gave NULL".into() });
        }
        // SAFETY: checked non-null; the standard promises a terminated static string.
        let text = unsafe { CStr::from_ptr(text) }.to_string_lossy();
        if text.starts_with("2.") {
            return Ok(());
        }
        let reason = format!("fmi2GetVersion is '{text}', expected '2.0'");
        Err(Error::Library { path: self.path.to_string(), reason })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_undefined_symbol_says_what_to_preload() {
        let python = explained("/tmp/a.so: undefined symbol: PyExc_ValueError".into());
        assert!(python.contains("LD_PRELOAD=PATH") && python.contains("libpython3.N.so"), "{python}");
        let other = explained("/tmp/a.so: undefined symbol: dgemm_, version X".into());
        assert!(other.contains("LD_PRELOAD=PATH") && !other.contains("ython"), "{other}");
        assert_eq!(explained("file too short".into()), "file too short");
    }
}
