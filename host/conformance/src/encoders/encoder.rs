//! The two encoders of a drive.

use crate::answers::sample;
use crate::prelude::wire::*;

#[derive(Clone, Copy)]
pub(crate) struct Encoder {
    /// Position in [`Encoder::BOTH`].
    pub(crate) index: usize,
    pub(crate) name: &'static str,
    /// Name of the parameter with its speed limit.
    pub(crate) speed_limit: &'static str,
    /// Name of the parameter with its resolution.
    pub(crate) counts_per_rev: &'static str,
    /// Fault that a reading beyond the speed limit latches.
    pub(crate) jump_fault: FaultCode,
    pub(crate) counts_mut: fn(&mut EncoderSample) -> &mut EncoderCounts,
}

impl Encoder {
    pub(crate) const MOTOR: Self = Self {
        index: 0,
        name: "motor",
        speed_limit: "motor_speed_limit_rad_s",
        counts_per_rev: "motor_counts_per_rev",
        jump_fault: FaultCode::MotorEncoderJump,
        counts_mut: |sample| &mut sample.motor_counts,
    };
    pub(crate) const LOAD: Self = Self {
        index: 1,
        name: "load",
        speed_limit: "load_speed_limit_rad_s",
        counts_per_rev: "load_counts_per_rev",
        jump_fault: FaultCode::LoadEncoderJump,
        counts_mut: |sample| &mut sample.load_counts,
    };
    pub(crate) const BOTH: [Self; 2] = [Self::MOTOR, Self::LOAD];
}

/// A sample with one encoder at `counts` and the other at zero.
pub(crate) fn placed(encoder: Encoder, sequence: u16, counts: i64) -> EncoderSample {
    let mut sample = sample(sequence);
    *(encoder.counts_mut)(&mut sample) = EncoderCounts::wrapping(counts);
    sample
}
