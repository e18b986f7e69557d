//! `summary.json`: the verdict and all that is needed to check, compare and repeat it.

use std::fmt;
use std::path::Path;

use indexmap::IndexMap;
use lashloop_protocol::message::Identity;
use lashloop_protocol::{MINOR_VERSION, PROTOCOL_VERSION};
use serde::{Deserialize, Serialize};

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::{Device, Evidence};
use lashloop_bench::fault::timeline::FaultRecord;
use lashloop_bench::run::{End, Outcome};
use lashloop_bench::scenario::{RunMode, Scenario};
use lashloop_bench::timing::TimingReport;
use lashloop_bench::verdict::{Breach, BrokenRuleReport, JudgedExpectation, LinkCounts, Verdict};
use lashloop_session::Subscription;

use crate::json_file::write_json;

/// Summary of a run: one JSON object with its keys in this order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The verdict.
    pub verdict: Verdict,
    /// The scenario's file.
    pub scenario: String,
    /// The device and its address.
    pub device: String,
    /// The files that ran as the drive, with their hashes, and what casts doubt on their origin.
    pub evidence: Evidence,
    /// The mode; left out in HIL mode. A run in bench mode has no truth: positions are those of the drive's encoders, the signals
    /// of the plant are NaN, and metrics that need them have no value.
    #[serde(default, skip_serializing_if = "RunMode::is_hil")]
    pub mode: RunMode,
    /// The control law.
    pub controller: String,
    /// The telemetry subscribed.
    pub telemetry: Telemetry,
    /// Seed of every random stream of the run.
    pub seed: u64,
    /// How the run ended.
    pub end: RunEnd,
    /// The rule that ended the run, if the drive broke one; left out otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub broken_rule: Option<BrokenRuleReport>,
    /// Why the verdict is INVALID; left out otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub breaches: Vec<Breach>,
    /// Where the recorded motion leaves the plant model; left out otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gate: Option<String>,
    /// Why the verdict is not PASS, each reason as one phrase; left out for PASS.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<String>,
    /// Number of control steps.
    pub steps: u64,
    /// Simulated time.
    pub simulated_s: f64,
    /// Wall-clock time.
    pub wall_s: f64,
    /// The metrics by name, null where there is no value. Another version may have others.
    pub metrics: IndexMap<String, Option<f64>>,
    /// The reason of each null by name.
    pub metrics_without_value: IndexMap<String, String>,
    /// The expectations of the scenario with the values measured.
    pub expectations: Vec<JudgedExpectation>,
    /// Counters of the link.
    pub link: LinkCounts,
    /// Timing of the steps.
    pub timing: TimingReport,
    /// The injected faults.
    pub faults: Vec<FaultRecord>,
    /// Digest of all torques, see [`TorqueDigest`](lashloop_bench::run::digest::TorqueDigest).
    pub torque_sha256: String,
    /// Versions of tool, protocol and firmware.
    pub versions: Versions,
}

/// How a run ended; a text in the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum RunEnd {
    /// After its full duration.
    Complete,
    /// Early, by what this says.
    Early(String),
}

const COMPLETE: &str = "complete";

impl RunEnd {
    /// What ended the run early.
    #[must_use]
    pub fn early(&self) -> Option<&str> {
        match self {
            Self::Complete => None,
            Self::Early(what) => Some(what),
        }
    }
}

impl From<String> for RunEnd {
    fn from(text: String) -> Self {
        if text == COMPLETE { Self::Complete } else { Self::Early(text) }
    }
}

impl From<RunEnd> for String {
    fn from(end: RunEnd) -> Self {
        end.to_string()
    }
}

impl From<&End> for RunEnd {
    fn from(end: &End) -> Self {
        match end {
            End::Complete => Self::Complete,
            early => Self::Early(early.to_string()),
        }
    }
}

impl fmt::Display for RunEnd {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.early().unwrap_or(COMPLETE))
    }
}

/// Versions of everything that can change the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Versions {
    /// This tool.
    pub lashloop: String,
    /// The protocol version in use.
    pub protocol: String,
    /// The drive's firmware.
    pub firmware: String,
    /// First 32 bits of the commit that the firmware was built from, in hexadecimal; null if the drive doesn't know it.
    pub firmware_build: Option<String>,
    /// Whether the firmware was built from a tree with changes that are not committed, or from an unknown one.
    pub firmware_dirty: bool,
}

/// The telemetry that the drive sent.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Its period in steps; 0 for none.
    pub every_steps: u16,
    /// Names of the signals, in the order of their columns.
    pub signals: Vec<String>,
}

