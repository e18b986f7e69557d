//! The report of a control step in bench mode.

use core::time::Duration;

use lashloop_protocol::enums::TorqueStatus;
use lashloop_protocol::message::{BenchSample, EncoderSample};

/// The report of a step with this torque in N m. The times are those at which the step was due, was started, and ended.
pub(super) fn bench_sample(
    sample: &EncoderSample,
    reference_number: u16,
    torque_nm: f32,
    status: TorqueStatus,
    (due, started, ended): (Duration, Duration, Duration),
) -> BenchSample {
    BenchSample {
        sequence: sample.sequence,
        motor_counts: sample.motor_counts,
        load_counts: sample.load_counts,
        reference_number,
        torque_nm,
        status,
        compute_time_us: whole_us(ended.saturating_sub(started)),
        tick_lateness_us: whole_us(started.saturating_sub(due)),
    }
}

/// In 32-bit arithmetic: a microcontroller divides 64 bits in software.
fn whole_us(time: Duration) -> u16 {
    if time.as_secs() > 0 { u16::MAX } else { u16::try_from(time.subsec_micros()).unwrap_or(u16::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_whole_microseconds_and_saturate() {
        assert_eq!(whole_us(Duration::from_nanos(12_999)), 12);
        assert_eq!(whole_us(Duration::from_millis(65)), 65_000);
        assert_eq!(whole_us(Duration::from_millis(66)), u16::MAX);
        assert_eq!(whole_us(Duration::from_secs(2)), u16::MAX);
    }
}
