//! The report of a control step in bench mode.

use core::time::Duration;

use lashloop_protocol::enums::TorqueStatus;
use lashloop_protocol::message::{BenchSample, EncoderSample};

use super::torque_answer::tenths_us;

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
        compute_tenths_us: tenths_us(ended.saturating_sub(started)),
        lateness_tenths_us: tenths_us(started.saturating_sub(due)),
    }
}
