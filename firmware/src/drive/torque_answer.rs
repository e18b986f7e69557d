//! The answer to a sample.

use core::time::Duration;

use lashloop_protocol::enums::{State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::TorqueAnswer;

/// A torque in N m for the sample of this number, computed within `elapsed` of its arrival.
pub(super) fn torque_answer(
    sequence: u16,
    torque_nm: f32,
    state: State,
    flags: TorqueFlags,
    elapsed: Duration,
) -> TorqueAnswer {
    let status = TorqueStatus { state, flags };
    TorqueAnswer { sequence, torque_nm, status, compute_tenths_us: tenths_us(elapsed) }
}

/// The same answer again, flagged as repeated.
pub(super) fn repeated(answer: TorqueAnswer) -> TorqueAnswer {
    let flags = answer.status.flags | TorqueFlags::REPEATED;
    TorqueAnswer { status: TorqueStatus { flags, ..answer.status }, ..answer }
}

/// A time in 0.1 us, saturated. In 32-bit arithmetic: a microcontroller divides 64 bits in software.
pub(super) fn tenths_us(time: Duration) -> u16 {
    if time.as_secs() > 0 { u16::MAX } else { u16::try_from(time.subsec_nanos() / 100).unwrap_or(u16::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compute_time_saturates_at_its_largest_value() {
        assert_eq!(tenths_us(Duration::from_nanos(5_730)), 57);
        assert_eq!(tenths_us(Duration::from_micros(6_553)), 65_530);
        assert_eq!(tenths_us(Duration::from_millis(7)), u16::MAX);
        assert_eq!(tenths_us(Duration::from_secs(3)), u16::MAX);
    }
}