impl From<&Subscription> for Telemetry {
    fn from(subscription: &Subscription) -> Self {
        let signals = subscription.signals().iter().map(|it| it.signal.name.to_string()).collect();
        Self { every_steps: subscription.every, signals }
    }
}

impl Versions {
    /// The versions of a run by this tool of the drive with this identity.
    #[must_use]
    pub fn of(identity: &Identity) -> Self {
        let build = identity.build_id;
        Self {
            lashloop: env!("CARGO_PKG_VERSION").to_owned(),
            protocol: format!("{PROTOCOL_VERSION}.{MINOR_VERSION}"),
            firmware: identity.firmware.to_string(),
            firmware_build: (build != 0).then(|| format!("{build:08x}")),
            firmware_dirty: identity.dirty != 0,
        }
    }
}

impl Summary {
    /// The summary of a run of a scenario on a device.
    #[must_use]
    pub fn new(scenario: &Scenario, device: &Device, outcome: &Outcome) -> Self {
        let judgement = &outcome.judgement;
        let metrics =
            || outcome.metrics.iter().map(|(metric, measured)| (metric.name().to_owned(), measured));
        Self {
            verdict: judgement.verdict,
            scenario: scenario.name.clone(),
            device: device.description(),
            evidence: device.evidence(),
            mode: scenario.run.mode,
            controller: scenario.controller.name.clone(),
            telemetry: Telemetry::from(device.session.subscription()),
            seed: scenario.run.seed,
            end: RunEnd::from(&outcome.end),
            broken_rule: outcome.end.broken_rule().map(BrokenRuleReport::from),
            breaches: judgement.breaches.clone(),
            gate: judgement.gate.clone(),
            reasons: outcome.reasons(),
            steps: outcome.steps,
            simulated_s: outcome.simulated_s,
            wall_s: outcome.wall_s,
            metrics: metrics().map(|(name, measured)| (name, measured.value())).collect(),
            metrics_without_value: metrics()
                .filter_map(|(name, measured)| Some((name, measured.reason()?)))
                .collect(),
            expectations: judgement.expectations.clone(),
            link: outcome.link,
            timing: outcome.timing.clone(),
            faults: outcome.faults.clone(),
            torque_sha256: outcome.torque_sha256.clone(),
            versions: Versions::of(&device.session.identity),
        }
    }

    /// A metric; `None` without a value.
    #[must_use]
    pub fn metric(&self, name: &str) -> Option<f64> {
        *self.metrics.get(name)?
    }

    /// Writes the summary to a temporary file in the same directory, then renames it, so that the name stands for a complete
    /// summary.
    ///
    /// # Errors
    /// The directory doesn't exist or can't be written to.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_json(path, ".summary-", self)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::fs;
    use std::os::unix::fs::PermissionsExt;
    use std::path::Path;

    use super::{RunEnd, Summary, Telemetry, Versions};
    use lashloop_bench::device::{Evidence, FileHash};
    use lashloop_bench::scenario::RunMode;
    use lashloop_bench::scenario::expectation::Expectation;
    use lashloop_bench::scenario::sections::Allowance;
    use lashloop_bench::timing::{ClockName, Timings};
    use lashloop_bench::verdict::{Judgement, LinkCounts, Verdict};
    use lashloop_plant::Signal;
    use lashloop_plant::metrics::{Measurement, Metric, Sample, SignalTable};

    /// As this version has written it.
    const PINNED: &str = include_str!("summary/pinned.json");

