//! The C functions of an FMU, and the instance that they act on.
//!
//! All unsafe code of the program is here. It rests on what FMI promises: a function of a name has the signature that
//! `fmi2Functions.h` or `fmi3Functions.h` declares. Nobody can check that for a library that is loaded at run time; an FMU that
//! breaks the promise crashes this process, which holds nothing but the FMU.

#![allow(unsafe_code)]

mod callbacks;

use std::error::Error;
use std::ffi::c_int;
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr;

use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_LOCAL, RTLD_NOW};
use serde_json::Value;

use crate::description::{Description, Version};
use crate::error::FmuError;
use crate::status::{accessed, clear, logged, passed, status_name};
use crate::steps::Step;
use crate::variable::{Kind, Variable};
use callbacks::{Callbacks, Pointer, Text, callbacks2, log3, text};

/// A function that takes the instance alone.
type Plain = unsafe extern "C" fn(Pointer) -> c_int;

/// An instantiated FMU.
pub(crate) struct Instance {
    // Never unloaded: threads of an FMU may outlive its instance.
    library: ManuallyDrop<Library>,
    instance: Pointer,
    version: Version,
}

impl Instance {
    /// Loads the libraries and instantiates the FMU in `folder`.
    pub(crate) fn load(
        folder: &Path,
        binary: &Path,
        description: &Description,
        preload: &[String],
    ) -> Result<Self, FmuError> {
        let version = description.version;
        for name in preload {
            let _ = ManuallyDrop::new(open(Path::new(name), RTLD_GLOBAL)?);
        }
        let library = ManuallyDrop::new(open(&folder.join(binary), RTLD_LOCAL)?);
        let mut instance = Self { library, instance: ptr::null_mut(), version };
        let name = text("plant");
        let token = text(&description.token);
        let resources = format!("{}/resources", folder.display());
        if version == Version::Three {
            type Instantiate = unsafe extern "C" fn(
                Text,
                Text,
                Text,
                bool,
                bool,
                bool,
                bool,
                *const u32,
                usize,
                Pointer,
                unsafe extern "C" fn(Pointer, c_int, Text, Text),
                Option<unsafe extern "C" fn()>,
            ) -> Pointer;
            let create: Instantiate = instance.function("fmi3InstantiateCoSimulation")?;
            let resources = text(&format!("{resources}/"));
            let (name, token, resources) = (name.as_ptr(), token.as_ptr(), resources.as_ptr());
            // SAFETY: the signature is that of FMI, the texts live until the call returns.
            instance.instance = unsafe {
                create(
                    name,
                    token,
                    resources,
                    false,
                    false,
                    false,
                    false,
                    ptr::null(),
                    0,
                    ptr::null_mut(),
                    log3,
                    None,
                )
            };
        } else {
            type Instantiate =
                unsafe extern "C" fn(Text, c_int, Text, Text, *const Callbacks, c_int, c_int) -> Pointer;
            const CO_SIMULATION: c_int = 1;
            let create: Instantiate = instance.function("fmi2Instantiate")?;
            let uri = text(&format!("file://{}", resources.replace('%', "%25").replace(' ', "%20")));
            let (name, token, uri) = (name.as_ptr(), token.as_ptr(), uri.as_ptr());
            // SAFETY: as above.
            instance.instance = unsafe { create(name, CO_SIMULATION, token, uri, callbacks2(), 0, 0) };
        }
        if instance.instance.is_null() {
            return Err(FmuError::Call {
                function: "instantiation".to_owned(),
                status: "NULL",
                log: logged(),
            });
        }
        Ok(instance)
    }

    /// Sets a variable. The time is for errors.
    pub(crate) fn set(&self, variable: &Variable, value: &Value, time_s: f64) -> Result<(), FmuError> {
        let wrong = || FmuError::StartType {
            name: variable.name.clone(),
            value: value.to_string(),
            kind: variable.type_name.clone(),
        };
        let float = || value.as_f64().ok_or_else(wrong);
        match variable.kind {
            Kind::Float64 => self.write(variable, float()?, time_s),
            Kind::Float32 => self.write(variable, float()? as f32, time_s),
            Kind::Int8 => self.write(variable, integer::<i8>(value).ok_or_else(wrong)?, time_s),
            Kind::UInt8 => self.write(variable, integer::<u8>(value).ok_or_else(wrong)?, time_s),
            Kind::Int16 => self.write(variable, integer::<i16>(value).ok_or_else(wrong)?, time_s),
            Kind::UInt16 => self.write(variable, integer::<u16>(value).ok_or_else(wrong)?, time_s),
            Kind::Int32 => self.write(variable, integer::<i32>(value).ok_or_else(wrong)?, time_s),
            Kind::UInt32 => self.write(variable, integer::<u32>(value).ok_or_else(wrong)?, time_s),
            Kind::Int64 => self.write(variable, integer::<i64>(value).ok_or_else(wrong)?, time_s),
            Kind::UInt64 => self.write(variable, integer::<u64>(value).ok_or_else(wrong)?, time_s),
            Kind::Boolean => {
                let value = value.as_bool().ok_or_else(wrong)?;
                // A C `bool` in FMI 3.0, an `int` in FMI 2.0.
                if self.version == Version::Three {
                    self.write(variable, u8::from(value), time_s)
                } else {
                    self.write(variable, c_int::from(value), time_s)
                }
            }
            Kind::Text => {
                let value = text(value.as_str().ok_or_else(wrong)?);
                self.write(variable, value.as_ptr(), time_s)
            }
            Kind::Other => Err(wrong()),
        }
    }

