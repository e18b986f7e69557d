//! The paper's four runs, and the torque streams they are pinned to.

use serde_json::Value;

use crate::program;
use crate::records::Records;

/// Settings under which only a lost frame or a hung drive costs an answer. A busy machine may stop a process for longer
/// than the default timeout of a second; results in lockstep do not depend on time.
pub const PATIENCE: [&str; 4] =
    ["--set", "link.answer_timeout_ms=20000", "--set", "link.silence_limit_ms=40000"];

/// One of the paper's runs.
#[derive(Debug, Clone, Copy)]
pub struct PaperRun {
    /// Name of its scenario.
    pub name: &'static str,
    /// The metric that the paper reports.
    pub metric: &'static str,
    /// Expected value of the metric.
    pub want: f64,
    /// Tolerance of the metric.
    pub tolerance: f64,
    /// SHA-256 of every torque of the run. Lockstep is repeatable bit for bit, so the digest is the same on every device.
    /// It changes only with an intended change of law, plant or arithmetic.
    pub torque_sha256: &'static str,
}

/// Before and after compensation, on the smooth plant and on the one with friction.
pub const RUNS: [PaperRun; 4] = [
    PaperRun {
        name: "smooth-before",
        metric: "settle_time_s",
        want: 12.9,
        tolerance: 0.15,
        torque_sha256: "7371a836110f239cec0dc5fd117586a6169c690b4c48de6fb77aa427e9086c86",
    },
    PaperRun {
        name: "smooth-after",
        metric: "settle_time_s",
        want: 5.14,
        tolerance: 0.1,
        torque_sha256: "cf2cc37c6f429c01271328c5448cb2991944dcdf4ccfed17aefec878f094602d",
    },
    PaperRun {
        name: "friction-before",
        metric: "static_error_rad",
        want: 0.320,
        tolerance: 0.002,
        torque_sha256: "3a59e64c762ffd19b3f8ec9254c83ff8f9042665d36727fea7255ed415187ec1",
    },
    PaperRun {
        name: "friction-after",
        metric: "static_error_rad",
        want: 0.0,
        tolerance: 0.015,
        torque_sha256: "13a95cbf2f0219a969fb29cba3da21798f2efbb84c9b42b99922119d4bd1025a",
    },
];

/// Not from the paper: the plant `backlash-shaft` under laws beyond it, pinned in the same way.
pub const BACKLASH_INVERSE: PaperRun = PaperRun {
    name: "shaft-backlash-inverse",
    metric: "settle_time_s",
    want: 2.51,
    tolerance: 0.05,
    torque_sha256: "0f23599b392b0b26f4624ef78bea683c3d86f66ef5f00aae4c95c3c7e26544e7",
};

/// The same plant under the braking curve.
pub const BRAKING_CURVE: PaperRun = PaperRun {
    name: "shaft-braking-curve",
    metric: "settle_time_s",
    want: 1.18,
    tolerance: 0.05,
    torque_sha256: "3144c831d0cc9ad9dccfba8fbe5fd200bc2ed5fa9baacbdb88c5e97e8e576f42",
};

impl PaperRun {
    /// The scenario's file.
    #[must_use]
    pub fn scenario(&self) -> String {
        format!("scenarios/{}.toml", self.name)
    }

    /// Runs the scenario on a device, checks verdict, metric and torque digest, and returns the summary.
    ///
    /// # Panics
    /// A check fails.
    #[must_use]
    pub fn pass_on(&self, device: &str) -> Value {
        let Self { name, metric, want, tolerance, torque_sha256 } = *self;
        let records = Records::new();
        let arguments = ["run", &self.scenario(), "--device", device, "--out", &records.out()];
        let _ = program::run(arguments.into_iter().chain(PATIENCE)).with_code(0);
        let summary = records.summary();
        assert_eq!(summary["verdict"], "PASS", "{name} on {device}");
        let have = summary["metrics"][metric].as_f64().unwrap_or(f64::NAN);
        assert!(
            (have - want).abs() <= tolerance,
            "{name} on {device}: {metric} {have}, want {want} +- {tolerance}"
        );
        assert_eq!(summary["torque_sha256"], torque_sha256, "{name} on {device}: torque digest");
        assert_eq!(records.trace().len(), 25_000, "{name} on {device}: rows of the trace");
        summary
    }

    /// Runs the first seconds of the scenario on a device, and checks that torques and metrics are those of the run in process,
    /// and that the link is clean.
    ///
    /// # Panics
    /// A check fails.
    pub fn check_start_on(&self, device: &str, duration_s: u32) {
        let duration = format!("run.duration_s={duration_s}");
        let [on_device, in_process] = [device, "inproc"].map(|device| {
            let records = Records::new();
            let arguments = ["run", &self.scenario(), "--device", device, "--out", &records.out()];
            // Too short for the numbers of the whole run.
            let settings = ["--set", &duration, "--set", "expect=[]"];
            let _ = program::run(arguments.into_iter().chain(settings).chain(PATIENCE)).with_code(0);
            records.summary()
        });
        for key in ["torque_sha256", "metrics", "steps", "expectations"] {
            assert_eq!(on_device[key], in_process[key], "{}: {key}", self.name);
        }
        assert_eq!(on_device["steps"], 1_000 * duration_s, "{}", self.name);
        check_link(&on_device, self.name);
    }
}

/// Checks that no frame was damaged, lost or late.
///
/// # Panics
/// One was.
pub fn check_link(summary: &Value, name: &str) {
    for key in ["crc_errors", "lost", "late", "damaged_at_drive", "overruns_at_drive"] {
        assert_eq!(summary["link"][key], 0, "{name}: {key}");
    }
}
