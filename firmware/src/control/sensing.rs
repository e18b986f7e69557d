//! Encoder counts to a [`Measurement`].
//!
//! Counts are handled as integers for as long as possible. A single-precision float holds 24 bits; 1000 rad at 2^20
//! counts per revolution are 28 bits, so a difference of converted positions would have lost the velocity, and a
//! difference of two positions the twist. Therefore:
//!
//! - counts are differenced as integers, wrapping at the range of `i32`, and summed in 64 bits, so that a counter may
//!   wrap as often as it likes;
//! - a position is decoded at the middle of its count: theta = (2 n + 1) pi / counts;
//! - the twist is formed from counts: with rho = N0 counts_e / counts_s = whole + rest,
//!   z = ((2 n_e + 1) - whole (2 n_s + 1) - rest (2 n_s + 1)) pi / counts_e, which is exact where rest is nought;
//! - a velocity is the difference over the elapsed time behind a first-order lag, advanced exactly for a held input.
//!
//! The reference's rates are differenced too. A step of the reference isn't a velocity: a difference above
//! [`REFERENCE_JUMP_RAD`] per period counts as a jump and gives no rates.

use crate::control::parameter::{PERIOD_S, within};
use crate::control::real::alpha;
use crate::control::{Measurement, ParameterError, Real};

/// Largest difference of the reference between two periods, in rad, that is taken for motion.
pub const REFERENCE_JUMP_RAD: f64 = 0.02;

/// What has to be known to read one encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderConfig<F> {
    /// Counts per revolution, after quadrature.
    pub counts_per_revolution: u32,
    /// Bandwidth of the velocity filter in rad/s.
    pub velocity_bandwidth_rad_s: F,
}

/// What has to be known to read both encoders and the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensingConfig<F> {
    /// Encoder on the motor.
    pub motor: EncoderConfig<F>,
    /// Encoder on the load.
    pub load: EncoderConfig<F>,
    /// Reduction ratio N0, for the twist.
    pub ratio: F,
    /// Control period in seconds.
    pub period_s: F,
}

/// What arrives at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<F> {
    /// Counter of the motor encoder.
    pub motor_counts: i32,
    /// Counter of the load encoder.
    pub load_counts: i32,
    /// Where the load should be, in rad.
    pub reference_rad: F,
    /// Torque applied since the previous sample in N m, after the drive's limit.
    pub applied_torque_nm: F,
    /// Control periods since the previous sample, more than one if samples were lost; nought is read as one.
    pub elapsed_periods: u32,
}

/// One encoder with everything about it worked out.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Channel<F> {
    half_count_rad: F,
    bandwidth_rad_s: F,
    share_per_period: F,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct ChannelState<F> {
    counter: i32,
    counts: i64,
    velocity_rad_s: F,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct ReferenceState<F> {
    position_rad: F,
    /// None after a jump: the next velocity has no predecessor to form an acceleration with.
    velocity_rad_s: Option<F>,
}

/// The way from counts to measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensing<F> {
    motor: Channel<F>,
    load: Channel<F>,
    ratio_in_counts: i64,
    ratio_rest: F,
    period_s: F,
}

/// What is remembered from sample to sample; before the first there is nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensingState<F> {
    previous: Option<(ChannelState<F>, ChannelState<F>, ReferenceState<F>)>,
}

