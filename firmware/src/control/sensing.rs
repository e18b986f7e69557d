//! Encoder counts to a [`Measurement`].
//!
//! Counts stay integers as long as possible. A single-precision float holds 24 bits; 1000 rad at 2^20 counts per
//! revolution are 28 bits: a difference of converted positions would have lost the velocity, and a difference of two
//! positions the twist. The twist is therefore formed from counts: with rho = N0 counts_e / counts_s = whole + rest,
//! z = ((2 n_e + 1) - whole (2 n_s + 1) - rest (2 n_s + 1)) pi / counts_e, which is exact where rest is zero.

use crate::control::encoder_channel::{EncoderChannel, EncoderState};
use crate::control::reference_rates::ReferenceRates;
use crate::law::{Measurement, ParameterError, Real};

pub use crate::control::encoder_channel::EncoderConfig;

/// Most motor counts per load count, so that the twist of any two counters fits into 64 bits.
const COUNTS_RATIO_MAX: i64 = 1 << 24;

/// Configuration of both encoders and the control period.
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

/// The inputs of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<F> {
    /// Counter of the motor encoder.
    pub motor_counts: i32,
    /// Counter of the load encoder.
    pub load_counts: i32,
    /// Reference of the load position in rad.
    pub reference_rad: F,
    /// Torque applied since the previous sample in N m, after the drive's limit.
    pub applied_torque_nm: F,
    /// Control periods since the previous sample, more than one if samples were lost; zero counts as one.
    pub elapsed_periods: u32,
}

/// Sensing with its state.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensing<F> {
    motor: EncoderChannel<F>,
    load: EncoderChannel<F>,
    ratio_in_counts: i64,
    ratio_rest: F,
    period_s: F,
    /// `None` before the first sample.
    previous: Option<Previous<F>>,
    /// Twist of the last sample.
    twist_rad: F,
}

/// What a measurement has besides positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<F> {
    /// Motor velocity in rad/s.
    pub motor_velocity_rad_s: F,
    /// Load velocity in rad/s.
    pub load_velocity_rad_s: F,
    /// Twist z in rad.
    pub twist_rad: F,
}

/// Both encoders and the reference at the last sample.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Previous<F> {
    motor: EncoderState<F>,
    load: EncoderState<F>,
    reference: ReferenceRates<F>,
}

impl<F: Real> Sensing<F> {
    /// Sensing before its first sample.
    ///
    /// # Errors
    /// If the motor encoder is too fine for the load encoder at this ratio.
    pub fn new(config: SensingConfig<F>) -> Result<Self, ParameterError> {
        // Not in f64, which costs the microcontroller 3 KiB of software. A whole ratio stays whole: counts have at most
        // 24 bits, so product and quotient are rounded to it.
        let [motor_counts, load_counts] =
            [config.motor, config.load].map(|encoder| F::from_i64(encoder.counts_per_revolution.into()));
        let ratio_in_counts = config.ratio * motor_counts / load_counts;
        let max = F::from_i64(COUNTS_RATIO_MAX) * load_counts / motor_counts;
        ParameterError::at_most("reduction_ratio", config.ratio, max, "the range of the twist")?;
        let whole = ratio_in_counts.whole();
        Ok(Self {
            motor: EncoderChannel::new(config.motor, config.period_s),
            load: EncoderChannel::new(config.load, config.period_s),
            ratio_in_counts: whole,
            ratio_rest: ratio_in_counts - F::from_i64(whole),
            period_s: config.period_s,
            previous: None,
            twist_rad: F::ZERO,
        })
    }

    /// The measurement of one sample. The first sample has no velocities.
    pub fn step(&mut self, sample: &Sample<F>) -> Measurement<F> {
        let is_first = self.previous.is_none();
        // In place, because a copy of the state costs the microcontroller as much as a filter.
        let now = self.previous.get_or_insert_with(|| Previous {
            motor: EncoderState::at_rest(sample.motor_counts),
            load: EncoderState::at_rest(sample.load_counts),
            reference: ReferenceRates::at_rest(sample.reference_rad),
        });
        let rates = if is_first {
            (F::ZERO, F::ZERO)
        } else {
            let periods = sample.elapsed_periods.max(1);
            let count = F::from_i64(i64::from(periods));
            let elapsed_s = self.period_s * count;
            self.motor.advance(&mut now.motor, sample.motor_counts, periods, elapsed_s);
            self.load.advance(&mut now.load, sample.load_counts, periods, elapsed_s);
            now.reference.advance(sample.reference_rad, count, elapsed_s)
        };
        let motor_half_counts = now.motor.half_counts();
        let load_half_counts = now.load.half_counts();
        let whole = motor_half_counts - self.ratio_in_counts * load_half_counts;
        let rest = self.ratio_rest * F::from_i64(load_half_counts);
        self.twist_rad = self.motor.angle_rad(F::from_i64(whole) - rest);
        Measurement {
            motor_position_rad: self.motor.angle_rad(F::from_i64(motor_half_counts)),
            motor_velocity_rad_s: now.motor.velocity_rad_s,
            load_position_rad: self.load.angle_rad(F::from_i64(load_half_counts)),
            load_velocity_rad_s: now.load.velocity_rad_s,
            twist_rad: self.twist_rad,
            reference_position_rad: sample.reference_rad,
            reference_velocity_rad_s: rates.0,
            reference_acceleration_rad_s2: rates.1,
            applied_torque_nm: sample.applied_torque_nm,
        }
    }

