//! `[bench]`: what lies at the pins of the drive in bench mode, and what bench mode rules out.
//!
//! Bench mode has no simulator between drive and pins. A key that acts on samples, on torques or on the simulated plant
//! has no effect there, so it is an error.

use serde::Serialize;

use super::controller::{ParameterSetting, ParameterValue, serialize_parameters};
use super::declare::{Field, choice, field, integer, name_of, number};
use super::key::Choice;
use super::plant::PlantSettings;
use super::range::positive;
use super::reader::Section;
use super::sections::{EncoderSettings, LineSettings, LinkSettings, OnLoss};
use crate::process_plant;
use crate::settings;

/// Key of the scale of the power stage.
const TORQUE_PER_DUTY_NM: &str = "torque_per_duty_nm";

/// Parameter of the law of a drive that takes its reference as a torque: N m for a reference of 1 rad.
pub const TORQUE_PER_RAD_NM: &str = "torque_per_rad_nm";

/// Numbers of `[bench]`: key, range and meaning. Each is the drive's parameter of that name.
const NUMBERS: [(&str, f64, f64, &str); 5] = [
    (TORQUE_PER_DUTY_NM, 1e-3, 1e5, "Torque at the motor for a duty of 1 more than `duty_offset`."),
    ("duty_offset", 0.0, 1.0, "Duty of no torque."),
    ("duty_min", 0.0, 1.0, "Smallest duty of the amplifier."),
    ("duty_max", 0.0, 1.0, "Largest duty of the amplifier."),
    ("twist_limit_rad", 1e-3, 1e5, "Largest plausible change of the twist since the start, at the motor."),
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

settings! {
    /// Where the load stands at the first step.
    #[derive(Default)]
    pub enum BenchStart {
        /// at `[plant.initial]`; a load that stands elsewhere ends the run
        default "initial" => Initial,
        /// anywhere; only for a law that takes its reference as a torque
        "anywhere" => Anywhere,
    }
}

settings! {
    /// `[bench]`: parameters of the drive that describe its pins, of which an absent one keeps the drive's default; and its
    /// reports.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct BenchSettings {
        /// Where the load stands at the first step.
        pub start: BenchStart = choice().or(BenchStart::default()),
        /// Largest distance of the load from zero in both directions, or from its first position with `start = "anywhere"`. A load
        /// beyond it ends the run.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub load_travel_limit_rad: Option<f64> = number(positive(1e4)).optional(),
        /// Control steps for each report of the drive, and for each reference: a line of 921,600 baud takes one of each in
        /// a millisecond. The record repeats the last measurement in between.
        #[serde(skip_serializing_if = "is_one")]
        pub sample_every: u32 = integer(1..=1000).or(1),
        /// The parameters that are given.
        #[serde(flatten, serialize_with = "serialize_parameters")]
        pub parameters: Vec<ParameterSetting> = pins(),
    }
}

fn is_one(number: &u32) -> bool {
    *number == 1
}

/// The keys of the pins. Each is an optional parameter of the drive.
fn pins() -> impl Field<Value = Vec<ParameterSetting>> {
    field(|_, _, bench| {
        let mut parameters = Vec::new();
        let mut take = |key: &str, value: Option<ParameterValue>, origin| {
            let name = key.to_owned();
            parameters.extend(value.map(|value| ParameterSetting { section: "bench", name, value, origin }));
        };
        for (key, low, high, doc) in NUMBERS {
            let number = number(low..=high).optional().read(key, doc, bench);
            take(key, number.map(ParameterValue::Number), bench.origin_of(key));
        }
        let direction = |name, doc| Choice { name, doc };
        for (key, doc) in DIRECTIONS {
            let names =
                vec![direction("forward", "as wired"), direction("reverse", "with the opposite sign")];
            let name = name_of(names).optional().read(key, doc, bench);
            take(key, name.map(ParameterValue::Text), bench.origin_of(key));
        }
        parameters
    })
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

/// Rejects what has no effect in bench mode, or may not happen there.
pub(super) fn check(
    root: &Section<'_>,
    plant: &PlantSettings,
    encoders: &EncoderSettings,
    line: &LineSettings,
    link: &LinkSettings,
) {
    let pins = "has no effect in bench mode, whose plant is at the pins; omit it";
    let torque = "has no effect in bench mode, whose torque goes to the pins; omit it";
    let resume = "is not available in bench mode: a real motor must not start again by itself; omit it";
    let noise = "has no effect in bench mode, whose encoders are real; omit it";
    let process = "belongs to a simulated loop, which bench mode doesn't have; take another model";
    let moving = plant.initial.load_velocity_rad_s != 0.0 || plant.initial.motor_velocity_rad_s != 0.0;
    for (is_wrong, key, reason) in [
        (true, "plant.load_torque", pins),
        (true, "plant.wear", pins),
        (plant.torque_delay_us() > 0, "plant.torque_delay_us", pins),
        (plant.model.name() == process_plant::NAME, "plant.model", process),
        (moving, "plant.initial", "has a velocity, but a bench starts at rest; omit the velocities"),
        (encoders.noise_counts > 0.0, "encoders.noise_counts", noise),
        (line.delay_us > 0, "line.delay_us", torque),
        (line.jitter_us > 0, "line.jitter_us", torque),
        (line.loss > 0.0, "line.loss", torque),
        (link.on_loss == OnLoss::Resume, "link.on_loss", resume),
    ] {
        if is_wrong {
            root.reject(key, reason);
        }
    }
}