impl<F: Real> Channel<F> {
    fn new(names: [&'static str; 2], config: EncoderConfig<F>, period_s: F) -> Result<Self, ParameterError> {
        let counts = F::from_i64(config.counts_per_revolution.into());
        within(names[0], counts, 4.0, (1 << 24) as f32)?;
        within(names[1], config.velocity_bandwidth_rad_s, 1e-2, 1e6)?;
        Ok(Self {
            half_count_rad: F::from_f64(core::f64::consts::PI) / counts,
            bandwidth_rad_s: config.velocity_bandwidth_rad_s,
            share_per_period: alpha(config.velocity_bandwidth_rad_s, period_s),
        })
    }

    fn advance(&self, state: &mut ChannelState<F>, counter: i32, elapsed_s: F, share: F) {
        let moved = i64::from(counter.wrapping_sub(state.counter));
        let velocity = F::from_i64(2 * moved) * self.half_count_rad / elapsed_s;
        state.counter = counter;
        state.counts += moved;
        state.velocity_rad_s += share * (velocity - state.velocity_rad_s);
    }

    fn share(&self, periods: u32, elapsed_s: F) -> F {
        if periods == 1 { self.share_per_period } else { alpha(self.bandwidth_rad_s, elapsed_s) }
    }
}

impl<F: Real> ChannelState<F> {
    fn at_rest(counter: i32) -> Self {
        Self { counter, counts: i64::from(counter), velocity_rad_s: F::ZERO }
    }

