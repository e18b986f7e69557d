//! The parameters of the drive itself, which every law has besides its own.

use core::f32::consts::TAU;

use lashloop_protocol::EncoderCounts;

/// Finest encoder in counts per revolution: one revolution takes the whole range of a reading.
pub const COUNTS_PER_REV_MAX: u32 = 1 << EncoderCounts::BITS;

crate::parameters! {
    /// The parameters of the drive itself, apart from the choice of the law.
    pub struct DriveParameters {
        /// Control period.
        period_us: U32 = 1000 in 100..=100_000, "us";
        /// Resolution of the motor encoder, after quadrature.
        motor_counts_per_rev: U32 = 131_072 in 4..=COUNTS_PER_REV_MAX, "counts/rev";
        /// Resolution of the load encoder, after quadrature.
        load_counts_per_rev: U32 = 131_072 in 4..=COUNTS_PER_REV_MAX, "counts/rev";
        /// Reduction ratio N0, for the twist.
        reduction_ratio: F32 = 3.0 in 1e-3..=1e4, "";

        /// Largest torque, in either direction.
        torque_limit_nm: F32 = 20.0 in 0.0..=1000.0, "N m";
        /// Longest time without a new sample while running, in device time.
        watchdog_us: U32 = 20_000 in 200..=60_000_000, "us";
        /// Largest plausible speed of the motor.
        motor_speed_limit_rad_s: F32 = 1000.0 in 0.1..=1e6, "rad/s";
        /// Largest plausible speed of the load.
        load_speed_limit_rad_s: F32 = 100.0 in 0.1..=1e6, "rad/s";

        /// Bandwidth of the motor velocity filter.
        motor_filter_rad_s: F32 = 400.0 in 0.01..=1e6, "rad/s";
        /// Bandwidth of the load velocity filter.
        load_filter_rad_s: F32 = 200.0 in 0.01..=1e6, "rad/s";
    }
}

impl DriveParameters {
    /// Control period in seconds.
    #[must_use]
    pub fn period_s(&self) -> f32 {
        self.period_us as f32 * 1e-6
    }

    /// One count of the motor encoder in rad.
    #[must_use]
    pub fn motor_resolution_rad(&self) -> f32 {
        TAU / self.motor_counts_per_rev as f32
    }

    /// One count of the load encoder in rad.
    #[must_use]
    pub fn load_resolution_rad(&self) -> f32 {
        TAU / self.load_counts_per_rev as f32
    }
}
