//! Whether the sensor of the current can be right, by what voltage and speed make of the current.

use super::BridgeReading;
use super::motor::Motor;
use crate::law::Real;

/// Periods in a row without an explanation: more than a step of the torque takes.
const PERIODS: u8 = 16;
/// What the drive may be wrong about, as a part: 1/0.7 is less than 1.5.
const UNKNOWN: f32 = 0.5;

/// A sensor is wrong if the current that it shows is neither the commanded one nor the one that the voltage makes. A loop that holds its
/// command has a sensor; a supply that is too weak for the command gives the voltage that explains the current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorCheck {
    motor: Motor,
    /// Largest error of the sensor by noise and resolution, in A.
    noise_a: f32,
    /// What the voltage may not explain, in A.
    tolerance_a: f32,
    settled: f32,
    expected_a: f32,
    /// Voltage of the period before.
    voltage_v: f32,
    periods: u8,
}

impl SensorCheck {
    /// The check of a motor without current, made once in each period. A sensor has steps and noise of up to `noise_a`.
    #[must_use]
    pub fn new(motor: Motor, period_s: f32, noise_a: f32, tolerance_a: f32) -> Self {
        let settled = motor.settled_in(period_s);
        Self { motor, noise_a, tolerance_a, settled, expected_a: 0.0, voltage_v: 0.0, periods: 0 }
    }

    /// Whether the sensor is wrong: by the command that the reading should follow, the speed in rad/s and the duty of the next period.
    pub fn step(&mut self, torque_nm: f32, speed_rad_s: f32, reading: &BridgeReading, duty: f32) -> bool {
        let Motor { resistance_ohm, torque_constant_nm_a, .. } = self.motor;
        let BridgeReading { current_a, bus_v } = *reading;
        let wanted_a = torque_nm / torque_constant_nm_a;
        let emf_a = torque_constant_nm_a * speed_rad_s / resistance_ohm;
        let explained_a = UNKNOWN * (Real::abs(current_a) + Real::abs(emf_a)) + self.tolerance_a;
        let is_held = Real::abs(wanted_a - current_a) <= UNKNOWN * Real::abs(wanted_a) + self.noise_a;
        let is_explained = Real::abs(self.expected_a - current_a) <= explained_a;
        // Without a command a motor that still turns as the run starts makes a current that no speed explains yet.
        let is_commanded = Real::abs(wanted_a) > self.noise_a;
        self.periods = if is_held || is_explained || !is_commanded { 0 } else { self.periods + 1 };
        // Until the next sample half a period has the duty of before.
        let voltage_v = duty * bus_v;
        let mean_a = 0.5 * (self.voltage_v + voltage_v) / resistance_ohm;
        self.voltage_v = voltage_v;
        self.expected_a += self.settled * (mean_a - emf_a - self.expected_a);
        self.periods >= PERIODS
    }
}
