//! The functions of one FMU library.

use fmi2::ffi::*;
use std::error::Error;
use std::path::PathBuf;

macro_rules! library {
    ($($field:ident: $kind:ty = $name:literal),* $(,)?) => {
        /// The functions of FMI 2.0 co-simulation, as loaded.
        #[allow(missing_docs)]
        pub struct Library {
            $(pub $field: $kind,)*
            pub path: PathBuf,
            _library: libloading::Library,
        }

        /// Names of all functions that an FMU must export.
        pub const NAMES: &[&str] = &[$($name),*];

        impl Library {
            /// Loads `lib<name>.so` from the folder of the running test.
            pub fn load(name: &str) -> Result<Self, Box<dyn Error>> {
                let executable = std::env::current_exe()?;
                let folder = executable.parent().ok_or("the test has no folder")?;
                let file = format!("{}{name}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
                let path = folder.join(file);
                // SAFETY: the library is ours; loading it runs no code beyond the Rust runtime's.
                let library = unsafe { libloading::Library::new(&path)? };
                $(
                    // SAFETY: the type is the one that the standard gives to this name.
                    let $field = *unsafe { library.get::<$kind>($name)? };
                )*
                Ok(Self { $($field,)* path, _library: library })
            }
        }
    };
}

library! {
    get_types_platform: GetText = "fmi2GetTypesPlatform",
    get_version: GetText = "fmi2GetVersion",
    set_debug_logging: SetDebugLogging = "fmi2SetDebugLogging",
    instantiate: Instantiate = "fmi2Instantiate",
    free_instance: FreeInstance = "fmi2FreeInstance",
    setup_experiment: SetupExperiment = "fmi2SetupExperiment",
    enter_initialization_mode: ComponentFunction = "fmi2EnterInitializationMode",
    exit_initialization_mode: ComponentFunction = "fmi2ExitInitializationMode",
    terminate: ComponentFunction = "fmi2Terminate",
    reset: ComponentFunction = "fmi2Reset",
    get_real: GetReal = "fmi2GetReal",
    get_integer: GetInteger = "fmi2GetInteger",
    get_boolean: GetBoolean = "fmi2GetBoolean",
    get_string: GetString = "fmi2GetString",
    set_real: SetReal = "fmi2SetReal",
    set_integer: SetInteger = "fmi2SetInteger",
    set_boolean: SetBoolean = "fmi2SetBoolean",
    set_string: SetString = "fmi2SetString",
    get_state: GetFmuState = "fmi2GetFMUstate",
    set_state: SetFmuState = "fmi2SetFMUstate",
    free_state: FreeFmuState = "fmi2FreeFMUstate",
    serialized_size: SerializedFmuStateSize = "fmi2SerializedFMUstateSize",
    serialize: SerializeFmuState = "fmi2SerializeFMUstate",
    deserialize: DeSerializeFmuState = "fmi2DeSerializeFMUstate",
    get_directional_derivative: GetDirectionalDerivative = "fmi2GetDirectionalDerivative",
    set_real_input_derivatives: SetRealInputDerivatives = "fmi2SetRealInputDerivatives",
    get_real_output_derivatives: GetRealOutputDerivatives = "fmi2GetRealOutputDerivatives",
    do_step: DoStep = "fmi2DoStep",
    cancel_step: ComponentFunction = "fmi2CancelStep",
    get_status: GetStatus = "fmi2GetStatus",
    get_real_status: GetRealStatus = "fmi2GetRealStatus",
    get_integer_status: GetIntegerStatus = "fmi2GetIntegerStatus",
    get_boolean_status: GetBooleanStatus = "fmi2GetBooleanStatus",
    get_string_status: GetStringStatus = "fmi2GetStringStatus",
}
