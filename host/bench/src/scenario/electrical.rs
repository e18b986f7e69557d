//! `[plant.electrical]`: a motor on a bridge between the torque that the drive commands and the plant.

use lashloop_firmware::torque::{BridgeReading, Motor, SensorOffset, TorqueControl, TorqueSource};
use lashloop_plant::electrical::{
    ElectricalParameters, ElectricalPlant, REST_READINGS, StageControl, StageReading, keys,
};
use lashloop_plant::{Plant, PlantError, PlantValues};
use serde::{Serialize, Serializer};

use super::declare::{Field as _, Named, choice, number};
use super::key::Choice;
use super::plant_keys;
use super::reader::Section;

/// Separates the noise of the current sensor from that of the encoders.
const SENSOR_STREAM: u64 = 0xc2b2_ae3d_27d4_eb4f;
/// Steps of the drive's converter to the end of the sensor's range, in one direction.
const CONVERTER_STEPS: f64 = 32_768.0;

const _: () =
    assert!(REST_READINGS >= SensorOffset::READINGS as usize, "the drive knows its offset at the first step");

/// The motor's circuit, and what of the drive is between a torque and its voltage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElectricalSettings {
    /// What makes the torque of a command.
    #[serde(serialize_with = "as_name")]
    pub torque_source: TorqueSource,
    /// Resistance and inductance that the drive believes in, relative to the true ones.
    pub believed_factor: f64,
    /// The values of the circuit's keys.
    #[serde(flatten)]
    pub values: PlantValues,
}

fn as_name<S: Serializer>(source: &TorqueSource, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(source.choice().name)
}

impl Named for TorqueSource {
    const ALL: &'static [Self] = &[Self::Amplifier, Self::Voltage, Self::Current];

    fn choice(self) -> Choice {
        let (name, doc) = match self {
            Self::Amplifier => {
                ("amplifier", "The duty is the torque over a scale, which is right at standstill.")
            }
            Self::Voltage => ("voltage", "The drive adds the back-EMF to the voltage of the torque."),
            Self::Current => {
                ("current", "The drive controls the measured current, once in a period of the modulation.")
            }
        };
        Choice { name, doc }
    }
}

impl ElectricalSettings {
    pub(super) fn read(section: &mut Section<'_>) -> Self {
        let torque_source = choice::<TorqueSource>().or(TorqueSource::Current).read(
            "torque_source",
            "What makes the torque of a command.",
            section,
        );
        let doc = "Resistance and inductance that the drive believes in, relative to the true ones.";
        let believed_factor = number(0.5..=2.0).or(1.0).read("believed_factor", doc, section);
        let values = plant_keys::read(section, &keys());
        Self { torque_source, believed_factor, values }
    }

    /// A plant behind the bridge; `seed` starts the noise of the sensor.
    ///
    /// # Errors
    /// A value is outside its range.
    pub(super) fn behind_bridge(
        &self,
        plant: Box<dyn Plant>,
        seed: u64,
    ) -> Result<Box<dyn Plant>, PlantError> {
        let parameters = ElectricalParameters::of_all(&self.values)?;
        let control = Box::new(DriveStage::new(self, &parameters));
        Ok(Box::new(ElectricalPlant::new(plant, parameters, control, seed ^ SENSOR_STREAM)?))
    }
}

/// The drive's own code between a torque and the duty.
struct DriveStage {
    /// `None` for a stage whose duty is the torque over a scale.
    control: Option<TorqueControl>,
    /// Torque at standstill for the whole voltage of the supply, in N m.
    full_scale_nm: f64,
    sense_range_a: f64,
    offset: SensorOffset,
}

impl DriveStage {
    fn new(settings: &ElectricalSettings, parameters: &ElectricalParameters) -> Self {
        let ElectricalParameters { resistance_ohm, inductance_h, torque_constant_nm_a, .. } = *parameters;
        let motor = Motor {
            resistance_ohm: (resistance_ohm * settings.believed_factor) as f32,
            inductance_h: (inductance_h * settings.believed_factor) as f32,
            torque_constant_nm_a: torque_constant_nm_a as f32,
        };
        Self {
            control: match settings.torque_source {
                TorqueSource::Amplifier => None,
                TorqueSource::Voltage => Some(TorqueControl::by_voltage(motor, 1.0)),
                TorqueSource::Current => {
                    Some(TorqueControl::by_current(motor, (1.0 / parameters.pwm_hz) as f32, 1.0))
                }
            },
            full_scale_nm: parameters.supply_v * torque_constant_nm_a / resistance_ohm,
            sense_range_a: parameters.sense_range_a,
            offset: SensorOffset::default(),
        }
    }

    fn converter(current: f64) -> u32 {
        (CONVERTER_STEPS * (1.0 + current)) as u32
    }
}

impl StageControl for DriveStage {
    fn rest(&mut self, current: f64) {
        self.offset.take(Self::converter(current));
    }

    fn duty(&mut self, reading: &StageReading) -> f64 {
        let StageReading { torque_nm, current, bus_v, speed_rad_s } = *reading;
        let Some(control) = &mut self.control else { return torque_nm / self.full_scale_nm };
        let above = Self::converter(current) as f32 - self.offset.reading().unwrap_or(CONVERTER_STEPS as f32);
        let current_a = above * (self.sense_range_a / CONVERTER_STEPS) as f32;
        let reading = BridgeReading { current_a, bus_v: bus_v as f32 };
        control.duty(torque_nm as f32, speed_rad_s as f32, &reading).into()
    }
}