    /// Velocities and twist of the last measurement; zero before the first one.
    pub fn motion(&self) -> Motion<F> {
        let (motor_velocity_rad_s, load_velocity_rad_s) = match &self.previous {
            None => (F::ZERO, F::ZERO),
            Some(last) => (last.motor.velocity_rad_s, last.load.velocity_rad_s),
        };
        Motion { motor_velocity_rad_s, load_velocity_rad_s, twist_rad: self.twist_rad }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;
    use std::string::ToString;

    use super::*;

    fn encoder(counts_per_revolution: u32) -> EncoderConfig<f32> {
        EncoderConfig { counts_per_revolution, velocity_bandwidth_rad_s: 1e6 }
    }

    fn sensing(motor: u32, load: u32, ratio: f32) -> Result<Sensing<f32>, ParameterError> {
        Sensing::new(SensingConfig { motor: encoder(motor), load: encoder(load), ratio, period_s: 1e-3 })
    }

    fn sample(motor_counts: i32, load_counts: i32) -> Sample<f32> {
        Sample { motor_counts, load_counts, reference_rad: 0.0, applied_torque_nm: 0.0, elapsed_periods: 1 }
    }

    #[test]
    fn first_sample_has_no_velocity() {
        let mut sensing = sensing(4000, 4000, 3.0).expect("valid");
        let first = sensing.step(&sample(123_456, -7));
        assert_eq!([first.motor_velocity_rad_s, first.load_velocity_rad_s], [0.0, 0.0]);
    }

    #[test]
    fn velocity_and_twist_survive_a_thousand_radians_in_single_precision() {
        let mut sensing = sensing(1 << 20, 1 << 20, 3.0).expect("valid");
        // 1000 rad at the load are 3000 rad at the motor; the twist is 5 counts and the load moves 3 counts.
        let load = 166_886_053;
        sensing.step(&sample(3 * load + 5 + 1, load));
        let measured = sensing.step(&sample(3 * (load + 3) + 5 + 1, load + 3));
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
    fn wraparound_of_a_counter_keeps_the_twist() {
        let mut sensing = sensing(1 << 20, 1 << 20, 3.0).expect("valid");
        sensing.step(&sample(i32::MAX - 1, 715_827_882));
        let measured = sensing.step(&sample(i32::MIN + 1, 715_827_883));
        // n_e = 2^31 + 1, three times n_s = 2^31 + 1, and minus one count for the middles.
        let want = -TAU / f64::from(1 << 20);
        assert!((f64::from(measured.twist_rad) / want - 1.0).abs() < 1e-6, "have {}", measured.twist_rad);
    }

    #[test]
    fn twist_holds_for_a_ratio_that_is_no_whole_number_of_counts() {
        let mut sensing = sensing(4096, 10_000, 2.5).expect("valid");
        let have = f64::from(sensing.step(&sample(5000, 4900)).twist_rad);
        let want = 5000.5 * TAU / 4096.0 - 2.5 * 4900.5 * TAU / 10_000.0;
        assert!((have - want).abs() < 1e-6, "have {have}, want {want}");
    }

    #[test]
    fn motor_encoder_too_fine_for_the_load_encoder_is_rejected_by_name() {
        let error = sensing(1 << 24, 4, 8.0).expect_err("the twist does not fit");
        let want =
            "control parameter reduction_ratio is 8, allowed is at most 4, given by the range of the twist";
        assert_eq!(error.to_string(), want);
        assert!(sensing(1 << 24, 4, 4.0).is_ok());
        assert!(sensing(4000, 0, 3.0).is_err(), "an encoder without counts");
    }
}
