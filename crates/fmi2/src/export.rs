//! The exported names.

/// Exports every common and co-simulation function of FMI 2.0 for one `fmi::Component`. Functions that the model
/// does not support are exported too: several importers refuse a library that lacks one.
#[macro_export]
macro_rules! export {
    ($component:ty) => {
        /// The C functions of the standard.
        #[allow(non_snake_case, missing_docs, clippy::missing_safety_doc, clippy::too_many_arguments)]
        pub mod exported {
            use super::*;
            use $crate::Function;
            use $crate::entry;
            use $crate::ffi::*;

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi2GetTypesPlatform() -> Text {
                c"default".as_ptr()
            }

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi2GetVersion() -> Text {
                c"2.0".as_ptr()
            }

            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn fmi2FreeInstance(c: Component) {
                // SAFETY: arguments as the standard passes them.
                unsafe { entry::free_instance::<$component>(c) }
            }

            $crate::export_functions! { $component;
                fmi2Instantiate(
                    name: Text, kind: Type, guid: Text, location: Text, callbacks: *const CallbackFunctions,
                    visible: Boolean, logging_on: Boolean
                ) -> Component = instantiate(name, kind, guid, location, callbacks, visible, logging_on);
                fmi2SetDebugLogging(c: Component, on: Boolean, n: usize, categories: *const Text) -> Status
                    = set_debug_logging(c, on, n, categories);
                fmi2SetupExperiment(
                    c: Component, tolerance_defined: Boolean, tolerance: Real, start: Real, stop_defined: Boolean,
                    stop: Real
                ) -> Status = setup_experiment(c, tolerance_defined, tolerance, start, stop_defined, stop);
                fmi2EnterInitializationMode(c: Component) -> Status = enter_initialization_mode(c);
                fmi2ExitInitializationMode(c: Component) -> Status = exit_initialization_mode(c);
                fmi2Terminate(c: Component) -> Status = terminate(c);
                fmi2Reset(c: Component) -> Status = reset(c);
                fmi2GetReal(c: Component, vr: *const ValueReference, n: usize, value: *mut Real) -> Status
                    = get_real(c, vr, n, value);
                fmi2GetInteger(c: Component, vr: *const ValueReference, n: usize, value: *mut Integer) -> Status
                    = get_integer(c, vr, n, value);
                fmi2GetBoolean(c: Component, vr: *const ValueReference, n: usize, value: *mut Boolean) -> Status
                    = get_boolean(c, vr, n, value);
                fmi2GetString(c: Component, vr: *const ValueReference, n: usize, value: *mut Text) -> Status
                    = get_string(c, vr, n, value);
                fmi2SetReal(c: Component, vr: *const ValueReference, n: usize, value: *const Real) -> Status
                    = set_real(c, vr, n, value);
                fmi2SetInteger(c: Component, vr: *const ValueReference, n: usize, value: *const Integer) -> Status
                    = set_integer(c, vr, n, value);
                fmi2SetBoolean(c: Component, vr: *const ValueReference, n: usize, value: *const Boolean) -> Status
                    = set_boolean(c, vr, n, value);
                fmi2SetString(c: Component, vr: *const ValueReference, n: usize, value: *const Text) -> Status
                    = set_string(c, vr, n, value);
                fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status = get_state(c, state);
                fmi2SetFMUstate(c: Component, state: FmuState) -> Status = set_state(c, state);
                fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status = free_state(c, state);
                fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status
                    = serialized_size(c, state, size);
                fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status
                    = serialize(c, state, bytes, size);
                fmi2DeSerializeFMUstate(c: Component, bytes: *const Byte, size: usize, state: *mut FmuState) -> Status
                    = deserialize(c, bytes, size, state);
                fmi2GetDirectionalDerivative(
                    c: Component, unknowns: *const ValueReference, n_unknown: usize, knowns: *const ValueReference,
                    n_known: usize, seed: *const Real, result: *mut Real
                ) -> Status
                    = get_directional_derivative(c, unknowns, n_unknown, knowns, n_known, seed, result);
                fmi2SetRealInputDerivatives(
                    c: Component, _vr: *const ValueReference, n: usize, _order: *const Integer, _value: *const Real
                ) -> Status = no_derivatives(c, n, Function::SetRealInputDerivatives);
                fmi2GetRealOutputDerivatives(
                    c: Component, _vr: *const ValueReference, n: usize, _order: *const Integer, _value: *mut Real
                ) -> Status = no_derivatives(c, n, Function::GetRealOutputDerivatives);
                fmi2DoStep(c: Component, time: Real, step: Real, no_rollback: Boolean) -> Status
                    = do_step(c, time, step, no_rollback);
                fmi2CancelStep(c: Component) -> Status = cancel_step(c);
                fmi2GetStatus(c: Component, kind: StatusKind, _value: *mut Status) -> Status
                    = no_status(c, kind, Function::GetStatus);
                fmi2GetRealStatus(c: Component, kind: StatusKind, value: *mut Real) -> Status
                    = get_real_status(c, kind, value);
                fmi2GetIntegerStatus(c: Component, kind: StatusKind, _value: *mut Integer) -> Status
                    = no_status(c, kind, Function::GetIntegerStatus);
                fmi2GetBooleanStatus(c: Component, kind: StatusKind, value: *mut Boolean) -> Status
                    = get_boolean_status(c, kind, value);
                fmi2GetStringStatus(c: Component, kind: StatusKind, _value: *mut Text) -> Status
                    = no_status(c, kind, Function::GetStringStatus);
            }
        }
    };
}

/// One exported function per row; used by [`export!`].
#[doc(hidden)]
#[macro_export]
macro_rules! export_functions {
    ($component:ty; $($name:ident($($argument:ident: $kind:ty),*) -> $result:ty
        = $target:ident($($value:expr),*);)*) => {
        $(
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name($($argument: $kind),*) -> $result {
                // SAFETY: arguments as the standard passes them.
                unsafe { entry::$target::<$component>($($value),*) }
            }
        )*
    };
}