    /// Middle of the count in half counts.
    fn half_counts(&self) -> i64 {
        2 * self.counts + 1
    }
}

impl<F: Real> ReferenceState<F> {
    /// Velocity and acceleration of the reference, both nought after a jump.
    fn advance(&mut self, position_rad: F, period_s: F, periods: F) -> (F, F) {
        let elapsed_s = period_s * periods;
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

impl<F: Real> Sensing<F> {
    /// Sensing with everything worked out once.
    ///
    /// # Errors
    /// Names the parameter outside its range.
    pub fn new(config: SensingConfig<F>) -> Result<Self, ParameterError> {
        within("period_s", config.period_s, PERIOD_S.0, PERIOD_S.1)?;
        within("ratio", config.ratio, 1e-3, 1e4)?;
        let motor_names = ["motor.counts_per_revolution", "motor.velocity_bandwidth_rad_s"];
        let load_names = ["load.counts_per_revolution", "load.velocity_bandwidth_rad_s"];
        let motor = Channel::new(motor_names, config.motor, config.period_s)?;
        let load = Channel::new(load_names, config.load, config.period_s)?;
        // Not in f64, for which the microcontroller would need 3 KiB of software. A whole ratio stays whole: counts have
        // at most 24 bits, so product and quotient are rounded to it.
        let [motor_counts, load_counts] =
            [config.motor, config.load].map(|encoder| F::from_i64(encoder.counts_per_revolution.into()));
        let ratio_in_counts = config.ratio * motor_counts / load_counts;
        // So that the twist of any two counters fits into 64 bits.
        within("motor counts per load count", ratio_in_counts, 0.0, (1 << 24) as f32)?;
        let whole = ratio_in_counts.whole();
        Ok(Self {
            motor,
            load,
            ratio_in_counts: whole,
            ratio_rest: ratio_in_counts - F::from_i64(whole),
            period_s: config.period_s,
        })
    }

    /// Sensing that has seen nothing yet.
    pub fn initial_state(&self) -> SensingState<F> {
        SensingState { previous: None }
    }

    /// One sample. The first one has no velocities.
    pub fn step(&self, state: &mut SensingState<F>, sample: &Sample<F>) -> Measurement<F> {
        let periods = sample.elapsed_periods.max(1);
        let (motor, load, reference, rates) = match state.previous {
            None => (
                ChannelState::at_rest(sample.motor_counts),
                ChannelState::at_rest(sample.load_counts),
                ReferenceState { position_rad: sample.reference_rad, velocity_rad_s: None },
                (F::ZERO, F::ZERO),
            ),
            Some((mut motor, mut load, mut reference)) => {
                let count = F::from_i64(i64::from(periods));
                let elapsed_s = self.period_s * count;
                self.motor.advance(
                    &mut motor,
                    sample.motor_counts,
                    elapsed_s,
                    self.motor.share(periods, elapsed_s),
                );
                self.load.advance(
                    &mut load,
                    sample.load_counts,
                    elapsed_s,
                    self.load.share(periods, elapsed_s),
                );
                let rates = reference.advance(sample.reference_rad, self.period_s, count);
                (motor, load, reference, rates)
            }
        };
        state.previous = Some((motor, load, reference));
        let motor_half_counts = motor.half_counts();
        let load_half_counts = load.half_counts();
        let whole = motor_half_counts - self.ratio_in_counts * load_half_counts;
        let rest = self.ratio_rest * F::from_i64(load_half_counts);
        Measurement {
            motor_position_rad: F::from_i64(motor_half_counts) * self.motor.half_count_rad,
            motor_velocity_rad_s: motor.velocity_rad_s,
            load_position_rad: F::from_i64(load_half_counts) * self.load.half_count_rad,
            load_velocity_rad_s: load.velocity_rad_s,
            twist_rad: (F::from_i64(whole) - rest) * self.motor.half_count_rad,
            reference_position_rad: sample.reference_rad,
            reference_velocity_rad_s: rates.0,
            reference_acceleration_rad_s2: rates.1,
            applied_torque_nm: sample.applied_torque_nm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use std::string::ToString;

    fn encoder(counts_per_revolution: u32) -> EncoderConfig<f32> {
        EncoderConfig { counts_per_revolution, velocity_bandwidth_rad_s: 1e6 }
    }

    fn sensing(counts: u32, bandwidth: f32) -> Sensing<f32> {
        let channel = EncoderConfig { velocity_bandwidth_rad_s: bandwidth, ..encoder(counts) };
        Sensing::new(SensingConfig { motor: channel, load: channel, ratio: 3.0, period_s: 1e-3 })
            .expect("valid")
    }

    fn sample(motor_counts: i32, load_counts: i32) -> Sample<f32> {
        Sample { motor_counts, load_counts, reference_rad: 0.0, applied_torque_nm: 0.0, elapsed_periods: 1 }
    }

    #[test]
    fn first_sample_has_no_velocity() {
        let sensing = sensing(4000, 1e6);
        let first = sensing.step(&mut sensing.initial_state(), &sample(123_456, -7));
        assert_eq!([first.motor_velocity_rad_s, first.load_velocity_rad_s], [0.0, 0.0]);
    }

    #[test]
    fn position_is_decoded_at_the_middle_of_the_count() {
        let sensing = sensing(1000, 1e6);
        let measured = sensing.step(&mut sensing.initial_state(), &sample(0, -1));
        assert!((f64::from(measured.motor_position_rad) - 0.0005 * TAU).abs() < 1e-9);
        assert!((f64::from(measured.load_position_rad) + 0.0005 * TAU).abs() < 1e-9);
    }

    #[test]
    fn velocity_and_twist_survive_a_thousand_radians_in_single_precision() {
        let sensing = sensing(1 << 20, 1e6);
        let mut state = sensing.initial_state();
        // 1000 rad at the load are 3000 rad at the motor; the twist is 5 counts and the load moves 3 counts.
        let load = 166_886_053;
        sensing.step(&mut state, &sample(3 * load + 5 + 1, load));
        let measured = sensing.step(&mut state, &sample(3 * (load + 3) + 5 + 1, load + 3));
        let count = TAU / f64::from(1 << 20);
        let velocity = f64::from(measured.load_velocity_rad_s);
        assert!(
            (velocity / (3.0 * count / 1e-3) - 1.0).abs() < 1e-6,
            "have {velocity} rad/s, want three counts"
        );
        // Middles of counts: (n_e + 1/2) - 3 (n_s + 1/2) = 6 - 1.
        let twist = f64::from(measured.twist_rad);
        assert!((twist / (5.0 * count) - 1.0).abs() < 1e-6, "have {twist} rad, want five counts");
    }

    #[test]
    fn wrapping_counter_keeps_position_velocity_and_twist() {
        let sensing = sensing(1 << 20, 1e6);
        let mut state = sensing.initial_state();
        sensing.step(&mut state, &sample(i32::MAX - 1, 715_827_882));
        let measured = sensing.step(&mut state, &sample(i32::MIN + 1, 715_827_883));
        let count = TAU / f64::from(1 << 20);
        assert!((f64::from(measured.motor_velocity_rad_s) / (3.0 * count / 1e-3) - 1.0).abs() < 1e-6);
        assert!((f64::from(measured.motor_position_rad) - 2048.0 * TAU).abs() < 1e-3);
        // n_e = 2^31 + 1, three times n_s = 2^31 + 1, and minus one count for the middles.
        assert!((f64::from(measured.twist_rad) / -count - 1.0).abs() < 1e-6, "have {}", measured.twist_rad);
    }

    #[test]
    fn lost_samples_do_not_multiply_the_velocity() {
        let sensing = sensing(4000, 200.0);
        let (mut every, mut third) = (sensing.initial_state(), sensing.initial_state());
        sensing.step(&mut every, &sample(0, 0));
        sensing.step(&mut third, &sample(0, 0));
        for k in 1..=60 {
            let of_every = sensing.step(&mut every, &sample(12 * k, 4 * k));
            if k % 3 == 0 {
                let of_third =
                    sensing.step(&mut third, &Sample { elapsed_periods: 3, ..sample(12 * k, 4 * k) });
                let (have, want) = (of_third.motor_velocity_rad_s, of_every.motor_velocity_rad_s);
                assert!((have / want - 1.0).abs() < 1e-5, "sample {k}: have {have}, want {want} rad/s");
            }
        }
    }

    #[test]
    fn velocity_filter_reaches_its_share_of_a_step_exactly() {
        let sensing = sensing(4000, 100.0);
        let mut state = sensing.initial_state();
        sensing.step(&mut state, &sample(0, 0));
        let last = (1..=20).map(|k| sensing.step(&mut state, &sample(10 * k, 0))).last().expect("stepped");
        // 20 ms at 100 rad/s are two time constants.
        let want = 10.0 * TAU / 4000.0 / 1e-3 * (1.0 - libm::exp(-2.0));
        let have = f64::from(last.motor_velocity_rad_s);
        assert!((have / want - 1.0).abs() < 1e-5, "have {have}, want {want} rad/s");
    }

    #[test]
    fn twist_holds_for_a_ratio_that_is_no_whole_number_of_counts() {
        let config =
            SensingConfig { motor: encoder(4096), load: encoder(10_000), ratio: 2.5_f32, period_s: 1e-3 };
        let sensing = Sensing::new(config).expect("valid");
        let measured = sensing.step(&mut sensing.initial_state(), &sample(5000, 4900));
        let want = 5000.5 * TAU / 4096.0 - 2.5 * 4900.5 * TAU / 10_000.0;
        assert!(
            (f64::from(measured.twist_rad) - want).abs() < 1e-6,
            "have {}, want {want}",
            measured.twist_rad
        );
    }

    #[test]
    fn reference_ramp_has_rates_and_a_jump_has_none() {
        let sensing = sensing(4000, 1e6);
        let mut state = sensing.initial_state();
        let mut at = |reference_rad: f32| {
            let measured = sensing.step(&mut state, &Sample { reference_rad, ..sample(0, 0) });
            [measured.reference_velocity_rad_s, measured.reference_acceleration_rad_s2]
        };
        assert_eq!(at(1.0), [0.0, 0.0]);
        let [velocity, acceleration] = at(1.0 + 1.0 / 128.0);
        assert!((velocity - 7.8125).abs() < 1e-4);
        assert_eq!(acceleration, 0.0, "the first velocity has no predecessor");
        let [_, acceleration] = at(1.0 + 3.0 / 128.0);
        assert!((acceleration - 7812.5).abs() < 1.0, "have {acceleration}");
        assert_eq!(at(2.0), [0.0, 0.0], "a jump");
        assert_eq!(at(2.0 + 1.0 / 128.0)[1], 0.0, "after a jump");
    }

    #[test]
    fn encoder_without_counts_is_refused_by_name() {
        let config = SensingConfig { motor: encoder(4000), load: encoder(0), ratio: 3.0, period_s: 1e-3 };
        let error = Sensing::new(config).expect_err("no counts");
        let want = "control parameter load.counts_per_revolution is 0, allowed is 4 to 16777216";
        assert_eq!(error.to_string(), want);
    }
}
