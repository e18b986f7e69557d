//! Judging a run by its scenario.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::exit::Verdict;
use crate::number::Apart;
use crate::scenario::expectation::Expectation;
use crate::scenario::sections::Allowance;
use crate::timing::{ClockName, Quantiles, TimingReport};
use lashloop_plant::metrics::{Measured, Metrics, Quantity, Window};

/// Counters of the link during a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkCounts {
    /// Frames sent to the drive.
    pub frames_sent: u64,
    /// Valid frames received from the drive.
    pub frames_received: u64,
    /// Frames rejected for their checksum.
    pub crc_errors: u64,
    /// Steps without an answer.
    pub lost: u64,
    /// Steps whose answer arrived late.
    pub late: u64,
    /// Times that a lost drive came back and the run resumed.
    pub resumes: u64,
    /// Damaged frames, as counted by the drive.
    pub damaged_at_drive: u64,
    /// Bytes lost to receiver overruns, as counted by the drive.
    pub overruns_at_drive: u64,
}

/// An expectation and what its quantity came out as.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JudgedExpectation {
    /// The metric, or the signal and its statistic.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// The part of the run that is judged; `None` for all of it.
    #[serde(flatten)]
    pub window: Option<Window>,
    /// Its value; null in a summary if the run has none, and then never `ok`.
    pub value: Measured,
    /// Why there is no value; a summary has the reason here alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The quantity's unit.
    pub unit: String,
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
    /// Whether there is a value, within the bounds.
    pub ok: bool,
}

impl JudgedExpectation {
    fn new(expectation: &Expectation, metrics: &Metrics) -> Self {
        let &Expectation { min, max, window, .. } = expectation;
        let value = metrics.answer(&expectation.query());
        let within = |value: f64| min.is_none_or(|min| value >= min) && max.is_none_or(|max| value <= max);
        Self {
            quantity: expectation.quantity.clone(),
            window,
            value,
            reason: value.reason(),
            unit: expectation.unit.clone(),
            min,
            max,
            ok: value.value().is_some_and(within),
        }
    }

    /// What is judged: the quantity, with its window if it has one.
    #[must_use]
    pub fn name(&self) -> String {
        match self.window {
            Some(window) => format!("{}, {window}", self.quantity),
            None => self.quantity.to_string(),
        }
    }
}

impl fmt::Display for JudgedExpectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, reason, unit, min, max, ok, .. } = self;
        f.write_str(&self.name())?;
        match value.value() {
            Some(value) => write!(f, ": {} {unit}", Apart::new(value, *min, *max))?,
            None => write!(f, ": {}", reason.as_deref().unwrap_or("no value"))?,
        }
        write!(f, "; {} ", if *ok { "meets" } else { "misses" })?;
        match (min, max) {
            (Some(min), Some(max)) => write!(f, "{min} to {max} {unit}"),
            (Some(min), None) => write!(f, "at least {min} {unit}"),
            (None, Some(max)) => write!(f, "at most {max} {unit}"),
            (None, None) => f.write_str("no bound"),
        }
    }
}

/// A count of the link or a figure of timing beyond what the scenario allows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Breach {
    /// The key of `[allow]`.
    pub what: Cow<'static, str>,
    /// The run's figure; `None` if the run has none, which meets no limit.
    pub counted: Option<u64>,
    /// The limit.
    pub allowed: u64,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, counted, allowed } = self;
        match counted {
            None => write!(f, "{what}: nothing to measure, allow.{what} is {allowed}"),
            Some(counted) => write!(f, "{what}: {counted} counted, allow.{what} is {allowed}"),
        }
    }
}

/// The verdict of a run with its reasons.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// The verdict.
    pub verdict: Verdict,
    /// Every expectation, in the order of the scenario.
    pub expectations: Vec<JudgedExpectation>,
    /// Limits of the scenario that link or timing exceeded; the verdict is then INVALID.
    pub breaches: Vec<Breach>,
    /// Where the recorded motion leaves the plant model; the verdict is then INVALID.
    pub gate: Option<String>,
}

impl Judgement {
    /// Judges a run by its scenario. A run with a metric that isn't finite fails, even without expectations.
    #[must_use]
    pub fn new(
        expectations: &[Expectation],
        metrics: &Metrics,
        allow: &Allowance,
        counts: &LinkCounts,
        timing: &TimingReport,
    ) -> Self {
        let expectations: Vec<_> =
            expectations.iter().map(|expectation| JudgedExpectation::new(expectation, metrics)).collect();
        let breaches = breaches(allow, counts, timing);
        let verdict = if !breaches.is_empty() {
            Verdict::Invalid
        } else if metrics.run_was_finite() && expectations.iter().all(|judged| judged.ok) {
            Verdict::Pass
        } else {
            Verdict::Fail
        };
        Self { verdict, expectations, breaches, gate: None }
    }

    /// Lowers the verdict to `ceiling`, for a run that ended early: PASS to FAIL or INVALID, FAIL to INVALID, never upwards.
    pub fn cap(&mut self, ceiling: Option<Verdict>) {
        if let Some(ceiling) = ceiling {
            self.verdict = self.verdict.max(ceiling);
        }
    }

    /// Makes the verdict INVALID: the run was on another plant than the model.
    pub fn close_gate(&mut self, reason: String) {
        self.gate = Some(reason);
        self.cap(Some(Verdict::Invalid));
    }

    /// Makes the verdict FAIL, for a drive that breaks a rule of the protocol: what the line did explains none of it.
    pub fn fail(&mut self) {
        self.verdict = Verdict::Fail;
    }
}

fn breaches(allow: &Allowance, counts: &LinkCounts, timing: &TimingReport) -> Vec<Breach> {
    let p99_us = |quantiles: Option<Quantiles>| quantiles.map(|quantiles| quantiles.p99.ceil() as u64);
    // In real time, an answer that doesn't arrive in its period is late, whether it arrives at all or not.
    let (lost, late, late_in_a_row, lateness_p99_us) = match timing.clock {
        ClockName::RealTime => (0, timing.late(), timing.longest_run_of_late, p99_us(timing.lateness_us)),
        // Of the bench nothing is due; the drive's own tick is, in bench mode.
        ClockName::Lockstep => (counts.lost, counts.late, 0, p99_us(timing.lateness_us).or(Some(0))),
    };
    [
        ("lost", Some(lost), Some(allow.lost)),
        ("late", Some(late), Some(allow.late)),
        ("late_in_a_row", Some(late_in_a_row), allow.late_in_a_row),
        ("crc_errors", Some(counts.crc_errors), Some(allow.crc_errors)),
        ("resumes", Some(counts.resumes), Some(allow.resumes)),
        ("lateness_p99_us", lateness_p99_us, allow.lateness_p99_us),
        ("round_trip_p99_us", p99_us(timing.round_trip_us), allow.round_trip_p99_us),
    ]
    .into_iter()
    .filter_map(|(what, counted, allowed)| {
        allowed.map(|allowed| Breach { what: what.into(), counted, allowed })
    })
    .filter(|breach| breach.counted.is_none_or(|counted| counted > breach.allowed))
    .collect()
}