    pub(crate) fn summary() -> Summary {
        let signals = |names: [&'static str; 2], units: [&'static str; 2]| {
            names.into_iter().zip(units).map(|(name, unit)| Signal::new(name, unit)).collect()
        };
        let table = SignalTable {
            plant: signals(["dead_zone_rad", "disturbing_torque_nm"], ["rad", "N m"]),
            drive: signals(["dead_zone_estimate_rad", "disturbing_torque_estimate_nm"], ["rad", "N m"]),
        };
        let mut measurement = Measurement::new(0.5, &table);
        for step in 0..4 {
            measurement.push(&Sample {
                time_s: f64::from(step) * 0.5,
                reference_rad: 0.0,
                load_position_rad: 1.0 - 0.25 * f64::from(step),
                motor_position_rad: 0.0,
                torque_nm: -1.5,
                plant: &[0.125, 0.0],
                drive: Some(&[0.16, 0.0]),
            });
        }
        let metrics = measurement.metrics();
        let settle = Expectation::of_metric(Metric::SettleTime, None, Some(2.0));
        let link = LinkCounts { frames_sent: 4, frames_received: 4, ..LinkCounts::default() };
        let timing = Timings::new(ClockName::Lockstep, 1_000, 0).report(Vec::new());
        let named = || metrics.iter().map(|(metric, measured)| (metric.name().to_owned(), measured));
        let judgement = Judgement::new(&[settle], &metrics, &Allowance::default(), &link, &timing);
        Summary {
            verdict: judgement.verdict,
            scenario: "scenarios/smooth-before.toml".to_owned(),
            device: "native twin".to_owned(),
            evidence: Evidence {
                files: vec![FileHash { path: "lashloop".to_owned(), sha256: Some("11".repeat(32)) }],
                bench_build: "build 1234abcd".to_owned(),
                warnings: Vec::new(),
            },
            mode: RunMode::Hil,
            controller: "pd".to_owned(),
            telemetry: Telemetry { every_steps: 10, signals: vec!["dead_zone_estimate_rad".to_owned()] },
            seed: 1,
            end: RunEnd::Complete,
            broken_rule: None,
            breaches: Vec::new(),
            gate: None,
            reasons: vec!["settle_time_s: never".to_owned()],
            steps: 4,
            simulated_s: 2.0,
            wall_s: 0.25,
            metrics: named().map(|(name, it)| (name, it.value())).collect(),
            metrics_without_value: named().filter_map(|(name, it)| Some((name, it.reason()?))).collect(),
            expectations: judgement.expectations,
            link,
            timing,
            faults: Vec::new(),
            torque_sha256: "00".repeat(32),
            versions: Versions {
                lashloop: "0.1.0".to_owned(),
                protocol: "1".to_owned(),
                firmware: "0.1.0".to_owned(),
                firmware_build: Some("0123abcd".to_owned()),
                firmware_dirty: true,
            },
        }
    }

    #[test]
    fn a_summary_has_every_metric_and_null_without_a_value() {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let path = directory.path().join("summary.json");
        summary().write(&path).expect("a summary");
        assert_eq!(fs::read_to_string(&path).expect("a summary"), PINNED);
    }

    #[test]
    fn a_summary_reads_back_as_it_was_written() {
        let ended = RunEnd::Early("the drive latched LoadSpeed".to_owned());
        for written in [summary(), Summary { end: ended, mode: RunMode::Bench, ..summary() }] {
            let text = serde_json::to_string(&written).expect("JSON");
            let read: Summary = serde_json::from_str(&text).expect("a summary");
            assert_eq!(serde_json::to_string(&read).expect("JSON"), text);
            assert_eq!((&read.end, read.mode, read.verdict), (&written.end, written.mode, Verdict::Fail));
        }
    }

    #[test]
    fn a_summary_of_a_later_version_reads_with_its_further_metrics() {
        let mut later = serde_json::to_value(summary()).expect("JSON");
        later["metrics"]["settle_time_3pct_s"] = 0.5.into();
        later["weather"] = "fair".into();
        let read: Summary = serde_json::from_value(later).expect("a summary");
        assert_eq!(read.metric("settle_time_3pct_s"), Some(0.5));
    }

    #[test]
    fn a_summary_replaces_an_older_one_and_leaves_no_other_file() {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let path = directory.path().join("summary.json");
        fs::write(&path, "{").expect("an old summary");
        summary().write(&path).expect("a summary");
        let text = fs::read_to_string(&path).expect("a summary");
        serde_json::from_str::<serde_json::Value>(&text).expect("whole JSON");
        assert_eq!(fs::read_dir(directory.path()).expect("the directory").count(), 1);
    }

    #[test]
    fn a_summary_has_the_permissions_of_any_file() {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let [path, plain] = ["summary.json", "plain"].map(|name| directory.path().join(name));
        summary().write(&path).expect("a summary");
        fs::write(&plain, "").expect("a file");
        let mode = |path| fs::metadata(path).expect("a file").permissions().mode();
        assert_eq!(mode(path), mode(plain));
    }

    #[test]
    fn a_summary_that_cannot_take_its_name_leaves_no_file() {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let path = directory.path().join("summary.json");
        fs::create_dir(&path).expect("a directory in the way");
        let error = summary().write(&path).expect_err("a directory in the way").to_string();
        let start = format!("{}: can't be written: ", path.display());
        assert!(error.starts_with(&start), "{error}");
        assert_eq!(fs::read_dir(directory.path()).expect("the directory").count(), 1);
    }

    #[test]
    fn an_absent_directory_is_reported_with_the_path() {
        let error = summary().write(Path::new("no/such/summary.json")).expect_err("no directory");
        assert!(error.to_string().starts_with("no/such/summary.json: can't be created: "), "{error}");
    }
}