    /// The number of a variable; NaN of one that isn't a number. The time is for errors.
    pub(crate) fn get(&self, variable: &Variable, time_s: f64) -> Result<f64, FmuError> {
        Ok(match variable.kind {
            Kind::Float64 => self.read::<f64>(variable, time_s)?,
            Kind::Float32 => self.read::<f32>(variable, time_s)?.into(),
            Kind::Int8 => self.read::<i8>(variable, time_s)?.into(),
            Kind::UInt8 => self.read::<u8>(variable, time_s)?.into(),
            Kind::Int16 => self.read::<i16>(variable, time_s)?.into(),
            Kind::UInt16 => self.read::<u16>(variable, time_s)?.into(),
            Kind::Int32 => self.read::<i32>(variable, time_s)?.into(),
            Kind::UInt32 => self.read::<u32>(variable, time_s)?.into(),
            Kind::Int64 => self.read::<i64>(variable, time_s)? as f64,
            Kind::UInt64 => self.read::<u64>(variable, time_s)? as f64,
            Kind::Boolean if self.version == Version::Three => self.read::<u8>(variable, time_s)?.into(),
            Kind::Boolean => self.read::<c_int>(variable, time_s)?.into(),
            Kind::Text | Kind::Other => f64::NAN,
        })
    }

    /// Initializes at time 0. `inside` acts in the initialization mode.
    pub(crate) fn initialize(
        &self,
        tolerance: Option<f64>,
        inside: impl FnOnce(&Self) -> Result<(), FmuError>,
    ) -> Result<(), FmuError> {
        let (is_given, tolerance) = (tolerance.is_some(), tolerance.unwrap_or_default());
        if self.version == Version::Three {
            type Enter = unsafe extern "C" fn(Pointer, bool, f64, f64, bool, f64) -> c_int;
            let enter: Enter = self.function("fmi3EnterInitializationMode")?;
            // SAFETY: the signature is that of FMI.
            let status = unsafe { enter(self.instance, is_given, tolerance, 0.0, false, 0.0) };
            passed("fmi3EnterInitializationMode", status)?;
        } else {
            type SetUp = unsafe extern "C" fn(Pointer, c_int, f64, f64, c_int, f64) -> c_int;
            let set_up: SetUp = self.function("fmi2SetupExperiment")?;
            // SAFETY: the signature is that of FMI.
            let status = unsafe { set_up(self.instance, is_given.into(), tolerance, 0.0, 0, 0.0) };
            passed("fmi2SetupExperiment", status)?;
            self.call("fmi2EnterInitializationMode")?;
        }
        inside(self)?;
        self.call(self.named("fmi2ExitInitializationMode", "fmi3ExitInitializationMode"))
    }

    /// Makes a communication step.
    pub(crate) fn step(&self, Step { time_s, step_s }: Step) -> Result<(), FmuError> {
        let function = self.named("fmi2DoStep", "fmi3DoStep");
        // A C `bool`. As bytes, because an FMU may leave anything in them, which a Rust `bool` doesn't allow.
        let (mut has_event, mut terminates, mut is_early) = (0_u8, 0_u8, 0_u8);
        let mut reached_s = time_s;
        let status = if self.version == Version::Three {
            type DoStep =
                unsafe extern "C" fn(Pointer, f64, f64, bool, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
            let step: DoStep = self.function(function)?;
            let (event, end, early) = (&raw mut has_event, &raw mut terminates, &raw mut is_early);
            // SAFETY: the signature is that of FMI, and the pointers are to variables of this function.
            unsafe { step(self.instance, time_s, step_s, true, event, end, early, &raw mut reached_s) }
        } else {
            let step: unsafe extern "C" fn(Pointer, f64, f64, c_int) -> c_int = self.function(function)?;
            // SAFETY: the signature is that of FMI.
            unsafe { step(self.instance, time_s, step_s, 1) }
        };
        match status {
            0 | 1 if terminates != 0 => Err(FmuError::Terminated { time_s }),
            0 | 1 if is_early != 0 => Err(FmuError::EarlyReturn { step_s, time_s, reached_s }),
            0 | 1 => Ok(()),
            status => Err(FmuError::Refused {
                function,
                status: status_name(status),
                step_s,
                time_s,
                log: logged(),
            }),
        }
    }

    /// Ends the FMU. Its errors don't matter any more.
    pub(crate) fn end(self) {
        let _ = self.call(self.named("fmi2Terminate", "fmi3Terminate"));
        let free = self.function(self.named("fmi2FreeInstance", "fmi3FreeInstance"));
        if let Ok(free) = free {
            let free: unsafe extern "C" fn(Pointer) = free;
            // SAFETY: the signature is that of FMI; nothing uses the instance afterwards.
            unsafe { free(self.instance) };
        }
    }

    fn named(&self, two: &'static str, three: &'static str) -> &'static str {
        if self.version == Version::Three { three } else { two }
    }

