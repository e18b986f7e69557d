//! One encoder: counts without wraparound, position and filtered velocity.
//!
//! Counts are differenced as integers, with wraparound at the range of `i32`, and summed in 64 bits, so that a counter
//! may wrap any number of times. A position is decoded at the middle of its count: theta = (2 n + 1) pi / counts. A
//! velocity is the difference over the elapsed time behind a first-order lag, advanced exactly for a held input.

use crate::control::lag::alpha;
use crate::law::Real;

/// Resolution and velocity filter of one encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderConfig<F> {
    /// Counts per revolution, after quadrature.
    pub counts_per_revolution: u32,
    /// Bandwidth of the velocity filter in rad/s.
    pub velocity_bandwidth_rad_s: F,
}

/// The constants of one encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EncoderChannel<F> {
    half_count_rad: F,
    bandwidth_rad_s: F,
    alpha_per_period: F,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EncoderState<F> {
    counter: i32,
    counts: i64,
    pub(crate) velocity_rad_s: F,
}

impl<F: Real> EncoderChannel<F> {
    pub(crate) fn new(config: EncoderConfig<F>, period_s: F) -> Self {
        Self {
            half_count_rad: F::from_f64(core::f64::consts::PI)
                / F::from_i64(config.counts_per_revolution.into()),
            bandwidth_rad_s: config.velocity_bandwidth_rad_s,
            alpha_per_period: alpha(config.velocity_bandwidth_rad_s, period_s),
        }
    }

    /// Advances the state to the reading `counter`, which came `periods` after the last one.
    pub(crate) fn advance(&self, state: &mut EncoderState<F>, counter: i32, periods: u32, elapsed_s: F) {
        let moved = i64::from(counter.wrapping_sub(state.counter));
        let velocity = F::from_i64(2 * moved) * self.half_count_rad / elapsed_s;
        let alpha = if periods == 1 { self.alpha_per_period } else { alpha(self.bandwidth_rad_s, elapsed_s) };
        state.counter = counter;
        state.counts += moved;
        state.velocity_rad_s += alpha * (velocity - state.velocity_rad_s);
    }

    /// An angle given in half counts, in rad.
    pub(crate) fn angle_rad(&self, half_counts: F) -> F {
        half_counts * self.half_count_rad
    }
}

impl<F: Real> EncoderState<F> {
    pub(crate) fn at_rest(counter: i32) -> Self {
        Self { counter, counts: i64::from(counter), velocity_rad_s: F::ZERO }
    }

    /// Middle of the count in half counts.
    pub(crate) fn half_counts(&self) -> i64 {
        2 * self.counts + 1
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;

    const PERIOD_S: f32 = 1e-3;

    fn channel(counts_per_revolution: u32, velocity_bandwidth_rad_s: f32) -> EncoderChannel<f32> {
        EncoderChannel::new(EncoderConfig { counts_per_revolution, velocity_bandwidth_rad_s }, PERIOD_S)
    }

    fn position_rad(channel: &EncoderChannel<f32>, state: &EncoderState<f32>) -> f64 {
        channel.angle_rad(state.half_counts() as f32).into()
    }

    #[test]
    fn position_is_decoded_at_the_middle_of_the_count() {
        let channel = channel(1000, 1e6);
        for (counter, want) in [(0, 0.0005 * TAU), (-1, -0.0005 * TAU)] {
            let have = position_rad(&channel, &EncoderState::at_rest(counter));
            assert!((have - want).abs() < 1e-9, "have {have}, want {want} rad");
        }
    }

    #[test]
    fn wraparound_keeps_position_and_velocity() {
        let channel = channel(1 << 20, 1e6);
        let mut state = EncoderState::at_rest(i32::MAX - 1);
        channel.advance(&mut state, i32::MIN + 1, 1, PERIOD_S);
        let velocity_rad_s = 3.0 * TAU / f64::from(1 << 20) / 1e-3;
        assert!((f64::from(state.velocity_rad_s) / velocity_rad_s - 1.0).abs() < 1e-6);
        assert!((position_rad(&channel, &state) - 2048.0 * TAU).abs() < 1e-3);
    }

    #[test]
    fn lost_samples_do_not_multiply_the_velocity() {
        let channel = channel(4000, 200.0);
        let (mut every, mut third) = (EncoderState::at_rest(0), EncoderState::at_rest(0));
        for k in 1..=60 {
            channel.advance(&mut every, 12 * k, 1, PERIOD_S);
            if k % 3 == 0 {
                channel.advance(&mut third, 12 * k, 3, 3.0 * PERIOD_S);
                let (have, want) = (third.velocity_rad_s, every.velocity_rad_s);
                assert!((have / want - 1.0).abs() < 1e-5, "sample {k}: have {have}, want {want} rad/s");
            }
        }
    }

    #[test]
    fn velocity_filter_follows_a_step_exactly() {
        let channel = channel(4000, 100.0);
        let mut state = EncoderState::at_rest(0);
        (1..=20).for_each(|k| channel.advance(&mut state, 10 * k, 1, PERIOD_S));
        // 20 ms at 100 rad/s are two time constants.
        let want = 10.0 * TAU / 4000.0 / 1e-3 * (1.0 - libm::exp(-2.0));
        let have = f64::from(state.velocity_rad_s);
        assert!((have / want - 1.0).abs() < 1e-5, "have {have}, want {want} rad/s");
    }
}
