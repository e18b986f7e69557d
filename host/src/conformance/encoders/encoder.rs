//! The two encoders of a drive.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::EncoderSample;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoder {
    Motor,
    Load,
}

impl Encoder {
    pub(super) const BOTH: [Self; 2] = [Self::Motor, Self::Load];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Motor => "motor",
            Self::Load => "load",
        }
    }

    /// Name of the parameter with its speed limit.
    pub(super) const fn speed_limit(self) -> &'static str {
        match self {
            Self::Motor => "motor_speed_limit_rad_s",
            Self::Load => "load_speed_limit_rad_s",
        }
    }

    /// Name of the parameter with its resolution.
    pub(super) const fn counts_per_rev(self) -> &'static str {
        match self {
            Self::Motor => "motor_counts_per_rev",
            Self::Load => "load_counts_per_rev",
        }
    }

    /// Fault that a reading beyond the speed limit latches.
    pub(super) const fn jump_fault(self) -> FaultCode {
        match self {
            Self::Motor => FaultCode::MotorEncoderJump,
            Self::Load => FaultCode::LoadEncoderJump,
        }
    }

    pub(super) const fn counts_mut(self, sample: &mut EncoderSample) -> &mut EncoderCounts {
        match self {
            Self::Motor => &mut sample.motor_counts,
            Self::Load => &mut sample.load_counts,
        }
    }
}
