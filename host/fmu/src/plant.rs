//! An FMU as a plant.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;
use tempfile::TempDir;

use crate::archive::Archive;
use crate::description::{CoSimulation, Description, Version};
use crate::error::FmuError;
use crate::library::Instance;
use crate::names::{Role, find};
use crate::steps::Steps;
use crate::variable::Variable;

/// The settings that the bench passes on.
#[derive(Debug, Deserialize)]
pub(crate) struct Settings {
    file: PathBuf,
    /// An empty folder, which the bench removes; one of our own without it.
    #[serde(default)]
    unpack_into: Option<PathBuf>,
    torque_input: String,
    motor_output: String,
    load_output: String,
    #[serde(default)]
    signals: Vec<String>,
    #[serde(default)]
    start: BTreeMap<String, Value>,
    /// 0 leaves it to the FMU.
    #[serde(default)]
    tolerance: f64,
    /// 0 for the control period.
    #[serde(default)]
    step_us: u32,
    /// Libraries to load first.
    #[serde(default)]
    preload: Vec<String>,
    /// 0 for none.
    #[serde(default)]
    memory_limit_mib: u64,
}

/// Calls between two looks at the memory, which take some microseconds.
const LOOK_EVERY: u32 = 16;

/// An FMU in motion.
pub(crate) struct Plant {
    instance: Instance,
    steps: Steps,
    torque: Variable,
    /// Motor, load, and the signals.
    outputs: Vec<Variable>,
    memory_limit_mib: u64,
    calls: u32,
    _own_folder: Option<TempDir>,
}

impl Plant {
    /// Unpacks and loads the FMU and starts it at time 0.
    pub(crate) fn start(settings: &Settings, period_s: f64) -> Result<Self, FmuError> {
        let mut archive = Archive::open(&settings.file)?;
        let description = Description::parse(&archive.description()?)?;
        if description.version == Version::One {
            return Err(FmuError::Version(description.version.to_string()));
        }
        let fmu = description.co_simulation.as_ref().ok_or(FmuError::NoCoSimulation)?;
        let binary = binary(&description, fmu, &archive)?;
        let named = |name: &str, key: &str, role| find(&description.variables, name, key, role).cloned();
        let torque = named(&settings.torque_input, "torque_input", Role::Torque)?;
        let mut outputs = vec![
            named(&settings.motor_output, "motor_output", Role::Position)?,
            named(&settings.load_output, "load_output", Role::Position)?,
        ];
        for name in &settings.signals {
            outputs.push(named(name, "signals", Role::Signal)?);
        }
        let start = |(name, value): (&String, &Value)| {
            Ok((named(name, &format!("start.{name}"), Role::Start)?, value.clone()))
        };
        let start: Vec<_> = settings.start.iter().map(start).collect::<Result<_, FmuError>>()?;
        // Another name of the same variable has its reference.
        let is_torque = |it: &Variable| (it.reference, it.kind) == (torque.reference, torque.kind);
        if let Some((variable, _)) = start.iter().find(|(variable, _)| is_torque(variable)) {
            return Err(FmuError::TorqueStart { name: variable.name.clone() });
        }
        let steps = Steps::new(fmu, description.preferred_step_s, settings.step_us, period_s)?;
        let own_folder = if settings.unpack_into.is_none() { Some(tempfile::tempdir()?) } else { None };
        let folder = settings.unpack_into.as_deref().or(own_folder.as_ref().map(TempDir::path));
        let folder = folder.unwrap_or(Path::new("."));
        archive.unpack(folder)?;
        let instance = Instance::load(folder, &binary, &description, &settings.preload)?;
        for (variable, value) in &start {
            instance.set(variable, value, 0.0)?;
        }
        instance.initialize((settings.tolerance > 0.0).then_some(settings.tolerance), |instance| {
            instance.set(&torque, &Value::from(0.0), 0.0)
        })?;
        for (variable, value) in &start {
            check_start(&instance, variable, value)?;
        }
        let memory_limit_mib = settings.memory_limit_mib;
        Ok(Self { instance, steps, torque, outputs, memory_limit_mib, calls: 0, _own_folder: own_folder })
    }

