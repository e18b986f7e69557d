//! The direction of the motor's dry friction, from displacement.
//!
//! Behind a coarse encoder a creeping motor has no usable velocity. Friction from the sign of the velocity vanishes
//! where the gap is identified: in slow motion against a load at rest. The friction is therefore a function of
//! displacement, not of time: it reverses within [`TURNOVER_RAD`] after a reversal of the motion and holds its value at
//! rest. This is the rate-independent part of Dahl's model with straight flanks.

use crate::law::Real;

/// Displacement in rad over which friction rises from zero to its full value. Well above a count, so that a motor at
/// the border of two counts doesn't reverse it, and well below the displacement that winds the spring.
const TURNOVER_RAD: f64 = 0.02;

/// State: the position, and the fraction of the dry friction from -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct MotorFriction<F> {
    position_rad: F,
    fraction: F,
}

impl<F: Real> MotorFriction<F> {
    /// A motor at this position without friction.
    pub(in crate::control) fn at(position_rad: F) -> Self {
        Self { position_rad, fraction: F::ZERO }
    }

    /// Fraction of the dry friction at this position, positive against motion in the positive sense.
    pub(in crate::control) fn step(&mut self, position_rad: F) -> F {
        let moved = position_rad - self.position_rad;
        self.position_rad = position_rad;
        self.fraction = (self.fraction + moved * F::from_f64(1.0 / TURNOVER_RAD)).clamp(-F::ONE, F::ONE);
        self.fraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn creeping_motor_has_its_full_friction_at_any_speed() {
        let mut friction = MotorFriction::at(1.0);
        // One count of 4000 every half second: a velocity filter would read zero.
        let fraction = (0..200_000).map(|k| friction.step(1.0 + f64::from(k / 500) * 1.57e-3)).last();
        assert_eq!(fraction, Some(1.0));
    }

    #[test]
    fn friction_reverses_with_the_motion_and_holds_at_rest() {
        let mut friction = MotorFriction::at(0.0);
        assert_eq!(friction.step(0.5), 1.0);
        assert!((friction.step(0.49) - 0.5).abs() < 1e-12);
        assert!((friction.step(0.49) - 0.5).abs() < 1e-12, "at rest");
        assert_eq!(friction.step(0.4), -1.0);
    }
}
