//! `[bench]`: what lies at the pins of the drive in bench mode, and what bench mode rules out.
//!
//! Bench mode has no simulator between drive and pins. A key that acts on samples, on torques or on the simulated plant
//! has no effect there, so it is an error.

use lashloop_firmware::drive::PinParameters;
use lashloop_firmware::law::{Parameter, ParameterGroup, Range};
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

/// The parameters of bench mode that are keys of `[bench]`, with their meaning. Ranges and choices are those of the drive.
const PINS: [(&str, &str); 40] = [
    (TORQUE_PER_DUTY_NM, "Torque at the motor for a duty of 1 more than `duty_offset`."),
    ("duty_offset", "Duty of no torque."),
    ("duty_min", "Smallest duty of the amplifier."),
    ("duty_max", "Largest duty of the amplifier."),
    ("twist_limit_rad", "Largest plausible change of the twist since the start, at the motor."),
    ("motor_direction", "Direction of the motor encoder."),
    ("load_direction", "Direction of the load encoder."),
    ("torque_direction", "Direction of the power stage."),
    ("encoder_filter_ns", "Pulses on a channel of an encoder up to this length are noise."),
    ("stage_mode", "What the outputs mean to the power stage."),
    ("pwm_frequency_hz", "Frequency of the pulse-width modulation."),
    ("torque_source", "What makes the torque of a command."),
    ("motor_resistance_ohm", "Resistance of the motor with that of the bridge."),
    ("motor_inductance_h", "Inductance of the motor."),
    ("torque_constant_nm_a", "Torque constant of the motor; that of its back-EMF is equal."),
    ("supply_v", "Voltage of the bus where nothing measures it."),
    ("current_range_a", "Current that takes the converter of the sensor from the middle to its end."),
    ("current_direction", "Direction of the current sensor."),
    ("supply_range_v", "Voltage of the bus at the end of its converter."),
    ("current_limit_a", "Largest current by command; beyond 1.5 of it the drive switches the bridge off."),
    ("supply_min_v", "Smallest voltage of the bus."),
    ("supply_max_v", "Largest voltage of the bus."),
    ("brake_on_v", "Voltage of the bus from which on a brake resistor is on, until 3 % less."),
    ("torque_slew_nm_s", "Fastest change of the torque."),
    ("motor_travel_min_rad", "Least position of the motor from the zero of its encoder."),
    ("motor_travel_max_rad", "Largest position of the motor from the zero of its encoder."),
    ("load_travel_min_rad", "Least position of the load from the zero of its encoder."),
    ("load_travel_max_rad", "Largest position of the load from the zero of its encoder."),
    ("stall_time_s", "Longest time at 0.9 of the torque limit or more in which neither encoder moves."),
    ("missing_torque_time_s", "Longest time in which the measured torque is less than half the command."),
    ("torque_continuous_nm", "Torque that the motor bears forever."),
    ("motor_thermal_s", "Thermal time constant of the winding."),
    ("current_continuous_a", "Current that the bridge bears forever."),
    ("stage_thermal_s", "Thermal time constant of the bridge."),
    ("enable_input", "Contact without which the drive neither arms nor runs, by when it is active."),
    ("negative_limit_input", "Contact that ends a torque towards negative positions."),
    ("positive_limit_input", "Contact that ends a torque towards positive positions."),
    ("home_input", "Contact at the zero of both encoders."),
    (
        "index_input",
        "Encoder whose index pulse is at its zero; with home_input, the pulse while that contact is active.",
    ),
    ("rig_id", "Number of the rig."),
];

/// The drive's parameter of bench mode with this name.
fn parameter(name: &str) -> &'static Parameter {
    let found = PinParameters::TABLE.iter().find(|it| it.name == name);
    found.unwrap_or_else(|| panic!("the drive has no parameter {name}"))
}

/// The number that was written in the source of the drive.
fn written(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(number.into())
}

/// The key of a parameter that describes the pins; `None` for any other parameter. One place alone sets it, because a rig
/// replaces what a scenario has there.
#[must_use]
pub fn key_of_pin(parameter: &str) -> Option<String> {
    PINS.iter().find(|(name, _)| *name == parameter).map(|(name, _)| format!("bench.{name}"))
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
        for (key, doc) in PINS {
            let value = match parameter(key).range {
                Range::F32 { min, max, .. } => {
                    let number = number(written(min)..=written(max)).optional().read(key, doc, bench);
                    number.map(ParameterValue::Number)
                }
                Range::U32 { min, max, .. } => {
                    let number = integer(min..=max).optional().read(key, doc, bench);
                    number.map(|number| ParameterValue::Number(number.into()))
                }
                Range::Choice { names, .. } => {
                    let choices = names.iter().map(|name| Choice { name, doc: "" }).collect();
                    name_of(choices).optional().read(key, doc, bench).map(ParameterValue::Text)
                }
            };
            take(key, value, bench.origin_of(key));
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
    let error = "has no effect in bench mode, whose encoders are real; omit it";
    let process = "belongs to a simulated loop, which bench mode doesn't have; take another model";
    let moving = plant.initial.load_velocity_rad_s != 0.0 || plant.initial.motor_velocity_rad_s != 0.0;
    for (is_wrong, key, reason) in [
        (true, "plant.load_torque", pins),
        (true, "plant.wear", pins),
        (plant.torque_delay_us() > 0, "plant.torque_delay_us", pins),
        (process_plant::is_process(plant.model.name()), "plant.model", process),
        (moving, "plant.initial", "has a velocity, but a bench starts at rest; omit the velocities"),
        (line.delay_us > 0, "line.delay_us", torque),
        (line.jitter_us > 0, "line.jitter_us", torque),
        (line.loss > 0.0, "line.loss", torque),
        (link.on_loss == OnLoss::Resume, "link.on_loss", resume),
    ] {
        if is_wrong {
            root.reject(key, reason);
        }
    }
    for (key, _) in encoders.errors().into_iter().filter(|(_, value)| *value > 0.0) {
        root.reject(key, error);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_of_the_pins_is_a_key() {
        let by_others = ["sample_source", "bench_sample_every"];
        let of_drive = PinParameters::TABLE.iter().map(|it| it.name).filter(|name| !by_others.contains(name));
        let missing: Vec<_> = of_drive.filter(|name| key_of_pin(name).is_none()).collect();
        assert!(missing.is_empty(), "{missing:?}");
        assert!(PINS.iter().all(|(name, _)| parameter(name).name == *name));
    }
}
