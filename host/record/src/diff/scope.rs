//! What of two runs a comparison judges.
//!
//! A run in lockstep has the same bits each time. In real time the steps in which a torque came too late differ from run to
//! run, and so does the step with which a telemetry arrives. Up to the first step without a torque in time, all else is the
//! same. On hardware only the reference is.

use lashloop_bench::timing::ClockName;
use serde::Serialize;

use super::pairs::microseconds;
use super::record_files::RecordFiles;
use crate::trace::TELEMETRY_TIME;

/// What a comparison judges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "judged")]
pub enum Scope {
    /// Everything.
    All,
    /// What is the same each time in real time: neither metrics nor verdict, values of the drive at the step of their
    /// telemetry only, and no step from `until_s` on, if there is one.
    RealTime {
        /// The first step that either run made without a torque in time.
        until_s: Option<f64>,
    },
    /// The reference: positions and torques of hardware are measured.
    Hardware,
}

impl Scope {
    /// What is the same in each repetition of these two runs.
    pub(super) fn deterministic(records: &[RecordFiles; 2]) -> Self {
        if !records.iter().any(is_in_real_time) {
            return Self::All;
        }
        if records.iter().any(|it| !it.record.manifest.mode.is_hil()) {
            return Self::Hardware;
        }
        let late = records.iter().filter_map(first_late_s);
        Self::RealTime { until_s: late.min_by(f64::total_cmp) }
    }

    /// Whether a column has values that are judged.
    pub(super) fn has(self, name: &str) -> bool {
        match self {
            Self::All => true,
            Self::RealTime { .. } => name != TELEMETRY_TIME,
            Self::Hardware => name == "reference_rad",
        }
    }

    /// Whether a row is judged, whose time is `time_s`.
    pub(super) fn has_time(self, time_s: f64) -> bool {
        match self {
            Self::All | Self::Hardware => true,
            Self::RealTime { until_s } => {
                until_s.is_none_or(|until_s| microseconds(time_s) < microseconds(until_s))
            }
        }
    }
}

fn is_in_real_time(record: &RecordFiles) -> bool {
    record.record.manifest.clock == ClockName::RealTime
}

/// Time of the first step without a torque in time.
fn first_late_s(record: &RecordFiles) -> Option<f64> {
    let answered = record.record.timing.get("answered")?;
    let late = answered.iter().position(|answered| *answered != 1.0)?;
    record.record.trace.get("time_s")?.get(late).copied()
}
