//! `[bench]`: what lies at the pins of the drive in bench mode, and what bench mode rules out.
//!
//! Bench mode has no simulator between drive and pins. A key that acts on samples, on torques or on the simulated plant
//! has no effect there, so it is an error.

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::controller::{ParameterSetting, ParameterValue};
use super::error::ScenarioError;
use super::key::Choice;
use super::key_error::KeyError;
use super::plant::PlantSettings;
use super::range::positive;
use super::reader::Section;
use super::sections::{EncoderSettings, LineSettings, LinkSettings, OnLoss};
use crate::process_plant;
use lashloop_plant::TORQUE_DELAY_US;

/// Key of where the load stands at the first step.
const START: &str = "start";
/// Key of the travel.
const LOAD_TRAVEL_LIMIT_RAD: &str = "load_travel_limit_rad";
/// Key of the scale of the power stage.
const TORQUE_PER_DUTY_NM: &str = "torque_per_duty_nm";

/// Key of the interval of the reports.
pub const SAMPLE_EVERY: &str = "sample_every";
/// Parameter of the law of a drive that takes its reference as a torque: N m for a reference of 1 rad.
pub const TORQUE_PER_RAD_NM: &str = "torque_per_rad_nm";

/// Numbers of `[bench]`: key, unit, range and meaning. Each is the drive's parameter of that name.
const NUMBERS: [(&str, &str, f64, f64, &str); 5] = [
    (TORQUE_PER_DUTY_NM, "N m", 1e-3, 1e5, "Torque at the motor for a duty of 1 more than `duty_offset`."),
    ("duty_offset", "", 0.0, 1.0, "Duty of no torque."),
    ("duty_min", "", 0.0, 1.0, "Smallest duty of the amplifier."),
    ("duty_max", "", 0.0, 1.0, "Largest duty of the amplifier."),
    (
        "twist_limit_rad",
        "rad",
        1e-3,
        1e5,
        "Largest plausible change of the twist since the start, at the motor.",
    ),
];

/// Directions of `[bench]`: key and meaning.
const DIRECTIONS: [(&str, &str); 3] = [
    ("motor_direction", "Direction of the motor encoder."),
    ("load_direction", "Direction of the load encoder."),
    ("torque_direction", "Direction of the power stage."),
];

/// The key of a parameter that describes the pins; `None` for any other parameter. One place alone sets it, because a rig
/// replaces what a scenario has there.
#[must_use]
pub fn key_of_pin(parameter: &str) -> Option<String> {
    let names = NUMBERS.iter().map(|it| it.0).chain(DIRECTIONS.iter().map(|it| it.0));
    names.into_iter().find(|name| *name == parameter).map(|name| format!("bench.{name}"))
}

/// Where the load stands at the first step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BenchStart {
    /// At `[plant.initial]`, to which the reference is relative. A load that stands elsewhere ends the run.
    #[default]
    Initial,
    /// Anywhere: only for a law whose reference is a torque.
    Anywhere,
}

const STARTS: [(&str, BenchStart, &str); 2] = [
    ("initial", BenchStart::Initial, "at `[plant.initial]`; a load that stands elsewhere ends the run"),
    ("anywhere", BenchStart::Anywhere, "anywhere; only for a law that takes its reference as a torque"),
];

/// `[bench]`: parameters of the drive that describe its pins, of which an absent one keeps the drive's default; and its
/// reports.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchSettings {
    /// Where the load stands at the first step.
    pub start: BenchStart,
    /// Largest distance of the load from zero, or from its first position if it starts anywhere; `None` for no limit.
    pub load_travel_limit_rad: Option<f64>,
    /// The parameters that are given.
    pub parameters: Vec<ParameterSetting>,
    /// Control steps for each report of the drive, and for each reference of the bench; 1 or more.
    pub sample_every: u32,
}

impl Default for BenchSettings {
    fn default() -> Self {
        Self {
            start: BenchStart::default(),
            load_travel_limit_rad: None,
            parameters: Vec::new(),
            sample_every: 1,
        }
    }
}

impl BenchSettings {
    /// Torque for a duty of 1 more than that of no torque, in N m; `None` if the scenario leaves it to the drive.
    #[must_use]
    pub fn torque_per_duty_nm(&self) -> Option<f64> {
        let setting = self.parameters.iter().find(|setting| setting.name == TORQUE_PER_DUTY_NM)?;
        if let ParameterValue::Number(number) = setting.value { Some(number) } else { None }
    }

