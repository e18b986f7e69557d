//! How the steps of a run went in time, and the report of it.
//!
//! A step is a round trip: the bench wakes, sends a sample, waits, and has the torque.
//!
//! ```text
//! due    woke   asked      sent                     arrived    decoded
//!  ├──────┼───────┼──────────┼─────────────────────────┼──────────┤
//!  lateness        send        line and device, compute   receive
//! ```
//!
//! Computing is what the drive says of itself in its answer; the rest of the time away is the line's and the operating
//! systems'.

mod quantiles;
mod report;

use std::time::{Duration, Instant};

use lashloop_protocol::message::TorqueAnswer;

pub use quantiles::Quantiles;
pub use report::{ClockName, TimingReport, Timings};

/// What became of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepOutcome {
    /// The torque came in time.
    Answered,
    /// No torque by the end of the step: the last one was held.
    Unanswered,
    /// The bench itself slept through the step: no sample was sent, the last torque was held.
    Missed,
}

/// The timestamps of one exchange on the bench's side.
#[derive(Debug, Clone, Copy)]
pub struct Timestamps {
    /// Before the sample was handed to the line.
    pub asked: Instant,
    /// When the line had taken it.
    pub sent: Instant,
    /// When the bytes were read that ended the wait.
    pub arrived: Instant,
    /// When they had been understood.
    pub decoded: Instant,
}

/// Where the time of one round trip went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RoundTrip {
    /// From the hand of the bench to the line.
    pub send: Duration,
    /// On the line and in the device, without computing.
    pub line_and_device: Duration,
    /// From the whole sample to the ready torque, by the drive's own clock.
    pub compute: Duration,
    /// From the line to a torque.
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

    /// All of it.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.send + self.line_and_device + self.compute + self.receive
    }
}

/// One step in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepTiming {
    /// How long after its due time the step began; zero in lockstep, where nothing is due.
    pub lateness: Duration,
    /// What became of it.
    pub outcome: StepOutcome,
    /// Where the time went, if it was answered.
    pub round_trip: Option<RoundTrip>,
}
