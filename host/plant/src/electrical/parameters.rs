//! The numbers of the electrical side, and their keys.

use crate::numbers::numbers;
use crate::{Key, ParameterError, PlantError, PlantValues};

/// True parameters of motor, bridge, supply and current sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElectricalParameters {
    /// Resistance R of the armature, with that of the bridge, in Ohm.
    pub resistance_ohm: f64,
    /// Inductance L of the armature in H.
    pub inductance_h: f64,
    /// Torque constant k_t in N m/A. The constant of the back-EMF in V s/rad is the same number.
    pub torque_constant_nm_a: f64,
    /// Open-circuit voltage of the supply in V.
    pub supply_v: f64,
    /// Internal resistance of the supply in Ohm.
    pub supply_resistance_ohm: f64,
    /// Capacitance of the bus in F.
    pub bus_capacitance_f: f64,
    /// What the supply does with the current of a braking motor.
    pub reverse_current: ReverseCurrent,
    /// Frequency of the modulation in Hz.
    pub pwm_hz: f64,
    /// Time in which both switches of a half-bridge are off, at each edge, in s.
    pub dead_time_s: f64,
    /// Largest current that the sensor shows, in either direction, in A.
    pub sense_range_a: f64,
    /// What the sensor shows at no current, in A.
    pub sense_offset_a: f64,
    /// Half the width of the sensor's noise, which is uniform, in A.
    pub sense_noise_a: f64,
    /// Steps of the converter over both directions, as a power of 2.
    pub sense_bits: u32,
}

/// What a supply does with a current that flows back into it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReverseCurrent {
    /// It takes the current, as a battery does.
    Taken,
    /// It blocks the current, as most power supplies do: the voltage of the bus rises.
    Blocked,
}

numbers! { ElectricalParameters, example, it:
    resistance_ohm: "resistance_ohm", "Ohm", 1e-3..=1e4, "Resistance R of the armature, with that of the bridge.";
    inductance_h: "inductance_h", "H", 1e-6..=10.0, "Inductance L of the armature.";
    torque_constant_nm_a: "torque_constant_nm_a", "N m/A", 1e-4..=1e3, "Torque constant k_t; that of the back-EMF is equal.";
    supply_v: "supply_v", "V", 1.0..=1e3, "Open-circuit voltage of the supply.";
    supply_resistance_ohm: "supply_resistance_ohm", "Ohm", 1e-3..=100.0, "Internal resistance of the supply.";
    bus_capacitance_f: "bus_capacitance_f", "F", 1e-6..=10.0, "Capacitance of the bus.";
    pwm_hz: "pwm_hz", "Hz", 1e3..=1e5, "Frequency of the modulation.";
    dead_time_s: "dead_time_s", "s", 0.0..=5e-6, "Time with both switches of a half-bridge off, at each edge.";
    sense_range_a: "sense_range_a", "A", 0.01..=1e4, "Largest current that the sensor shows, in either direction.";
    sense_offset_a: "sense_offset_a", "A", -100.0..=100.0, "What the sensor shows at no current.";
    sense_noise_a: "sense_noise_a", "A", 0.0..=100.0, "Half the width of the sensor's uniform noise.";
}

/// Keys of the electrical side, the name of the choice of [`ReverseCurrent`] included.
#[must_use]
pub fn keys() -> Vec<Key> {
    let mut keys = ElectricalParameters::keys().to_vec();
    let meaning = "What the supply does with the current of a braking motor.";
    keys.push(Key::choice("reverse_current", &["taken", "blocked"], meaning));
    let meaning = "Resolution of the converter over both directions.";
    keys.push(Key::integer("sense_bits", "", ElectricalParameters::example().sense_bits, 6..=24, meaning));
    keys
}

impl ElectricalParameters {
    /// A motor that makes the paper's 20 N m at 83 A, and turns at up to 200 rad/s.
    #[must_use]
    pub fn example() -> Self {
        Self {
            resistance_ohm: 0.5,
            inductance_h: 5e-4,
            torque_constant_nm_a: 0.24,
            supply_v: 48.0,
            supply_resistance_ohm: 0.02,
            bus_capacitance_f: 1e-3,
            reverse_current: ReverseCurrent::Taken,
            pwm_hz: 2e4,
            dead_time_s: 2e-7,
            sense_range_a: 100.0,
            sense_offset_a: 0.0,
            sense_noise_a: 0.0,
            sense_bits: 12,
        }
    }

    /// The parameters that values of [`keys`] give.
    ///
    /// # Errors
    /// A value is missing.
    pub fn of_all(values: &PlantValues) -> Result<Self, PlantError> {
        let reverse_current = match values.text("reverse_current")? {
            "blocked" => ReverseCurrent::Blocked,
            _ => ReverseCurrent::Taken,
        };
        let sense_bits = values.integer("sense_bits")?;
        Ok(Self { reverse_current, sense_bits, ..Self::of(values)? })
    }

    /// Checks every number.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.check()?;
        crate::error::within("sense_bits", self.sense_bits.into(), 6.0, 24.0)
    }
}
