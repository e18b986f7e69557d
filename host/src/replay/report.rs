//! What differs between a recorded run and its replay.

use std::fmt;

use lashloop_protocol::message::FaultReport;
use lashloop_record::diff::{Agreement, Tolerance, exact, figure};
use lashloop_record::manifest::Number;
use serde::{Serialize, Serializer};

use super::recording::{RecordedStep, Recording};

/// The torques of a record and of its replay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replay {
    /// Torques compared.
    pub compared: usize,
    /// Torques that differ in at least one bit.
    pub differing: usize,
    /// The first of these.
    pub first: Option<TorquePair>,
    /// The largest difference.
    pub largest: Option<TorquePair>,
    /// Samples that were sent and have no torque in the record.
    pub unanswered: usize,
    /// The first step of these.
    pub first_unanswered: Option<u32>,
    /// Steps without a sample: missed in the record, missed here.
    pub missed: usize,
    /// How often the drive of the record was lost and started again; `None` for an interrupted run.
    pub resumes: Option<u64>,
    /// The step from which on the record can't be replayed.
    pub ends_before: Option<u32>,
    /// What ended the replay early.
    pub end: Option<DriveEnd>,
    #[serde(skip)]
    tolerance: Option<Tolerance>,
    /// Largest amount of a recorded torque in N m.
    peak_nm: f64,
    period_s: f64,
}

/// The torques of one step in N m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TorquePair {
    /// Step of the run.
    pub step: u32,
    /// The torque of the record.
    pub recorded_nm: f32,
    /// The torque of the replay.
    pub replayed_nm: f32,
}

/// What ended a replay early.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum DriveEnd {
    /// The drive latched a fault.
    Fault {
        /// Step of the run.
        step: u32,
        /// Its report.
        #[serde(flatten, serialize_with = "fault")]
        report: FaultReport,
    },
    /// The user asked for the end.
    Interrupted,
}

fn fault<S: Serializer>(report: &FaultReport, serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Fault {
        code: String,
        value: Number,
        limit: Number,
    }
    Fault {
        code: report.code.to_string(),
        value: Number::Real(report.value),
        limit: Number::Real(report.limit),
    }
    .serialize(serializer)
}

impl TorquePair {
    /// Replayed less recorded torque.
    #[must_use]
    pub fn difference_nm(&self) -> f64 {
        f64::from(self.replayed_nm) - f64::from(self.recorded_nm)
    }
}

impl Replay {
    pub(super) fn new(recording: &Recording, tolerance: Option<Tolerance>) -> Self {
        Self {
            compared: 0,
            differing: 0,
            first: None,
            largest: None,
            unanswered: 0,
            first_unanswered: None,
            missed: recording.missed,
            resumes: recording.resumes,
            ends_before: recording.ends_before,
            end: None,
            tolerance,
            peak_nm: 0.0,
            period_s: recording.period_s,
        }
    }

    /// Compares the torque of a step.
    pub(super) fn push(&mut self, recorded: &RecordedStep, replayed_nm: f32) {
        let step = recorded.step;
        let Some(recorded_nm) = recorded.torque_nm else {
            self.unanswered += 1;
            self.first_unanswered.get_or_insert(step);
            return;
        };
        self.compared += 1;
        self.peak_nm = self.peak_nm.max(f64::from(recorded_nm).abs());
        if recorded_nm.to_bits() == replayed_nm.to_bits() {
            return;
        }
        let pair = TorquePair { step, recorded_nm, replayed_nm };
        self.differing += 1;
        self.first.get_or_insert(pair);
        // NaN counts as an infinite difference.
        let amount = |it: &TorquePair| {
            if it.difference_nm().is_nan() { f64::INFINITY } else { it.difference_nm().abs() }
        };
        if self.largest.as_ref().is_none_or(|largest| amount(&pair) > amount(largest)) {
            self.largest = Some(pair);
        }
    }

    /// Whether the torques are equal.
    #[must_use]
    pub fn agreement(&self) -> Agreement {
        let is_within = |pair: TorquePair| {
            self.tolerance.is_some_and(|tolerance| pair.difference_nm().abs() <= tolerance.at(self.peak_nm))
        };
        match (&self.end, self.largest) {
            (None, None) => Agreement::Bits,
            (None, Some(largest)) if is_within(largest) => Agreement::Tolerance,
            (Some(_), _) | (None, Some(_)) => Agreement::Different,
        }
    }

    /// The result with its agreement as JSON.
    ///
    /// # Errors
    /// A value has no JSON.
    pub fn to_json(&self) -> serde_json::Result<String> {
        #[derive(Serialize)]
        struct Judged<'a> {
            agreement: Agreement,
            #[serde(flatten)]
            replay: &'a Replay,
        }
        serde_json::to_string_pretty(&Judged { agreement: self.agreement(), replay: self })
    }
}

impl fmt::Display for Replay {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { compared, differing, missed, unanswered, .. } = self;
        writeln!(out, "torques     {compared} compared, {differing} differ")?;
        if *missed > 0 {
            writeln!(out, "missed      {missed} steps sent no sample in the record, and none here")?;
        }
        if let Some(step) = self.first_unanswered {
            writeln!(
                out,
                "unanswered  {unanswered} samples have no torque in the record, the first in step {step}: whether the drive received \
                 them is not recorded, so a difference from there on may be the line's"
            )?;
        }
        if let (Some(step), Some(resumes)) = (self.ends_before, self.resumes) {
            writeln!(
                out,
                "restarted   the drive of the record was lost and started again {resumes} times, in steps that are not recorded; the \
                 replay ends before step {step}, the first without an answer"
            )?;
        }
        if self.resumes.is_none() {
            writeln!(
                out,
                "restarted   the run was interrupted, so the record does not show whether its drive was lost and started again: a \
                 difference after a step without an answer may come from that"
            )?;
        }
        for (what, pair) in [("first", self.first), ("largest", self.largest)] {
            let Some(pair) = pair else { continue };
            let [recorded, replayed] = exact([pair.recorded_nm.into(), pair.replayed_nm.into()]);
            writeln!(
                out,
                "{what:<11} step {}, {} s: recorded {recorded} N m, replayed {replayed} N m, difference {} N m",
                pair.step,
                figure(f64::from(pair.step) * self.period_s),
                figure(pair.difference_nm())
            )?;
        }
        match &self.end {
            Some(DriveEnd::Fault { step, report }) => writeln!(
                out,
                "fault       step {step}: the drive latched {} (value {}, limit {}); the record has no fault there",
                report.code, report.value, report.limit
            )?,
            Some(DriveEnd::Interrupted) => writeln!(out, "interrupted by the user")?,
            None => {}
        }
        out.write_str(match self.agreement() {
            Agreement::Bits => "EQUAL bit for bit",
            Agreement::Tolerance => "EQUAL within the tolerance",
            Agreement::Different => "DIFFERENT",
        })
    }
}
