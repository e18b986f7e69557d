//! The two encoders of a drive.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::EncoderSample;

use crate::conformance::answers::sample;

#[derive(Clone, Copy)]
pub(in crate::conformance) struct Encoder {
    /// Position in [`Encoder::BOTH`].
    pub(in crate::conformance) index: usize,
    pub(in crate::conformance) name: &'static str,
    /// Name of the parameter with its speed limit.
    pub(in crate::conformance) speed_limit: &'static str,
    /// Name of the parameter with its resolution.
    pub(in crate::conformance) counts_per_rev: &'static str,
    /// Fault that a reading beyond the speed limit latches.
    pub(in crate::conformance) jump_fault: FaultCode,
    pub(in crate::conformance) counts_mut: fn(&mut EncoderSample) -> &mut EncoderCounts,
}

impl Encoder {
    pub(in crate::conformance) const MOTOR: Self = Self {
        index: 0,
        name: "motor",
        speed_limit: "motor_speed_limit_rad_s",
        counts_per_rev: "motor_counts_per_rev",
        jump_fault: FaultCode::MotorEncoderJump,
        counts_mut: |sample| &mut sample.motor_counts,
    };
    pub(in crate::conformance) const LOAD: Self = Self {
        index: 1,
        name: "load",
        speed_limit: "load_speed_limit_rad_s",
        counts_per_rev: "load_counts_per_rev",
        jump_fault: FaultCode::LoadEncoderJump,
        counts_mut: |sample| &mut sample.load_counts,
    };
    pub(in crate::conformance) const BOTH: [Self; 2] = [Self::MOTOR, Self::LOAD];
}

/// A sample with one encoder at `counts` and the other at zero.
pub(in crate::conformance) fn placed(encoder: Encoder, sequence: u16, counts: i64) -> EncoderSample {
    let mut sample = sample(sequence);
    *(encoder.counts_mut)(&mut sample) = EncoderCounts::wrapping(counts);
    sample
}
