//! The functions of FMI 2.0 for co-simulation.
//!
//! # Safety
//! Each function has the contract of its name in the standard, which the module header of the crate sums up.

use std::ffi::{CString, c_char, c_int, c_uint};

use crate::component::{self, Boolean2, ERROR, Log, OK, Pointer, Status, call};
use crate::texts::{Text, to_c};

/// `fmi2CallbackFunctions`. Memory of an importer isn't used, as the description says.
#[repr(C)]
pub struct Callbacks {
    logger: Option<unsafe extern "C" fn(Pointer, Text, Status, Text, Text, ...)>,
    allocate: Option<unsafe extern "C" fn(usize, usize) -> Pointer>,
    free: Option<unsafe extern "C" fn(Pointer)>,
    step_finished: Option<unsafe extern "C" fn(Pointer, Status)>,
    environment: Pointer,
}

/// The logger of an importer.
struct Logger {
    function: Option<unsafe extern "C" fn(Pointer, Text, Status, Text, Text, ...)>,
    environment: Pointer,
    name: CString,
}

impl Log for Logger {
    fn write(&self, status: Status, category: &CString, message: &CString) {
        if let Some(function) = self.function {
            // SAFETY: all texts live until the call returns, and the format takes one text.
            unsafe {
                function(
                    self.environment,
                    self.name.as_ptr(),
                    status,
                    category.as_ptr(),
                    c"%s".as_ptr(),
                    message.as_ptr(),
                );
            }
        }
    }
}

const CO_SIMULATION: c_int = 1;

/// `default`: the types of this platform.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> Text {
    c"default".as_ptr()
}

/// Version of FMI.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> Text {
    c"2.0".as_ptr()
}

/// Errors are logged always, and there is nothing else to log.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetDebugLogging(_: Pointer, _: c_int, _: usize, _: *const Text) -> Status {
    OK
}

/// Makes an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: Text,
    kind: c_int,
    token: Text,
    resources: Text,
    callbacks: *const Callbacks,
    _visible: c_int,
    _logging: c_int,
) -> Pointer {
    // SAFETY: the contract of the standard.
    unsafe {
        let name = to_c(&crate::texts::of_c(name));
        let log = match callbacks.as_ref() {
            Some(callbacks) => {
                Logger { function: callbacks.logger, environment: callbacks.environment, name }
            }
            None => Logger { function: None, environment: std::ptr::null_mut(), name },
        };
        if kind != CO_SIMULATION {
            log.write(ERROR, &to_c("logStatusError"), &to_c("the FMU is for co-simulation only"));
            return std::ptr::null_mut();
        }
        component::instantiate(token, resources, Box::new(log))
    }
}

/// Frees an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(component: Pointer) {
    // SAFETY: the contract of the standard.
    unsafe { component::free(component) }
}

/// Takes the start time. Tolerance and stop time mean nothing to these FMUs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    component: Pointer,
    _has_tolerance: c_int,
    _tolerance: f64,
    start_s: f64,
    _has_stop: c_int,
    _stop_s: f64,
) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { call(component, |it| it.instance.set_start(start_s)) }
}

/// Begins the initialization.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(component: Pointer) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { call(component, |it| it.instance.enter_initialization()) }
}

/// Ends the initialization.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(component: Pointer) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { call(component, |it| it.instance.exit_initialization()) }
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(component: Pointer) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { call(component, |it| it.instance.terminate()) }
}

/// Puts the instance where it was after its creation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(component: Pointer) -> Status {
    // SAFETY: the contract of the standard.
    unsafe {
        call(component, |it| {
            it.instance.reset();
            Ok(())
        })
    }
}

/// Advances by a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    component: Pointer,
    time_s: f64,
    step_s: f64,
    _no_set_state: c_int,
) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { call(component, |it| it.instance.step(time_s, step_s)) }
}

/// The functions that read and set variables of a type.
macro_rules! access {
    ($get:ident, $set:ident, $type:ty) => {
        /// Reads variables.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            component: Pointer,
            references: *const c_uint,
            count: usize,
            values: *mut $type,
        ) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::get(component, references, count, values) }
        }

        /// Sets variables.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            component: Pointer,
            references: *const c_uint,
            count: usize,
            values: *const $type,
        ) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::set(component, references, count, values) }
        }
    };
}

access!(fmi2GetReal, fmi2SetReal, f64);
access!(fmi2GetInteger, fmi2SetInteger, c_int);
access!(fmi2GetBoolean, fmi2SetBoolean, Boolean2);

/// Reads texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    component: Pointer,
    references: *const c_uint,
    count: usize,
    values: *mut Text,
) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { component::get_texts(component, references, count, values) }
}

/// Sets texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    component: Pointer,
    references: *const c_uint,
    count: usize,
    values: *const Text,
) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { component::set_texts(component, references, count, values) }
}

states!(
    c_char,
    fmi2GetFMUstate,
    fmi2SetFMUstate,
    fmi2FreeFMUstate,
    fmi2SerializedFMUstateSize,
    fmi2SerializeFMUstate,
    fmi2DeSerializeFMUstate
);