    /// The signals: names and units.
    pub(crate) fn signals(&self) -> impl Iterator<Item = (&str, &str)> {
        self.outputs.iter().skip(2).map(|variable| (&*variable.name, &*variable.unit))
    }

    /// Positions of motor and load in rad, and the values of the signals, in one list.
    pub(crate) fn outputs(&self, values: &mut Vec<f64>) -> Result<(), FmuError> {
        values.clear();
        let time_s = self.steps.time_s();
        for variable in &self.outputs {
            let value = self.instance.get(variable, time_s)?;
            if !value.is_finite() {
                let name = variable.name.clone();
                return Err(FmuError::NotFinite { name, value, time_s });
            }
            values.push(value);
        }
        Ok(())
    }

    /// Holds a torque.
    pub(crate) fn step(&mut self, torque_nm: f64, held_s: f64) -> Result<(), FmuError> {
        self.instance.set(&self.torque, &Value::from(torque_nm), self.steps.time_s())?;
        for step in self.steps.hold(held_s)? {
            self.instance.step(step)?;
        }
        self.calls = self.calls.wrapping_add(1);
        if self.memory_limit_mib > 0 && self.calls.is_multiple_of(LOOK_EVERY) {
            let (taken_mib, limit_mib) = (taken_mib(), self.memory_limit_mib);
            if taken_mib > limit_mib {
                return Err(FmuError::Memory { taken_mib, limit_mib, time_s: self.steps.time_s() });
            }
        }
        Ok(())
    }

    /// Ends the FMU in the order that FMI demands.
    pub(crate) fn end(self) {
        self.instance.end();
    }
}

/// Memory that this process has taken, in MiB; 0 if the system doesn't say. proc_pid_statm(5): pages in memory are the second number.
fn taken_mib() -> u64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages: u64 = statm.split(' ').nth(1).and_then(|it| it.parse().ok()).unwrap_or_default();
    (pages * rustix::param::page_size() as u64) >> 20
}

/// Path of the library in the archive.
fn binary(description: &Description, fmu: &CoSimulation, archive: &Archive) -> Result<PathBuf, FmuError> {
    let found = archive.platforms();
    let arch = std::env::consts::ARCH;
    let of_three = format!("{arch}-linux");
    // FMI 2.0 has no names for further processors; tools use those of 3.0.
    let wanted = match (description.version, arch) {
        (Version::Three, _) => of_three,
        (_, "x86_64") => "linux64".to_owned(),
        (_, "x86") => "linux32".to_owned(),
        _ => of_three,
    };
    if found.contains(&wanted) {
        return Ok(Path::new("binaries").join(wanted).join(format!("{}.so", fmu.identifier)));
    }
    let remedy = if archive.has_sources() {
        "it has C sources: `fmpy compile` builds them"
    } else {
        "export it on Linux, or for this platform"
    };
    let found = if found.is_empty() { "no platform".to_owned() } else { found.join(", ") };
    Err(FmuError::Platform { found, wanted, remedy })
}

/// Reads a start value back: an FMU may ignore it without a word.
fn check_start(instance: &Instance, variable: &Variable, value: &Value) -> Result<(), FmuError> {
    let want = value.as_f64().or(value.as_bool().map(f64::from));
    let Some(want) = want.filter(|_| variable.kind.is_number() && !variable.is_approximate) else {
        return Ok(());
    };
    let have = instance.get(variable, 0.0)?;
    // Single precision rounds. NaN doesn't pass.
    let is_same = (have - want).abs() <= 1e-6 * want.abs();
    if !is_same {
        return Err(FmuError::StartIgnored { name: variable.name.clone(), have, want });
    }
    Ok(())
}
