//! The parameters of bench mode. Only a drive with encoders and a power stage of its own offers them, after all others.

use super::pins::PinHardware;
use crate::direction::Direction;
use crate::law::ParameterError;
use crate::power_stage::{Modulation, StageChoice};

crate::choices! {
    /// Source of the samples, and with it the destination of the torque.
    pub enum SampleSource {
        /// HIL mode: encoder samples from the host, torque to the host.
        Link = "link",
        /// Bench mode: the encoders and the power stage of the drive.
        Pins = "pins",
    }
}

crate::parameters! {
    /// The parameters of bench mode.
    pub struct PinParameters {
        /// Source of the samples.
        sample_source: SampleSource = Link;
        /// Control steps for each `BenchSample`.
        bench_sample_every: U32 = 1 in 1..=1000, "";
        /// Direction of the motor encoder.
        motor_direction: Direction = Forward;
        /// Direction of the load encoder.
        load_direction: Direction = Forward;
        /// Direction of the power stage.
        torque_direction: Direction = Forward;
        /// Torque for a duty of 1 more than `duty_offset`. At the default no torque limit of a usual motor has a duty, so a
        /// host has to set it.
        torque_per_duty_nm: F32 = 1.0 in 1e-3..=1e5, "N m";
        /// Duty of no torque.
        duty_offset: F32 = 0.5 in 0.0..=1.0, "";
        /// Smallest duty of the amplifier.
        duty_min: F32 = 0.1 in 0.0..=1.0, "";
        /// Largest duty of the amplifier.
        duty_max: F32 = 0.9 in 0.0..=1.0, "";
        /// Largest plausible change of the twist since the start, at the motor. Beyond it an encoder is lost.
        twist_limit_rad: F32 = 10.0 in 1e-3..=1e5, "rad";
        /// Pulses on a channel of an encoder up to this length are noise. No longer filter passes the default speed limit of the
        /// motor.
        encoder_filter_ns: U32 = 35 in 0..=2666, "ns";
        /// What the outputs mean to the power stage.
        stage_mode: StageChoice = Board;
        /// Frequency of the pulse-width modulation.
        pwm_frequency_hz: U32 = 20_000 in 100..=20_000, "Hz";
    }
}

impl PinParameters {
    /// From torque to duties, on a board with this hardware.
    ///
    /// # Errors
    /// The board doesn't have the mode of the power stage.
    pub(super) fn modulation(&self, hardware: &PinHardware) -> Result<Modulation, ParameterError> {
        Ok(Modulation {
            mode: self.stage_mode.on(hardware.stage_modes)?,
            frequency_hz: self.pwm_frequency_hz,
            nm_per_full_duty: self.torque_per_duty_nm,
            offset: self.duty_offset,
            min: self.duty_min,
            max: self.duty_max,
            direction: self.torque_direction,
        })
    }
}
