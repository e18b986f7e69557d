//! `record.json`: what was run. Written before the first step.

use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use lashloop_bench::atomic_file::{WriteError, write_whole};
use lashloop_bench::device::{Evidence, FileHash};
use lashloop_bench::process_plant;
use lashloop_bench::regular_file;
use lashloop_bench::run::digest::sha256;
use lashloop_bench::run::real_time::RealTime;
use lashloop_bench::run::{Clock, RunStart};
use lashloop_bench::scenario::{RunMode, Scenario};
use lashloop_bench::timing::ClockName;
use lashloop_plant::Signal;
use lashloop_protocol::enums::ParameterValue;
use lashloop_session::Parameter;
use serde::{Deserialize, Serialize};

use crate::file_names::MANIFEST_FILE;
use crate::host_facts::HostFacts;
use crate::samples::StepTimes;
use crate::source::{Overridden, RunSource};
use crate::summary::Versions;

/// The format of the folder. In format 2, whose records are read too, `run.mcap` has messages of ROS 1 at times from 0.
pub const FORMAT: u32 = 3;

/// What was run, with what, and where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Format of the folder.
    pub format: u32,
    /// The words of the command line.
    pub command_line: Vec<String>,
    /// Folder that relative paths of the command line start from; null if it was removed.
    pub working_directory: Option<String>,
    /// Start of the run in UTC, as RFC 3339. The times of the samples count from it.
    pub started: String,
    /// The scenario; `scenario.toml` has every key of it.
    pub scenario: ScenarioFile,
    /// What was set instead of the file's values.
    pub overrides: Vec<Overridden>,
    /// Seed of every random stream of the run.
    pub seed: u64,
    /// The mode.
    pub mode: RunMode,
    /// What paced the run.
    pub clock: ClockName,
    /// How the bench kept time in real time; left out in lockstep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub real_time: Option<RealTimeOptions>,
    /// Control period.
    pub period_us: u32,
    /// The device as `--device` takes it.
    pub device: String,
    /// The rig file as the user named it; left out without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rig: Option<String>,
    /// The device as one line of text.
    pub device_description: String,
    /// The files that ran as the drive, with their hashes, and what casts doubt on their origin.
    pub evidence: Evidence,
    /// The files that ran as the plant, with their hashes, if it is a process.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plant_files: Vec<FileHash>,
    /// The computer.
    pub host: HostFacts,
    /// Versions of tool, protocol and firmware.
    pub versions: Versions,
    /// The control law.
    pub law: String,
    /// Every parameter of the drive with its value at the start.
    pub parameters: Vec<ParameterInForce>,
    /// Period of the telemetry in steps; 0 for none.
    pub telemetry_every_steps: u16,
    /// Every signal that the drive has described.
    pub signals: Vec<DescribedSignal>,
    /// The signals of the plant.
    pub plant_signals: Vec<NamedUnit>,
}

/// The options of `lashloop run --clock real-time`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RealTimeOptions {
    /// Busy-waiting before each step.
    pub spin_us: u64,
    /// Priority under SCHED_FIFO; null for the normal scheduler.
    pub fifo: Option<u8>,
    /// Whether the bench's memory was locked.
    pub lock_memory: bool,
    /// Core of the loop; null for any.
    pub core: Option<usize>,
}

impl From<RealTime> for RealTimeOptions {
    fn from(RealTime { spin, fifo_priority, lock_memory, core }: RealTime) -> Self {
        Self { spin_us: spin.as_micros() as u64, fifo: fifo_priority, lock_memory, core }
    }
}

impl From<RealTimeOptions> for RealTime {
    fn from(RealTimeOptions { spin_us, fifo, lock_memory, core }: RealTimeOptions) -> Self {
        Self { spin: Duration::from_micros(spin_us), fifo_priority: fifo, lock_memory, core }
    }
}

