//! `summary.json`: the verdict and all that is needed to check, compare and repeat it.

use std::io::Write;
use std::path::Path;

use lashloop_protocol::PROTOCOL_VERSION;
use lashloop_protocol::message::Identity;
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::atomic_file::write_whole;
use lashloop_bench::device::{Device, Evidence};
use lashloop_bench::fault::log::FaultRecord;
use lashloop_bench::run::Outcome;
use lashloop_bench::scenario::{RunMode, Scenario};
use lashloop_bench::timing::TimingReport;
use lashloop_bench::verdict::{Breach, BrokenRule, JudgedExpectation, LinkCounts, Verdict};
use lashloop_plant::metrics::{Measured, Metric, Metrics};
use lashloop_session::Subscription;

/// Summary of a run: one JSON object with its keys in this order.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    #[serde(skip_serializing_if = "RunMode::is_hil")]
    pub mode: RunMode,
    /// The control law.
    pub controller: String,
    /// The telemetry subscribed.
    pub telemetry: Telemetry,
    /// Seed of every random stream of the run.
    pub seed: u64,
    /// How the run ended: `complete`, or what interrupted it.
    pub end: String,
    /// The rule that ended the run, if the drive broke one; left out otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub broken_rule: Option<BrokenRule>,
    /// Why the verdict is INVALID; left out otherwise.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub breaches: Vec<Breach>,
    /// Where the recorded motion leaves the plant model; left out otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gate: Option<String>,
    /// Why the verdict is not PASS, each reason as one phrase; left out for PASS.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<String>,
    /// Number of control steps.
    pub steps: u64,
    /// Simulated time.
    pub simulated_s: f64,
    /// Wall-clock time.
    pub wall_s: f64,
    /// The metrics by name, null where there is no value; then `metrics_without_value`, the reason of each null by name.
    #[serde(flatten, serialize_with = "with_reasons")]
    pub metrics: Metrics,
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

fn with_reasons<S: Serializer>(metrics: &Metrics, serializer: S) -> Result<S::Ok, S::Error> {
    let mut keys = serializer.serialize_map(None)?;
    keys.serialize_entry("metrics", metrics)?;
    keys.serialize_entry("metrics_without_value", &Reasons(metrics))?;
    keys.end()
}

/// Why metrics have no value, by name.
struct Reasons<'a>(&'a Metrics);

impl Serialize for Reasons<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let reason = |(metric, measured): (Metric, Measured)| Some((metric.name(), measured.reason()?));
        serializer.collect_map(self.0.iter().filter_map(reason))
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
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
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
            protocol: PROTOCOL_VERSION.to_string(),
            firmware: identity.firmware.to_string(),
            firmware_build: (build != 0).then(|| format!("{build:08x}")),
            firmware_dirty: identity.dirty != 0,
        }
    }
}

impl Summary {
    /// The summary of a run of this scenario on this drive.
    #[must_use]
    pub fn new(scenario: &Scenario, device: &Device, outcome: &Outcome) -> Self {
        let outcome = outcome.clone();
        Self {
            reasons: outcome.reasons(),
            verdict: outcome.judgement.verdict,
            scenario: scenario.name.clone(),
            device: device.description(),
            evidence: device.evidence(),
            mode: scenario.run.mode,
            controller: scenario.controller.name.clone(),
            telemetry: Telemetry::from(device.session.subscription()),
            seed: scenario.run.seed,
            end: outcome.end.to_string(),
            broken_rule: outcome.end.broken_rule(),
            breaches: outcome.judgement.breaches,
            gate: outcome.judgement.gate,
            steps: outcome.steps,
            simulated_s: outcome.simulated_s,
            wall_s: outcome.wall_s,
            metrics: outcome.metrics,
            expectations: outcome.judgement.expectations,
            link: outcome.link,
            timing: outcome.timing,
            faults: outcome.faults,
            torque_sha256: outcome.torque_sha256,
            versions: Versions::of(&device.session.identity),
        }
    }

