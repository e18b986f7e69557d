//! From a torque to the duty of a bridge, where no amplifier makes the torque.
//!
//! ```text
//! voltage    v = R U / k_t + k_t w                the torque U at the speed w, if R and k_t are right
//! current    v = loop(U / k_t - i) + k_t w        a sensor measures the current i
//! ```
//!
//! The duty is v over the voltage of the bus.

mod current_loop;
mod motor;
mod offset;
mod sensor_check;

pub use current_loop::CurrentLoop;
pub use motor::Motor;
pub use offset::SensorOffset;
pub use sensor_check::SensorCheck;

use crate::law::Real;

crate::choices! {
    /// What makes the torque of a command.
    pub enum TorqueSource {
        /// The power stage: the duty is its command.
        Amplifier = "amplifier",
        /// The drive, by the voltage of a bridge. Nothing measures the torque.
        Voltage = "voltage",
        /// The drive, by the measured current of a bridge.
        Current = "current",
    }
}

/// What a bridge reads in a period of its modulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BridgeReading {
    /// Current of the motor in A, without the sensor's offset.
    pub current_a: f32,
    /// Voltage of the bus in V.
    pub bus_v: f32,
}

/// The duty of a bridge for a torque, period by period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueControl {
    motor: Motor,
    /// `None` if nothing measures the current.
    current: Option<CurrentLoop>,
    /// Largest mean voltage as a fraction of the bus.
    largest_duty: f32,
}

impl TorqueControl {
    /// Control by the measured current, stepped once in a period of the modulation.
    #[must_use]
    pub fn by_current(motor: Motor, period_s: f32, largest_duty: f32) -> Self {
        Self { motor, current: Some(CurrentLoop::new(&motor, period_s)), largest_duty }
    }

    /// Control by the voltage alone.
    #[must_use]
    pub fn by_voltage(motor: Motor, largest_duty: f32) -> Self {
        Self { motor, current: None, largest_duty }
    }

    /// The duty of the next period, within the largest one, for a torque in N m and the speed of the motor in rad/s; 0 without a voltage of the bus.
    pub fn duty(&mut self, torque_nm: f32, speed_rad_s: f32, reading: &BridgeReading) -> f32 {
        let Motor { resistance_ohm, torque_constant_nm_a, .. } = self.motor;
        let wanted_a = torque_nm / torque_constant_nm_a;
        let emf_v = torque_constant_nm_a * speed_rad_s;
        let largest_v = self.largest_duty * reading.bus_v;
        let voltage_v = match &mut self.current {
            None => resistance_ohm * wanted_a + emf_v,
            Some(control) => control.step(wanted_a - reading.current_a, emf_v, largest_v),
        };
        // NaN is greater than nothing.
        if largest_v > 0.0 && voltage_v.is_finite() {
            Real::clamp(voltage_v, -largest_v, largest_v) / reading.bus_v
        } else {
            0.0
        }
    }
}
