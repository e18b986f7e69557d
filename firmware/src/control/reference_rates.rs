//! Velocity and acceleration of the reference, by differences.
//!
//! A step of the reference isn't a velocity: a difference above [`REFERENCE_JUMP_RAD`] per period counts as a jump and
//! gives no rates.

use crate::law::Real;

/// Largest difference of the reference between two periods, in rad, that counts as motion.
const REFERENCE_JUMP_RAD: f64 = 0.02;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ReferenceRates<F> {
    position_rad: F,
    /// `None` at the start and after a jump: the next velocity has no predecessor for an acceleration.
    velocity_rad_s: Option<F>,
}

impl<F: Real> ReferenceRates<F> {
    pub(crate) fn at_rest(position_rad: F) -> Self {
        Self { position_rad, velocity_rad_s: None }
    }

    /// Velocity in rad/s and acceleration in rad/s^2 after this number of periods, both zero after a jump.
    pub(crate) fn advance(&mut self, position_rad: F, periods: F, elapsed_s: F) -> (F, F) {
        let moved = position_rad - self.position_rad;
        let velocity = if moved.abs() <= F::from_f64(REFERENCE_JUMP_RAD) * periods {
            Some(moved / elapsed_s)
        } else {
            None
        };
        let acceleration = match (velocity, self.velocity_rad_s) {
            (Some(now), Some(before)) => (now - before) / elapsed_s,
            _ => F::ZERO,
        };
        *self = Self { position_rad, velocity_rad_s: velocity };
        (velocity.unwrap_or(F::ZERO), acceleration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramp_has_rates_and_a_jump_has_none() {
        let mut reference = ReferenceRates::at_rest(1.0_f32);
        let mut at = |position_rad| reference.advance(position_rad, 1.0, 1e-3);
        let (velocity, acceleration) = at(1.0 + 1.0 / 128.0);
        assert!((velocity - 7.8125).abs() < 1e-4, "have {velocity}");
        assert_eq!(acceleration, 0.0, "the first velocity has no predecessor");
        let (_, acceleration) = at(1.0 + 3.0 / 128.0);
        assert!((acceleration - 7812.5).abs() < 1.0, "have {acceleration}");
        assert_eq!(at(2.0), (0.0, 0.0), "a jump");
        assert_eq!(at(2.0 + 1.0 / 128.0).1, 0.0, "after a jump");
    }
}
