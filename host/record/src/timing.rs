//! The timing of each control step, one row each, in us. Apart from the trace, because timing differs from run to run.

use std::time::Duration;

use lashloop_bench::timing::{StepOutcome, StepTiming};

use crate::row::row;

/// One control step. The parts of the round trip are NaN in a step without an answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimingRow {
    /// Control step, from 0.
    pub step: f64,
    /// Wake-up of the bench after its deadline; in bench mode, start of the drive's step after its due time.
    pub lateness_us: f64,
    /// 1 if the drive has answered in time, else 0.
    pub answered: f64,
    /// 1 if the step was missed and no sample sent, else 0.
    pub missed: f64,
    /// Sending the sample.
    pub send_us: f64,
    /// From the end of sending to the arrival of the answer, minus the drive's computing time.
    pub line_and_device_us: f64,
    /// The drive's computing time, in device time.
    pub compute_us: f64,
    /// Receiving the answer.
    pub receive_us: f64,
}

row! {
    TimingRow {
        step: "",
        lateness_us: "us",
        answered: "",
        missed: "",
        send_us: "us",
        line_and_device_us: "us",
        compute_us: "us",
        receive_us: "us",
    }
}

impl TimingRow {
    /// The row of a step, counted from 0.
    #[must_use]
    pub fn new(step: u64, timing: &StepTiming) -> Self {
        let flag = |is| f64::from(u8::from(is));
        let part = |part: Option<Duration>| part.map_or(f64::NAN, microseconds);
        let trip = timing.round_trip;
        Self {
            step: step as f64,
            lateness_us: microseconds(timing.lateness),
            answered: flag(timing.outcome == StepOutcome::Answered),
            missed: flag(timing.outcome == StepOutcome::Missed),
            send_us: part(trip.map(|trip| trip.send)),
            line_and_device_us: part(trip.map(|trip| trip.line_and_device)),
            compute_us: part(trip.map(|trip| trip.compute).or(timing.tick_compute)),
            receive_us: part(trip.map(|trip| trip.receive)),
        }
    }
}

fn microseconds(duration: Duration) -> f64 {
    duration.as_nanos() as f64 / 1e3
}