/// The file of a scenario.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScenarioFile {
    /// The title.
    pub name: String,
    /// Path as the user named it.
    pub path: String,
    /// SHA-256 of the file in hexadecimal; null without a file.
    pub sha256: Option<String>,
}

/// A parameter of the drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterInForce {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: Number,
    /// Name of the value, for a parameter with choices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choice: Option<String>,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Its value after power-up.
    pub default: Number,
    /// Whether the law in force has it.
    pub of_law: bool,
}

/// A number of the drive, with the digits that restore its bits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Number {
    /// A whole number.
    Whole(u32),
    /// A real number.
    Real(#[serde(with = "real")] f32),
    /// A value of a type that only a newer drive has.
    Unknown {
        /// Byte of the type.
        ty: u8,
        /// The value, little endian.
        bits: u32,
    },
}

/// A real number in JSON, which has no infinities and no NaN: these are texts.
mod real {
    use serde::{Deserialize, Deserializer, Serializer};

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Written {
        Number(f32),
        Text(String),
    }

    pub(super) fn serialize<S: Serializer>(number: &f32, serializer: S) -> Result<S::Ok, S::Error> {
        if number.is_finite() { serializer.serialize_f32(*number) } else { serializer.collect_str(number) }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
        match Written::deserialize(deserializer)? {
            Written::Number(number) => Ok(number),
            Written::Text(text) => text.parse().map_err(serde::de::Error::custom),
        }
    }
}

impl From<ParameterValue> for Number {
    fn from(value: ParameterValue) -> Self {
        match value {
            ParameterValue::U32(value) => Self::Whole(value),
            ParameterValue::F32(value) => Self::Real(value),
            ParameterValue::Unknown { ty, bytes } => {
                Self::Unknown { ty: ty.get(), bits: u32::from_le_bytes(bytes) }
            }
        }
    }
}

impl From<Number> for f64 {
    fn from(number: Number) -> Self {
        match number {
            Number::Whole(value) => value.into(),
            Number::Real(value) => value.into(),
            Number::Unknown { .. } => Self::NAN,
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(value) => value.fmt(out),
            // A real number shows that it is one.
            Self::Real(value) => write!(out, "{value:?}"),
            Self::Unknown { ty, bits } => write!(out, "{bits:#010x} (unknown {ty})"),
        }
    }
}

impl ParameterInForce {
    /// A parameter with its value at the start.
    #[must_use]
    pub fn new(parameter: &Parameter, value: ParameterValue, of_law: bool) -> Self {
        Self {
            name: parameter.name.clone(),
            value: value.into(),
            choice: parameter.choice(value).map(str::to_owned),
            unit: parameter.unit.clone(),
            default: parameter.default.into(),
            of_law,
        }
    }
}

/// A signal of the drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DescribedSignal {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Whether telemetry carried it.
    pub subscribed: bool,
}

/// Name and unit of a column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedUnit {
    /// The name.
    pub name: String,
    /// The unit; empty for a pure number.
    pub unit: String,
}

impl From<&Signal> for NamedUnit {
    fn from(Signal { name, unit }: &Signal) -> Self {
        Self { name: name.to_string(), unit: unit.to_string() }
    }
}

/// Hashes of the files of a plant in a process; those that can't be read are warnings.
fn plant_files(scenario: &Scenario, warnings: &mut Vec<String>) -> Vec<FileHash> {
    let plant = &scenario.plant;
    let files = match plant.model.name() {
        model if process_plant::is_process(model) => {
            process_plant::files(model, &plant.values, &plant.folder)
        }
        _ => Vec::new(),
    };
    let hash =
        |path: PathBuf| FileHash::new(&path, regular_file::read(&path).map(|bytes| sha256(&bytes)), warnings);
    files.into_iter().map(hash).collect()
}

