//! The side the motor's dry friction is on, from displacement.
//!
//! Behind a coarse encoder a motor that creeps has no velocity to speak of, and a friction taken from the velocity's sign
//! vanishes just where the gap is identified: in slow motion against a load at rest. What friction has built up is
//! therefore followed over the way moved, not over time: it turns over within [`TURNOVER_RAD`] after a reversal and is
//! kept at rest. This is the rate-independent part of Dahl's model with straight flanks.

use crate::control::Real;

/// Way in rad over which friction goes from nought to all of it. Well above a count, so that a motor on the border of
/// two counts doesn't turn it over, and well below what a motor moves while the spring is wound.
const TURNOVER_RAD: f64 = 0.02;

/// What is remembered: the position, and the share of the dry friction in -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MotorFriction<F> {
    position_rad: F,
    share: F,
}

impl<F: Real> MotorFriction<F> {
    /// A motor whose friction nothing is known of.
    pub(super) fn at(position_rad: F) -> Self {
        Self { position_rad, share: F::ZERO }
    }

    /// Share of the dry friction at this position, positive against motion in the positive sense.
    pub(super) fn step(&mut self, position_rad: F) -> F {
        let moved = position_rad - self.position_rad;
        self.position_rad = position_rad;
        self.share = (self.share + moved * F::from_f64(1.0 / TURNOVER_RAD)).clamp(-F::ONE, F::ONE);
        self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn creeping_motor_has_its_friction_however_slow_it_is() {
        let mut friction = MotorFriction::at(1.0);
        // One count of 4000 every half second: no velocity filter would see it.
        let share = (0..200_000).map(|k| friction.step(1.0 + f64::from(k / 500) * 1.57e-3)).last();
        assert_eq!(share, Some(1.0));
    }

    #[test]
    fn friction_turns_over_after_a_reversal_and_is_kept_at_rest() {
        let mut friction = MotorFriction::at(0.0);
        assert_eq!(friction.step(0.5), 1.0);
        assert!((friction.step(0.49) - 0.5).abs() < 1e-12);
        assert!((friction.step(0.49) - 0.5).abs() < 1e-12, "at rest");
        assert_eq!(friction.step(0.4), -1.0);
    }
}