    /// Whether the section is absent or empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl Serialize for BenchSettings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut keys = serializer.serialize_map(None)?;
        let chosen = STARTS.iter().find(|(_, start, _)| *start == self.start && !self.is_empty());
        if let Some((name, ..)) = chosen {
            keys.serialize_entry(START, name)?;
        }
        if let Some(limit_rad) = self.load_travel_limit_rad {
            keys.serialize_entry(LOAD_TRAVEL_LIMIT_RAD, &limit_rad)?;
        }
        if self.sample_every > 1 {
            keys.serialize_entry(SAMPLE_EVERY, &self.sample_every)?;
        }
        for setting in &self.parameters {
            keys.serialize_entry(&setting.name, &setting.value)?;
        }
        keys.end()
    }
}

pub(super) fn read(bench: &mut Section<'_>) -> BenchSettings {
    let mut parameters = Vec::new();
    let mut add = |bench: &Section<'_>, key: &str, value| {
        parameters.push(ParameterSetting { name: key.to_owned(), value, origin: bench.origin_of(key) });
    };
    for (key, unit, low, high, doc) in NUMBERS {
        if let Some(number) = bench.doc(doc).optional_number(key, unit, low..=high) {
            add(bench, key, ParameterValue::Number(number));
        }
    }
    for (key, doc) in DIRECTIONS {
        let choice = |name, doc| Choice { name, doc };
        let meanings = vec![choice("forward", "as wired"), choice("reverse", "with the opposite sign")];
        let names = [("forward", "forward"), ("reverse", "reverse")];
        if let Some(name) = bench.doc(doc).choice_docs(meanings).optional_choice(key, &names) {
            add(bench, key, ParameterValue::Text(name.to_owned()));
        }
    }
    let docs = STARTS.map(|(name, _, doc)| Choice { name, doc }).to_vec();
    let names = STARTS.map(|(name, start, _)| (name, start));
    let doc = "Where the load stands at the first step.";
    let start =
        bench.doc(doc).choice_docs(docs).choice(START, BenchStart::Initial, &names).unwrap_or_default();
    let doc = "Largest distance of the load from zero, either way, or from its first position with `start = \"anywhere\"`. A load beyond it ends the run.";
    let load_travel_limit_rad = bench.doc(doc).optional_number(LOAD_TRAVEL_LIMIT_RAD, "rad", positive(1e4));
    let doc = "Control steps for each report of the drive, and for each reference: a line of 921,600 baud takes one of each in a \
               millisecond. The record repeats the last measurement in between.";
    let sample_every = bench.doc(doc).integer(SAMPLE_EVERY, 1, 1..=1000);
    BenchSettings { start, load_travel_limit_rad, parameters, sample_every }
}

impl ScenarioError {
    /// The error for a value of `[bench]` that the drive rejects, which shows only after connecting.
    #[must_use]
    pub fn of_bench(setting: &ParameterSetting, reason: impl Into<String>) -> Self {
        Self::Key {
            origin: setting.origin.clone(),
            key: format!("bench.{}", setting.name),
            error: Box::new(KeyError::Rejected { found: setting.value.to_string(), reason: reason.into() }),
        }
    }
}

/// Rejects noise: the encoders are those at the pins.
pub(super) fn check_encoders(section: &Section<'_>, encoders: &EncoderSettings) {
    if encoders.noise_counts > 0.0 {
        section.reject(
            "noise_counts",
            "has no effect in bench mode, whose encoders are real; omit it".to_owned(),
        );
    }
}

/// Rejects a modelled line: the torque goes to the power stage.
pub(super) fn check_line(section: &Section<'_>, line: &LineSettings) {
    let given =
        [("delay_us", line.delay_us > 0), ("jitter_us", line.jitter_us > 0), ("loss", line.loss > 0.0)];
    for (key, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
        section.reject(key, "has no effect in bench mode, whose torque goes to the pins; omit it".to_owned());
    }
}

/// Rejects what changes a plant while it runs.
pub(super) fn check_plant(section: &Section<'_>, plant: &PlantSettings) {
    let reason = || "has no effect in bench mode, whose plant is at the pins; omit it".to_owned();
    for key in ["load_torque", "wear"] {
        section.reject(key, reason());
    }
    if plant.torque_delay_us() > 0 {
        section.reject(TORQUE_DELAY_US, reason());
    }
    if plant.model.name() == process_plant::NAME {
        section.reject(
            "model",
            "belongs to a simulated loop, which bench mode doesn't have; take another model".to_owned(),
        );
    }
    if plant.initial.load_velocity_rad_s != 0.0 || plant.initial.motor_velocity_rad_s != 0.0 {
        section
            .reject("initial", "has a velocity, but a bench starts at rest; omit the velocities".to_owned());
    }
}

/// Rejects a start without a person at the bench.
pub(super) fn check_link(section: &Section<'_>, link: &LinkSettings) {
    if link.on_loss == OnLoss::Resume {
        let reason = "is not available in bench mode: a real motor must not start again by itself; omit it";
        section.reject("on_loss", reason.to_owned());
    }
}
