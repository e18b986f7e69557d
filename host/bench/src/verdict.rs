//! PASS, FAIL or INVALID: what a run says, and the exit codes of the tool.
//!
//! FAIL means that the drive did not do what the scenario expects. INVALID means that the run says nothing
//! about the drive, because the link or the timing broke what the scenario allows; it outranks FAIL, since
//! what such a run measured can't be held against the drive.

use std::fmt;
use std::process::ExitCode;

use serde::Serialize;

use crate::scenario::expectation::Expectation;
use crate::scenario::sections::Allowance;
use crate::timing::{ClockName, Quantiles, TimingReport};
use lashloop_plant::metrics::{Measured, Metric, Metrics};

/// What a run says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Verdict {
    /// Every expectation is met.
    Pass,
    /// An expectation isn't met, or the run left the finite numbers.
    Fail,
    /// The link broke what the scenario allows.
    Invalid,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Pass => "PASS",
            Self::Fail => "FAIL",
            Self::Invalid => "INVALID",
        })
    }
}

/// How the tool ends, for scripts and CI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// The verdict is PASS, or there was nothing to judge.
    Pass = 0,
    /// The verdict is FAIL.
    Fail = 1,
    /// The command line or the scenario is wrong; nothing ran.
    UsageOrScenario = 2,
    /// The verdict is INVALID.
    Invalid = 3,
    /// The device or the link failed; there is no verdict.
    DeviceOrLink = 4,
}

impl From<Verdict> for Exit {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Pass => Self::Pass,
            Verdict::Fail => Self::Fail,
            Verdict::Invalid => Self::Invalid,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// What the link counted during a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct LinkCounts {
    /// Frames to the drive.
    pub frames_sent: u64,
    /// Good frames from the drive.
    pub frames_received: u64,
    /// Frames refused for their checksum.
    pub crc_errors: u64,
    /// Steps without an answer.
    pub lost: u64,
    /// Steps whose answer came too late.
    pub late: u64,
    /// Times that the drive was lost and came back.
    pub resumes: u64,
    /// Frames that reached the drive damaged, as the drive counted them.
    pub damaged_at_drive: u64,
    /// Bytes the drive's receiver lost, as the drive counted them.
    pub overruns_at_drive: u64,
}

/// One expectation held against its metric.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What was measured.
    pub metric: Metric,
    /// What came out; null in a summary if it has no value, and then never `ok`.
    pub value: Measured,
    /// The metric's unit.
    pub unit: &'static str,
    /// The least value that passes.
    pub min: Option<f64>,
    /// The greatest value that passes.
    pub max: Option<f64>,
    /// Whether the value is there and within its bounds.
    pub ok: bool,
}

impl Finding {
    fn new(expectation: &Expectation, metrics: &Metrics) -> Self {
        let &Expectation { metric, unit, min, max, .. } = expectation;
        let value = metrics.get(metric);
        let within = |value: f64| min.is_none_or(|min| value >= min) && max.is_none_or(|max| value <= max);
        Self { metric, value, unit, min, max, ok: value.value().is_some_and(within) }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { metric, value, unit, min, max, ok } = self;
        write!(f, "{metric}: {value}")?;
        if value.value().is_some() {
            write!(f, " {unit}")?;
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Breach {
    /// The key of `[allow]`.
    pub what: &'static str,
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

/// The verdict with its reasons.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// What the run says.
    pub verdict: Verdict,
    /// Every expectation, in the order of the scenario.
    pub findings: Vec<Finding>,
    /// Why the verdict is INVALID; empty otherwise.
    pub breaches: Vec<Breach>,
}

impl Judgement {
    /// Holds a run against its scenario. A run that left the finite numbers fails even if nothing was expected
    /// of it.
    #[must_use]
    pub fn new(
        expectations: &[Expectation],
        metrics: &Metrics,
        allow: &Allowance,
        counts: &LinkCounts,
        timing: &TimingReport,
    ) -> Self {
        let findings: Vec<_> =
            expectations.iter().map(|expectation| Finding::new(expectation, metrics)).collect();
        let breaches = breaches(allow, counts, timing);
        let verdict = if !breaches.is_empty() {
            Verdict::Invalid
        } else if metrics.run_was_finite() && findings.iter().all(|finding| finding.ok) {
            Verdict::Pass
        } else {
            Verdict::Fail
        };
        Self { verdict, findings, breaches }
    }

    /// Lowers the verdict to what the end of the run leaves possible: from PASS to FAIL or INVALID, and from FAIL to
    /// INVALID, never the other way.
    pub fn cap(&mut self, ceiling: Option<Verdict>) {
        if let Some(ceiling) = ceiling {
            self.verdict = self.verdict.max(ceiling);
        }
    }
}

fn breaches(allow: &Allowance, counts: &LinkCounts, timing: &TimingReport) -> Vec<Breach> {
    let p99_us = |quantiles: Option<Quantiles>| quantiles.map(|quantiles| quantiles.p99.ceil() as u64);
    // In real time, an answer that doesn't arrive in its period is late, whether it arrives at all or not.
    let (lost, late, late_in_a_row, lateness_p99_us) = match timing.clock {
        ClockName::RealTime => {
            (0, timing.late(), timing.longest_run_of_late, p99_us(timing.lateness_us))
        }
        ClockName::Lockstep => (counts.lost, counts.late, 0, Some(0)),
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
    .filter_map(|(what, counted, allowed)| allowed.map(|allowed| Breach { what, counted, allowed }))
    .filter(|breach| breach.counted.is_none_or(|counted| counted > breach.allowed))
    .collect()
}

#[cfg(test)]
mod tests;