impl Manifest {
    /// The manifest of a run that starts now.
    #[must_use]
    pub fn new(start: &RunStart<'_>, source: &RunSource) -> Self {
        let RunStart { scenario, clock, device, signals } = *start;
        let session = &device.session;
        let subscription = session.subscription();
        let is_subscribed = |index| subscription.signals().iter().any(|it| it.index == index);
        let law = session.laws.iter().find(|law| law.name == scenario.controller.name);
        let is_of_law = |it: &Parameter| law.is_none_or(|law| it.laws.contains(law.index));
        let parameter = |it| ParameterInForce::new(it, session.in_force(it), is_of_law(it));
        let mut evidence = device.evidence();
        let plant_files = plant_files(scenario, &mut evidence.warnings);
        Self {
            format: FORMAT,
            command_line: source.command_line.clone(),
            working_directory: source.working_directory.clone(),
            started: humantime::format_rfc3339_millis(SystemTime::now()).to_string(),
            scenario: ScenarioFile {
                name: scenario.title.clone(),
                path: scenario.name.clone(),
                sha256: source.scenario_sha256.clone(),
            },
            overrides: source.overrides.clone(),
            seed: scenario.run.seed,
            mode: scenario.run.mode,
            clock: clock.name(),
            real_time: match clock {
                Clock::Lockstep | Clock::Untimed | Clock::Scripted => None,
                Clock::RealTime(options) => Some(options.into()),
            },
            period_us: scenario.run.control_period_us,
            device: device.connection.choice.to_string(),
            rig: source.rig.clone(),
            device_description: device.description(),
            evidence,
            plant_files,
            host: HostFacts::read(),
            versions: Versions::of(&session.identity),
            law: scenario.controller.name.clone(),
            parameters: session.parameters.iter().map(parameter).collect(),
            telemetry_every_steps: subscription.every,
            signals: session
                .signals
                .iter()
                .map(|it| DescribedSignal {
                    name: it.signal.name.to_string(),
                    unit: it.signal.unit.to_string(),
                    subscribed: is_subscribed(it.index),
                })
                .collect(),
            plant_signals: signals.plant.iter().map(NamedUnit::from).collect(),
        }
    }

    /// When the steps are. A start that isn't a time counts as 1970.
    #[must_use]
    pub fn step_times(&self) -> StepTimes {
        let started = humantime::parse_rfc3339(&self.started).unwrap_or(SystemTime::UNIX_EPOCH);
        let since_1970 = started.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        StepTimes { start_ns: since_1970.as_nanos() as u64, period_us: self.period_us }
    }

    /// The content of `record.json`.
    #[must_use]
    pub fn to_json(&self) -> String {
        // No map in it has keys other than texts.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Writes `record.json`, whole.
    ///
    /// # Errors
    /// The folder doesn't exist or can't be written to.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        let text = self.to_json();
        write_whole(&folder.join(MANIFEST_FILE), ".record-", |file| file.write_all(text.as_bytes()))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A record of format 3.
    const PINNED: &str = include_str!("manifest/pinned.json");

    pub(crate) fn manifest() -> Manifest {
        serde_json::from_str(PINNED).expect("a manifest")
    }

    #[test]
    fn a_manifest_reads_back_as_it_was_written() {
        assert_eq!(manifest().to_json(), PINNED);
    }

    #[test]
    fn any_value_of_a_drive_reads_back() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, -0.0, 0.1] {
            let text = serde_json::to_string(&Number::Real(value)).expect("JSON");
            let read: Number = serde_json::from_str(&text).expect("a number");
            let Number::Real(read) = read else { panic!("{text}: {read:?}") };
            assert!(read.to_bits() == value.to_bits() || read.is_nan() && value.is_nan(), "{text}: {read}");
        }
        let unknown = Number::Unknown { ty: 77, bits: 0x0403_0201 };
        let text = serde_json::to_string(&unknown).expect("JSON");
        assert_eq!(serde_json::from_str::<Number>(&text).expect("a value"), unknown);
        assert_eq!(unknown.to_string(), "0x04030201 (unknown 77)");
    }
}