    /// The function of this name, for one call: messages of earlier calls are forgotten. `T` is its type in C.
    fn function<T: Copy>(&self, name: &str) -> Result<T, FmuError> {
        clear();
        // SAFETY: nothing is called here; the callers give the type that FMI declares for the name.
        let symbol = unsafe { self.library.get::<T>(name) };
        symbol.map(|symbol| *symbol).map_err(|error| FmuError::Library { reason: reason(&error), remedy: "" })
    }

    fn call(&self, name: &'static str) -> Result<(), FmuError> {
        let function: Plain = self.function(name)?;
        // SAFETY: the functions that this file calls so take the instance alone.
        passed(name, unsafe { function(self.instance) })
    }

    /// Name of the function that gets or sets variables of a type.
    fn accessor(&self, action: &str, kind: Kind) -> String {
        if self.version == Version::Three {
            let kind = if kind == Kind::Text { "String".to_owned() } else { format!("{kind:?}") };
            return format!("fmi3{action}{kind}");
        }
        let kind = match kind {
            Kind::Float64 => "Real",
            Kind::Boolean => "Boolean",
            Kind::Text => "String",
            _ => "Integer",
        };
        format!("fmi2{action}{kind}")
    }

    /// Reads a value. `T` is the type in C of the variable's kind.
    fn read<T: Default>(&self, variable: &Variable, time_s: f64) -> Result<T, FmuError> {
        let name = self.accessor("Get", variable.kind);
        let (reference, mut value) = (&raw const variable.reference, T::default());
        let status = if self.version == Version::Three {
            type Get<T> = unsafe extern "C" fn(Pointer, *const u32, usize, *mut T, usize) -> c_int;
            let get: Get<T> = self.function(&name)?;
            // SAFETY: the signature is that of FMI for this type; there is one reference and one value.
            unsafe { get(self.instance, reference, 1, &raw mut value, 1) }
        } else {
            let get: unsafe extern "C" fn(Pointer, *const u32, usize, *mut T) -> c_int =
                self.function(&name)?;
            // SAFETY: as above.
            unsafe { get(self.instance, reference, 1, &raw mut value) }
        };
        accessed("read", variable, time_s, &name, status).map(|()| value)
    }

    /// Writes a value. `T` is the type in C of the variable's kind.
    fn write<T>(&self, variable: &Variable, value: T, time_s: f64) -> Result<(), FmuError> {
        let name = self.accessor("Set", variable.kind);
        let (reference, value) = (&raw const variable.reference, &raw const value);
        let status = if self.version == Version::Three {
            type Set<T> = unsafe extern "C" fn(Pointer, *const u32, usize, *const T, usize) -> c_int;
            let set: Set<T> = self.function(&name)?;
            // SAFETY: the signature is that of FMI for this type; there is one reference and one value.
            unsafe { set(self.instance, reference, 1, value, 1) }
        } else {
            let set: unsafe extern "C" fn(Pointer, *const u32, usize, *const T) -> c_int =
                self.function(&name)?;
            // SAFETY: as above.
            unsafe { set(self.instance, reference, 1, value) }
        };
        accessed("set", variable, time_s, &name, status)
    }
}

fn open(path: &Path, visibility: c_int) -> Result<Library, FmuError> {
    // SAFETY: the library's initializers run. They belong to the FMU, to which this process belongs.
    unsafe { Library::open(Some(path), RTLD_NOW | visibility) }.map_err(|error| {
        let reason = reason(&error);
        let remedy = if reason.contains("undefined symbol: Py") || reason.contains("undefined symbol: _Py") {
            "; an FMU of PythonFMU needs the library of Python: set plant.preload = [\"libpython3.11.so.1.0\"], of the \
             version that its packages are of"
        } else {
            ""
        };
        FmuError::Library { reason, remedy }
    })
}

/// What the system says; libloading itself only names the function.
fn reason(error: &libloading::Error) -> String {
    error.source().map_or_else(|| error.to_string(), ToString::to_string)
}

fn integer<T: TryFrom<i64>>(value: &Value) -> Option<T> {
    T::try_from(value.as_i64()?).ok()
}
