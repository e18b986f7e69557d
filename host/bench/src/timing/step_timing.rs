//! The timing of one step.

use std::time::Duration;

use lashloop_protocol::message::TorqueAnswer;
use lashloop_session::Timestamps;

/// The outcome of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepOutcome {
    /// The torque arrived in time.
    Answered,
    /// No torque by the end of the step: the last one was held.
    Unanswered,
    /// The bench overslept the step: no sample was sent, the last torque was held.
    Missed,
}

/// The parts of one round trip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RoundTrip {
    /// Encoding the sample and writing it to the link.
    pub send: Duration,
    /// On the line and in the device, without the drive's compute time.
    pub line_and_device: Duration,
    /// From the complete sample to the torque, by the drive's own clock.
    pub compute: Duration,
    /// Reading and decoding the answer.
    pub receive: Duration,
}

impl RoundTrip {
    /// The parts of an exchange that was answered.
    #[must_use]
    pub fn new(timestamps: &Timestamps, answer: &TorqueAnswer) -> Self {
        let &Timestamps { asked, sent, arrived, decoded } = timestamps;
        let compute = Duration::from_nanos(100 * u64::from(answer.compute_tenths_us));
        let line_and_device = arrived.saturating_duration_since(sent).saturating_sub(compute);
        Self {
            send: sent - asked,
            line_and_device,
            compute,
            receive: decoded.saturating_duration_since(arrived),
        }
    }

    /// The whole round trip.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.send + self.line_and_device + self.compute + self.receive
    }
}

/// The timing of one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepTiming {
    /// From the due time of the step to its beginning; zero in lockstep, where no step is due.
    pub lateness: Duration,
    /// Its outcome.
    pub outcome: StepOutcome,
    /// The parts of its round trip, if it was answered.
    pub round_trip: Option<RoundTrip>,
    /// Bench mode: the drive's compute time of the step. The drive's own timer began the step, so the lateness is that of the
    /// drive too, and there is no round trip.
    pub tick_compute: Option<Duration>,
}

impl StepTiming {
    /// The timing of a step without times.
    pub(crate) const fn of(outcome: StepOutcome) -> Self {
        Self { lateness: Duration::ZERO, outcome, round_trip: None, tick_compute: None }
    }
}
