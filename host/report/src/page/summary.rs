//! `summary.json` as a page reads it: of every version, so that most keys may be absent.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use lashloop_record::reader::ReadFault;
use serde::Deserialize;

/// A summary.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Summary {
    pub(super) verdict: String,
    pub(super) scenario: String,
    pub(super) device: String,
    #[serde(default)]
    pub(super) evidence: Evidence,
    #[serde(default)]
    pub(super) mode: Option<String>,
    pub(super) controller: String,
    #[serde(default)]
    pub(super) seed: Option<u64>,
    pub(super) end: String,
    #[serde(default)]
    pub(super) gate: Option<String>,
    #[serde(default)]
    pub(super) breaches: Vec<Breach>,
    #[serde(default)]
    pub(super) steps: u64,
    #[serde(default)]
    pub(super) simulated_s: f64,
    #[serde(default)]
    pub(super) wall_s: f64,
    #[serde(default)]
    pub(super) metrics: BTreeMap<String, Option<f64>>,
    #[serde(default)]
    pub(super) metrics_without_value: BTreeMap<String, String>,
    #[serde(default)]
    pub(super) expectations: Vec<Expectation>,
    #[serde(default)]
    pub(super) link: BTreeMap<String, u64>,
    #[serde(default)]
    pub(super) timing: Timing,
    #[serde(default)]
    pub(super) faults: Vec<Fault>,
    #[serde(default)]
    pub(super) torque_sha256: Option<String>,
    #[serde(default)]
    pub(super) versions: BTreeMap<String, serde_json::Value>,
}

/// Origin of the drive.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub(super) struct Evidence {
    #[serde(default)]
    pub(super) files: Vec<FileHash>,
    #[serde(default)]
    pub(super) bench_build: String,
    #[serde(default)]
    pub(super) warnings: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct FileHash {
    pub(super) path: String,
    pub(super) sha256: Option<String>,
}

/// A count beyond what the scenario allows.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Breach {
    pub(super) what: String,
    pub(super) counted: Option<u64>,
    pub(super) allowed: u64,
}

/// A judged expectation.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Expectation {
    #[serde(default)]
    metric: Option<String>,
    #[serde(default)]
    signal: Option<String>,
    #[serde(default)]
    statistic: Option<String>,
    #[serde(default)]
    from_s: Option<f64>,
    #[serde(default)]
    to_s: Option<f64>,
    pub(super) value: Option<f64>,
    #[serde(default)]
    pub(super) reason: Option<String>,
    #[serde(default)]
    pub(super) unit: String,
    pub(super) min: Option<f64>,
    pub(super) max: Option<f64>,
    pub(super) ok: bool,
}

/// What is judged.
impl fmt::Display for Expectation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.metric, &self.statistic, &self.signal) {
            (Some(metric), ..) => out.write_str(metric)?,
            (None, Some(statistic), Some(signal)) => write!(out, "{statistic} of {signal}")?,
            _ => out.write_str("unnamed quantity")?,
        }
        match (self.from_s, self.to_s) {
            (Some(from_s), Some(to_s)) => write!(out, ", {from_s} s to {to_s} s"),
            (Some(from_s), None) => write!(out, ", from {from_s} s"),
            (None, Some(to_s)) => write!(out, ", to {to_s} s"),
            (None, None) => Ok(()),
        }
    }
}

/// Timing of all steps.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub(super) struct Timing {
    #[serde(default)]
    pub(super) clock: String,
    #[serde(default)]
    pub(super) period_us: u32,
    #[serde(default)]
    pub(super) warm_up_steps: u64,
    #[serde(default)]
    pub(super) unanswered: u64,
    #[serde(default)]
    pub(super) missed: u64,
    #[serde(default)]
    pub(super) longest_run_of_late: u64,
    #[serde(default)]
    pub(super) lateness_us: Option<Quantiles>,
    #[serde(default)]
    pub(super) round_trip_us: Option<Quantiles>,
    #[serde(default)]
    pub(super) send_us: Option<Quantiles>,
    #[serde(default)]
    pub(super) line_and_device_us: Option<Quantiles>,
    #[serde(default)]
    pub(super) compute_us: Option<Quantiles>,
    #[serde(default)]
    pub(super) receive_us: Option<Quantiles>,
    /// Upper end in us and count of each bin.
    #[serde(default)]
    pub(super) lateness_histogram: Vec<(f64, u64)>,
    #[serde(default)]
    pub(super) round_trip_histogram: Vec<(f64, u64)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub(super) struct Quantiles {
    pub(super) p50: f64,
    pub(super) p99: f64,
    pub(super) p99_9: f64,
    pub(super) max: f64,
}

/// An injected fault.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Fault {
    pub(super) kind: String,
    pub(super) step: u64,
    #[serde(default)]
    pub(super) until_step: Option<u64>,
    #[serde(default)]
    pub(super) frames: Option<u64>,
}

impl Summary {
    /// Reads a summary; `None` for an interrupted run, which has none.
    pub(super) fn read(path: &Path) -> Result<Option<Self>, ReadFault> {
        match fs::read(path) {
            Ok(text) => serde_json::from_slice(&text).map(Some).map_err(ReadFault::Summary),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(ReadFault::Read(error)),
        }
    }
}