    /// Writes the summary to a temporary file in the same directory, then renames it, so that the name stands for a complete
    /// summary.
    ///
    /// # Errors
    /// The directory doesn't exist or can't be written to.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_whole(path, ".summary-", |file| {
            serde_json::to_writer_pretty(&mut *file, self)?;
            file.write_all(b"\n")
        })
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::fs::PermissionsExt;
    use std::path::Path;

    use super::{Summary, Telemetry, Versions};
    use lashloop_bench::device::{Evidence, FileHash};
    use lashloop_bench::scenario::RunMode;
    use lashloop_bench::scenario::expectation::Expectation;
    use lashloop_bench::scenario::sections::Allowance;
    use lashloop_bench::timing::{ClockName, Timings};
    use lashloop_bench::verdict::{Judgement, LinkCounts};
    use lashloop_plant::Signal;
    use lashloop_plant::metrics::{Measurement, Metric, Sample, SignalTable};

    fn summary() -> Summary {
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
            end: "complete".to_owned(),
            broken_rule: None,
            breaches: Vec::new(),
            gate: None,
            reasons: vec!["settle_time_s: never".to_owned()],
            steps: 4,
            simulated_s: 2.0,
            wall_s: 0.25,
            metrics,
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
        insta::assert_snapshot!(fs::read_to_string(&path).expect("a summary"), @r#"
        {
          "verdict": "FAIL",
          "scenario": "scenarios/smooth-before.toml",
          "device": "native twin",
          "evidence": {
            "files": [
              {
                "path": "lashloop",
                "sha256": "1111111111111111111111111111111111111111111111111111111111111111"
              }
            ],
            "bench_build": "build 1234abcd",
            "warnings": []
          },
          "controller": "pd",
          "telemetry": {
            "every_steps": 10,
            "signals": [
              "dead_zone_estimate_rad"
            ]
          },
          "seed": 1,
          "end": "complete",
          "reasons": [
            "settle_time_s: never"
          ],
          "steps": 4,
          "simulated_s": 2.0,
          "wall_s": 0.25,
          "metrics": {
            "settle_time_s": null,
            "settle_time_5pct_s": null,
            "settle_time_2pct_s": null,
            "settle_time_1pct_s": null,
            "settle_after_move_s": null,
            "rise_time_s": null,
            "static_error_rad": 0.375,
            "hunting_rad": null,
            "overshoot_rad": 0.0,
            "rms_tracking_error_rad": 0.6846531968814576,
            "peak_tracking_error_rad": 1.0,
            "steady_velocity_error_rad": null,
            "lost_motion_rad": null,
            "effort_nm2s": 4.5,
            "torque_total_variation_nm": 0.0,
            "rms_torque_nm": 1.5,
            "peak_torque_nm": 1.5,
            "dead_zone_estimate_rad": 0.16,
            "dead_zone_error_rad": 0.035,
            "dead_zone_deviation_rad": null,
            "dead_zone_settle_time_s": null,
            "dead_zone_bias_rad": null,
            "dead_zone_largest_error_rad": null,
            "disturbing_torque_rms_error_nm": 0.0,
            "disturbing_torque_bias_nm": 0.0
          },
          "metrics_without_value": {
            "settle_time_s": "never",
            "settle_time_5pct_s": "never",
            "settle_time_2pct_s": "never",
            "settle_time_1pct_s": "never",
            "settle_after_move_s": "no move",
            "rise_time_s": "no end of motion",
            "hunting_rad": "run too short",
            "steady_velocity_error_rad": "no steady velocity",
            "lost_motion_rad": "no reversal",
            "dead_zone_deviation_rad": "no signal drive.dead_zone_deviation_rad",
            "dead_zone_settle_time_s": "never",
            "dead_zone_bias_rad": "run too short",
            "dead_zone_largest_error_rad": "never"
          },
          "expectations": [
            {
              "metric": "settle_time_s",
              "value": null,
              "reason": "never",
              "unit": "s",
              "min": null,
              "max": 2.0,
              "ok": false
            }
          ],
          "link": {
            "frames_sent": 4,
            "frames_received": 4,
            "crc_errors": 0,
            "lost": 0,
            "late": 0,
            "resumes": 0,
            "damaged_at_drive": 0,
            "overruns_at_drive": 0
          },
          "timing": {
            "clock": "lockstep",
            "period_us": 1000,
            "warm_up_steps": 0,
            "steps": 0,
            "unanswered": 0,
            "missed": 0,
            "longest_run_of_late": 0,
            "lateness_us": null,
            "round_trip_us": null,
            "send_us": null,
            "line_and_device_us": null,
            "compute_us": null,
            "receive_us": null,
            "lateness_histogram": [],
            "round_trip_histogram": [],
            "refused": []
          },
          "faults": [],
          "torque_sha256": "0000000000000000000000000000000000000000000000000000000000000000",
          "versions": {
            "lashloop": "0.1.0",
            "protocol": "1",
            "firmware": "0.1.0",
            "firmware_build": "0123abcd",
            "firmware_dirty": true
          }
        }
        "#);
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
        let start = format!("{}: cannot be written: ", path.display());
        assert!(error.starts_with(&start), "{error}");
        assert_eq!(fs::read_dir(directory.path()).expect("the directory").count(), 1);
    }

    #[test]
    fn an_absent_directory_is_reported_with_the_path() {
        let error = summary().write(Path::new("no/such/summary.json")).expect_err("no directory");
        assert!(error.to_string().starts_with("no/such/summary.json: cannot be created: "), "{error}");
    }
}
