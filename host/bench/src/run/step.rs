//! A step of a run, without an allocation: it goes from the thread of the loop to the record.

use heapless::Vec;
use lashloop_plant::limits::MAX_SIGNALS;
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;

use crate::record::row::Row;
use crate::record::trace::TraceRow;
use crate::timing::StepTiming;

/// A finished step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What every run has: time, reference, positions, torque.
    pub row: TraceRow,
    /// The plant's truth at that time, in the order of its signals.
    pub plant: TruthValues,
    /// The drive's signals, in the order of the subscription.
    pub drive: DriveValues,
    /// How the step went in time.
    pub timing: StepTiming,
}

/// What is known of a step before its exchange.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// The torque is that of the exchange, so it is 0 here.
    pub row: TraceRow,
    /// The plant's truth.
    pub plant: TruthValues,
}

/// Values of the plant's signals.
pub type TruthValues = Vec<f64, MAX_SIGNALS>;

/// Values of the subscribed signals, from the latest telemetry.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DriveValues {
    /// NaN before the first telemetry.
    pub values: Vec<f64, MAX_TELEMETRY_VALUES>,
    /// Time of the sample that they belong to; `None` before the first telemetry.
    pub time_s: Option<f64>,
}

impl DriveValues {
    /// Before the first telemetry of `count` signals, [`MAX_TELEMETRY_VALUES`] at most.
    pub(super) fn unknown(count: usize) -> Self {
        Self { values: std::iter::repeat_n(f64::NAN, count).collect(), time_s: None }
    }
}

impl Step {
    /// The drive's signals at this very step; `None` without a telemetry of its own. Values that are repeated until the next
    /// telemetry or came too late must not be compared with the truth of another step.
    #[must_use]
    pub fn fresh_drive(&self) -> Option<&[f64]> {
        (self.drive.time_s == Some(self.row.time_s)).then_some(&self.drive.values)
    }

    /// The row of the trace, in the order of [`columns`](crate::record::trace::columns).
    pub fn trace(&self) -> impl Iterator<Item = f64> {
        let telemetry_time_s = self.drive.time_s.unwrap_or(f64::NAN);
        let signals = self.plant.iter().chain(&self.drive.values).copied();
        self.row.values().chain(signals).chain([telemetry_time_s])
    }
}
