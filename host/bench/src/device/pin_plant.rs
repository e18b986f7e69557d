//! The plant behind the pins of a drive that has no hardware there: its model, its encoders and its amplifier.

use lashloop_firmware::drive::PinParameters;
use lashloop_plant::Plant;
use serde::Serialize;

use super::error::DeviceError;
use crate::scenario::Scenario;
use crate::scenario::controller::ParameterValue;
use crate::timing::ClockName;

/// The plant behind the pins. It starts at the initial state of the scenario, and the encoders read 0 there.
#[derive(Debug, Clone)]
pub struct PinPlant {
    /// The scenario, with the scales of encoders and amplifier.
    pub scenario: Scenario,
    /// What paces the run.
    pub clock: ClockName,
}

impl PinPlant {
    /// Torque for a duty of 1 more than 0.5, in N m, for the device of this name; 0.5 gives zero torque. 0 with a motor at the bridge.
    ///
    /// # Errors
    /// The scenario lacks it.
    pub(super) fn torque_per_duty_nm(&self, device: &str) -> Result<f64, DeviceError> {
        let scale_nm = match self.scenario.plant.electrical {
            Some(_) => Some(0.0),
            None => self.scenario.bench.torque_per_duty_nm(),
        };
        scale_nm.ok_or_else(|| DeviceError::NoScale { device: device.to_owned() })
    }

    /// The plant at its start, for the device of this name, whose power stage makes the torque.
    ///
    /// # Errors
    /// A value is outside its range, or a motor is to be at the bridge.
    pub(super) fn release(&self, device: &str) -> Result<Box<dyn Plant>, DeviceError> {
        let Scenario { plant, run, .. } = &self.scenario;
        let unfit = |problem| DeviceError::Unfit { device: device.to_owned(), problem };
        if plant.electrical.is_some() {
            return Err(unfit(
                "it has no bridge for [plant.electrical]; take `silicon`, or omit the section".into(),
            ));
        }
        plant
            .release(run)
            .map_err(|error| unfit(format!("it can't have this plant behind its pins: {error}")))
    }

    /// The value that the scenario gives a parameter of the drive.
    fn parameter(&self, name: &str) -> Option<&ParameterValue> {
        let settings = &self.scenario.bench.parameters;
        settings.iter().find(|setting| setting.name == name).map(|setting| &setting.value)
    }

    /// The description of the drive train that virtual silicon reads, with an amplifier of this scale unless a motor is at the bridge.
    ///
    /// # Errors
    /// A value can't be written as JSON.
    pub fn description(&self, torque_per_duty_nm: f64) -> Result<Vec<u8>, serde_json::Error> {
        let Scenario { plant, run, encoders, .. } = &self.scenario;
        let electrical = plant.electrical.as_ref().map(|electrical| Electrical {
            values: &electrical.values,
            inputs: match self.parameter("stage_mode") {
                Some(ParameterValue::Text(mode)) if mode == "pwm-dir" => "pwm-direction",
                _ => "halves",
            },
            bus_range_v: match self.parameter("supply_range_v") {
                Some(ParameterValue::Number(volts)) => *volts,
                _ => PinParameters::default().supply_range_v.into(),
            },
            seed: run.seed,
        });
        serde_json::to_vec_pretty(&Description {
            model: plant.model.name(),
            values: &plant.values,
            start: Start {
                motor_position_rad: plant.initial.motor_position_rad,
                load_position_rad: plant.initial.load_position_rad,
            },
            period_s: run.control_period_s(),
            electrical,
            scales: Scales {
                nm_per_full_duty: torque_per_duty_nm / 2.0,
                motor_counts_per_rev: encoders.motor_counts_per_rev,
                load_counts_per_rev: encoders.load_counts_per_rev,
            },
        })
    }
}

#[derive(Serialize)]
struct Description<'a> {
    model: &'a str,
    values: &'a lashloop_plant::PlantValues,
    start: Start,
    period_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    electrical: Option<Electrical<'a>>,
    scales: Scales,
}

/// The motor at the bridge.
#[derive(Serialize)]
struct Electrical<'a> {
    #[serde(flatten)]
    values: &'a lashloop_plant::PlantValues,
    inputs: &'static str,
    bus_range_v: f64,
    seed: u64,
}

#[derive(Serialize)]
struct Start {
    motor_position_rad: f64,
    load_position_rad: f64,
}

#[derive(Serialize)]
struct Scales {
    /// At duty 1; at 0.5 the torque is 0.
    nm_per_full_duty: f64,
    motor_counts_per_rev: u32,
    load_counts_per_rev: u32,
}
