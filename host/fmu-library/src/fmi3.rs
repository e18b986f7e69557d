//! The functions of FMI 3.0 for co-simulation, as far as the FMU offers them.
//!
//! # Safety
//! Each function has the contract of its name in the standard, which the module header of the crate sums up.

use std::ffi::{CString, c_int};

use crate::component::{self, Log, OK, Pointer, Status, call};
use crate::texts::Text;

type LogMessage = unsafe extern "C" fn(Pointer, Status, Text, Text);

/// The logger of an importer.
struct Logger {
    function: Option<LogMessage>,
    environment: Pointer,
}

impl Log for Logger {
    fn write(&self, status: Status, category: &CString, message: &CString) {
        if let Some(function) = self.function {
            // SAFETY: the texts live until the call returns.
            unsafe { function(self.environment, status, category.as_ptr(), message.as_ptr()) };
        }
    }
}

/// Version of FMI.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> Text {
    c"3.0".as_ptr()
}

/// Errors are logged always, and there is nothing else to log.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetDebugLogging(_: Pointer, _: bool, _: usize, _: *const Text) -> Status {
    OK
}

/// Makes an instance. It has no events, so it never enters event mode, and every step is made to its end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: Text,
    token: Text,
    resources: Text,
    _visible: u8,
    _logging: u8,
    _event_mode: u8,
    _early_return: u8,
    _intermediate: *const u32,
    _count: usize,
    environment: Pointer,
    function: Option<LogMessage>,
    _update: Option<unsafe extern "C" fn()>,
) -> Pointer {
    let log = Logger { function, environment };
    // SAFETY: the contract of the standard.
    unsafe { component::instantiate(token, resources, Box::new(log)) }
}

/// Frees an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(component: Pointer) {
    // SAFETY: the contract of the standard.
    unsafe { component::free(component) }
}

/// Takes the start time and begins the initialization. Tolerance and stop time mean nothing to these FMUs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    component: Pointer,
    _has_tolerance: u8,
    _tolerance: f64,
    start_s: f64,
    _has_stop: u8,
    _stop_s: f64,
) -> Status {
    // SAFETY: the contract of the standard.
    unsafe {
        call(component, |it| {
            it.instance.set_start(start_s)?;
            it.instance.enter_initialization()
        })
    }
}

/// Ends the initialization.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(component: Pointer) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { call(component, |it| it.instance.exit_initialization()) }
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(component: Pointer) -> Status {
    // SAFETY: the contract of the standard.
    unsafe { call(component, |it| it.instance.terminate()) }
}

/// Puts the instance where it was after its creation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(component: Pointer) -> Status {
    // SAFETY: the contract of the standard.
    unsafe {
        call(component, |it| {
            it.instance.reset();
            Ok(())
        })
    }
}

/// Advances by a step, to its end always.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    component: Pointer,
    time_s: f64,
    step_s: f64,
    _no_set_state: u8,
    needs_events: *mut u8,
    terminates: *mut u8,
    is_early: *mut u8,
    reached_s: *mut f64,
) -> Status {
    // SAFETY: the contract of the standard.
    unsafe {
        for flag in [needs_events, terminates, is_early] {
            if let Some(flag) = flag.as_mut() {
                *flag = 0;
            }
        }
        let reached = reached_s.as_mut();
        call(component, |it| {
            it.instance.step(time_s, step_s)?;
            if let Some(reached_s) = reached {
                *reached_s = time_s + step_s;
            }
            Ok(())
        })
    }
}

/// The functions that read and set variables of a type. Arrays aren't offered: there are as many values as references.
macro_rules! access {
    ($get:ident by $read:ident, $set:ident by $write:ident, $type:ty) => {
        /// Reads variables.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            component: Pointer,
            references: *const u32,
            count: usize,
            values: *mut $type,
            value_count: usize,
        ) -> Status {
            // SAFETY: the contract of the standard.
            unsafe {
                if count == value_count {
                    component::$read(component, references, count, values)
                } else {
                    component::miscounted(component, count, value_count)
                }
            }
        }

        /// Sets variables.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            component: Pointer,
            references: *const u32,
            count: usize,
            values: *const $type,
            value_count: usize,
        ) -> Status {
            // SAFETY: the contract of the standard.
            unsafe {
                if count == value_count {
                    component::$write(component, references, count, values)
                } else {
                    component::miscounted(component, count, value_count)
                }
            }
        }
    };
}

access!(fmi3GetFloat64 by get, fmi3SetFloat64 by set, f64);
access!(fmi3GetInt32 by get, fmi3SetInt32 by set, c_int);
access!(fmi3GetBoolean by get, fmi3SetBoolean by set, u8);
access!(fmi3GetString by get_texts, fmi3SetString by set_texts, Text);

states!(
    u8,
    fmi3GetFMUState,
    fmi3SetFMUState,
    fmi3FreeFMUState,
    fmi3SerializedFMUStateSize,
    fmi3SerializeFMUState,
    fmi3DeserializeFMUState
);
