//! A brushed motor at the bridge, with its supply and the sensor of its current.

use std::time::Duration;

use lashloop_plant::Plant;
use lashloop_plant::electrical::{Bridge, Circuit, CurrentSensor, ElectricalParameters};

use crate::pins::Pins;

/// From the middle between two samples to the look at what is driven from there on.
const LATER: Duration = Duration::from_nanos(200);

/// How the outputs of the chip are wired to the bridge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BridgeInputs {
    /// The first output has the pulses, the second one the direction.
    PwmDirection,
    /// An input for each half-bridge, or the gates of both.
    Halves,
}

/// A motor, and what the chip sees of it.
pub struct MotorAtBridge {
    circuit: Circuit,
    sensor: CurrentSensor,
    inputs: BridgeInputs,
    bus_range_v: f64,
    /// What the bridge does until the next look.
    bridge: Bridge,
    /// Position before the last step, and its length in s.
    last: Option<(f64, f64)>,
    speed_rad_s: f64,
}

impl MotorAtBridge {
    /// A motor without current. `bus_range_v` is the voltage of the bus that takes its converter to its end; `seed` starts the noise of the
    /// sensor.
    #[must_use]
    pub fn new(parameters: ElectricalParameters, inputs: BridgeInputs, bus_range_v: f64, seed: u64) -> Self {
        Self {
            circuit: Circuit::new(parameters),
            sensor: CurrentSensor::new(seed),
            inputs,
            bus_range_v,
            bridge: Bridge::Off,
            last: None,
            speed_rad_s: 0.0,
        }
    }

    /// The circuit.
    pub fn circuit(&mut self) -> &mut Circuit {
        &mut self.circuit
    }

    /// Advances the circuit of the motor of this plant. Returns the mean torque in N m.
    pub(crate) fn step(&mut self, plant: &dyn Plant, dt_s: f64) -> f64 {
        let position_rad = plant.positions().motor_position_rad;
        if let Some((before_rad, last_s)) = self.last.replace((position_rad, dt_s)) {
            self.speed_rad_s = (position_rad - before_rad) / last_s;
        }
        let mean_a = self.circuit.step(self.bridge, self.speed_rad_s, dt_s);
        self.circuit.parameters().torque_constant_nm_a * mean_a
    }

    /// Takes what the chip drives, and puts the sensor's voltages on its pins.
    pub(crate) fn look(&mut self, chip: &mut Pins<'_>) {
        // Outputs that are off are low, and so is the enable line of a bridge that has one.
        self.bridge = chip.driving_channels().map_or(Bridge::Off, |[first, second]| {
            Bridge::Driving(match self.inputs {
                BridgeInputs::PwmDirection if second > 0.5 => first,
                BridgeInputs::PwmDirection => -first,
                BridgeInputs::Halves => first - second,
            })
        });
        let current = self.sensor.read(self.circuit.parameters(), self.circuit.current_a());
        chip.drive_bridge_sensor(0.5 * (1.0 + current), self.circuit.bus_v() / self.bus_range_v);
    }

    /// Half a period of the modulation, and a little: a new duty takes effect in the middle between two samples.
    pub(crate) fn half_period(&self) -> Duration {
        Duration::from_secs_f64(0.5 / self.circuit.parameters().pwm_hz) + LATER
    }

    /// The other half, up to the next sample.
    pub(crate) fn least_half_period(&self) -> Duration {
        self.half_period() - 2 * LATER
    }
}
