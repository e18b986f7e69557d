//! The current of a brushed motor by a proportional-integral control of its voltage.

use super::motor::Motor;
use crate::law::Real;

/// Crossover frequency times the period. From the sample in the middle of a pulse to the middle of the pulse that it sets passes one
/// period; at 1/e the response of an integrator with this delay just doesn't overshoot, here it does by 5 %.
const CROSSOVER: f32 = 0.48;

/// A proportional-integral control whose zero is the pole of the armature, R/L, so that the open loop is an integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLoop {
    gain_v_a: f32,
    /// Part of the proportional voltage that the integral takes in a period: less than 1, however slow the modulation is.
    reset: f32,
    integral_v: f32,
}

impl CurrentLoop {
    /// The control of a motor, stepped once in each period.
    #[must_use]
    pub fn new(motor: &Motor, period_s: f32) -> Self {
        let reset = motor.settled_in(period_s);
        Self { gain_v_a: CROSSOVER * motor.resistance_ohm / reset, reset, integral_v: 0.0 }
    }

    /// The voltage of the next period in V, within `limit_v`, for an error of the current in A and a known voltage against it.
    pub fn step(&mut self, error_a: f32, known_v: f32, limit_v: f32) -> f32 {
        let proportional_v = self.gain_v_a * error_a;
        let wanted_v = proportional_v + self.integral_v + known_v;
        let voltage_v = Real::clamp(wanted_v, -limit_v, limit_v);
        // At the limit the integral approaches what the limit leaves to it, so the voltage leaves the limit as soon as the error changes
        // its sign.
        self.integral_v += self.reset * (proportional_v + voltage_v - wanted_v);
        voltage_v
    }
}
