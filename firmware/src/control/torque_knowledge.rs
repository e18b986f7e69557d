//! What is known of the difference between the torque of a command and the torque at the shaft.
//!
//! A motor's torque has an offset, and it has cogging, which repeats in every turn. Both are indistinguishable from a piece of gap
//! in a single reach: a torque that is wrong by delta winds the shaft by kappa delta. What commissioning has found is compensated
//! and subtracted from the observation; what it has not found is stated as a deviation, so that estimates carry it.

use crate::law::Real;

crate::parameters! {
    /// Offset and cogging of the motor's torque, and what of them is unknown.
    pub struct TorqueKnowledge<F> {
        /// Torque that the motor makes in addition to its command.
        torque_offset_nm: F32 = 0.0 in -1e6..=1e6, "N m";
        /// Standard deviation of that offset, relative to `torque_limit_nm`. A uniform one within 1 % has 0.006.
        torque_offset_deviation: F32 = 0.006 in 0.0..=1.0, "";
        /// Standard deviation of the torque that repeats in every move, such as unknown cogging, relative to `torque_limit_nm`.
        torque_ripple_deviation: F32 = 0.001 in 0.0..=1.0, "";
        /// Amplitude of the known cogging.
        cogging_nm: F32 = 0.0 in 0.0..=1e6, "N m";
        /// Periods of the cogging in a turn of the motor.
        cogging_per_turn: F32 = 12.0 in 0.0..=1000.0, "";
        /// Phase of the cogging: its torque is `cogging_nm` sin(`cogging_per_turn` theta_e + phase).
        cogging_phase_rad: F32 = 0.0 in -10.0..=10.0, "rad";
        /// Standard deviation of the torque that grows with the motor's speed, such as unknown back-EMF, at `motor_speed_limit_rad_s`
        /// and relative to `torque_limit_nm`.
        torque_speed_deviation: F32 = 0.0 in 0.0..=100.0, "";
    }
}

impl<F: Real> TorqueKnowledge<F> {
    /// Torque in N m that the motor makes in addition to its command at this position in rad.
    pub(in crate::control) fn added_nm(&self, motor_position_rad: F) -> F {
        if self.cogging_nm == F::ZERO {
            return self.torque_offset_nm;
        }
        let phase_rad = self.cogging_per_turn * motor_position_rad + self.cogging_phase_rad;
        self.torque_offset_nm + self.cogging_nm * sine(phase_rad)
    }
}

/// Sine within 0.0011, from two parabolas: the libraries' sine of an `f32` computes in `f64`, which has no hardware on the
/// microcontroller.
fn sine<F: Real>(angle_rad: F) -> F {
    let (half, one) = (F::from_f64(0.5), F::ONE);
    let turns = angle_rad * F::from_f64(1.0 / core::f64::consts::TAU);
    let fraction = turns - F::from_i64(turns.whole());
    let centred = if fraction > half {
        fraction - one
    } else if fraction < -half {
        fraction + one
    } else {
        fraction
    };
    let parabola = F::from_f64(8.0) * centred * (one - (centred + centred).abs());
    parabola + F::from_f64(0.225) * (parabola * parabola.abs() - parabola)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_is_right_within_a_thousandth_at_any_angle() {
        let worst = (-40_000..40_000)
            .map(|k| f64::from(k) * 1e-3)
            .map(|angle: f64| (sine(angle) - angle.sin()).abs())
            .fold(0.0, f64::max);
        assert!(worst < 1.1e-3, "{worst}");
    }

    #[test]
    fn offset_and_cogging_add_up() {
        let knowledge = TorqueKnowledge {
            torque_offset_nm: 0.1,
            cogging_nm: 0.05,
            cogging_per_turn: 12.0,
            cogging_phase_rad: 0.3,
            ..TorqueKnowledge::default()
        };
        let have: f64 = knowledge.added_nm(2.0);
        assert!((have - (0.1 + 0.05 * 24.3_f64.sin())).abs() < 1e-4, "{have} N m");
    }
}
