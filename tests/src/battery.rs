//! Conformance: the output of the command on drives that pass, and the checks of bench mode alone.

use std::collections::BTreeSet;
use std::time::Duration;

use lashloop_bench::device::{Connection, DeviceChoice};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_conformance::{CheckResult, CheckStatus, PowerStage, Reporter, TIME_LIMIT};
use lashloop_link::Link;

/// Of a drive without `STORE`, and without `CAPTURE`.
pub const NOTHING_STORED: &str = "the drive stores no parameters";
pub const NOTHING_CAPTURED: &str = "the drive captures no signals";

/// What the Lashloop drive's description excludes.
pub const LASHLOOP_SKIPS: &[&str] =
    &["no law has 13 signals", "the drive has no 14 signals", "the drive has no bench mode", NOTHING_STORED];

/// What the Lashloop drive excludes with a plant at its pins.
pub const LASHLOOP_BENCH_SKIPS: &[&str] =
    &["no law has 13 signals", "the drive has no 14 signals", NOTHING_STORED, TOO_LITTLE_MOTION];

/// Why a check of a load's speed is skipped with the plant of the paper.
pub const TOO_LITTLE_MOTION: &str = "the mechanics at the pins move too little";

/// What the description of a drive excludes whose single law is `pd`.
pub const PD_ALONE_SKIPS: &[&str] = &[
    "every law has every parameter",
    "every law has every signal",
    "no law has 13 signals",
    "the drive has no 14 signals",
    "the drive has no bench mode",
    NOTHING_STORED,
    NOTHING_CAPTURED,
];

/// What the description of a drive with a single law excludes, which is not `pd`.
pub const ONE_LAW_SKIPS: &[&str] = &[
    "every law has every parameter",
    "every law has every signal",
    "no law has 13 signals",
    "the drive has no 14 signals",
    "the drive has no law pd, so it does not offer the profile",
    "the drive has no bench mode",
    NOTHING_STORED,
    NOTHING_CAPTURED,
];

/// Of checks that need so many messages that a slow line or a busy machine takes too long.
const TOO_SLOW: &str = "not judged: this line is too slow";

/// The number of checks, of which all passed but those skipped for `reasons`, each of which occurs.
///
/// # Panics
/// A check failed or was not judged, or others are skipped.
pub fn all_passed(stdout: &str, reasons: &[&str]) -> usize {
    let lines = |start: &str| stdout.lines().filter(|line| line.starts_with(start)).count();
    let (passed, skipped) = (lines("PASS "), lines("SKIPPED "));
    let last = format!("{passed} passed, 0 failed, 0 not judged, {skipped} skipped");
    assert_eq!(stdout.lines().last(), Some(&*last), "{stdout}");
    let skips = stdout.lines().filter(|line| line.starts_with("SKIPPED "));
    let got = skips.filter_map(|line| line.rsplit_once("; ")).map(|(_, reason)| reason);
    let got: BTreeSet<_> = got.filter(|reason| *reason != TOO_SLOW).collect();
    assert_eq!(got, reasons.iter().copied().collect(), "{stdout}");
    passed + skipped
}

/// Baud rate of the line.
const BAUD: u32 = 921_600;

/// The checks of bench mode alone.
pub struct BenchMode {
    /// Their results.
    pub results: Vec<CheckResult>,
    /// As of [`Reporter::time_limit`].
    pub time_limit: Duration,
    /// Names of checks that aren't made.
    pub omitted: &'static [&'static str],
}

impl Default for BenchMode {
    fn default() -> Self {
        Self { results: Vec::new(), time_limit: TIME_LIMIT, omitted: &[] }
    }
}

impl BenchMode {
    /// The results other than passed, but for the check that the plant excludes.
    #[must_use]
    pub fn not_passed(&self) -> Vec<&CheckResult> {
        let excluded = CheckStatus::Skipped { reason: TOO_LITTLE_MOTION };
        let others =
            self.results.iter().filter(|it| it.status != CheckStatus::Passed && it.status != excluded);
        others.collect()
    }

    /// Makes the checks on a drive with a plant of the paper at its pins, reached by a link that is made of its own.
    ///
    /// # Panics
    /// The drive does not start, or does not answer.
    pub fn run(&mut self, device: &str, link: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>) {
        let path = crate::workspace().join("scenarios/bench-smooth-after.toml");
        let scenario = Scenario::from_file(&path, &[]).expect("a scenario");
        let device: DeviceChoice = device.parse().expect("a device");
        let with_plant = device.for_run(&scenario, ClockName::RealTime).expect("a plant");
        let supervisor = Supervisor::without_signals(None).expect("a supervisor");
        let (drive, _connection) = Connection::open(&with_plant, BAUD, &supervisor).expect("a drive");
        lashloop_conformance::run(link(drive), 7, self).expect("a drive that answers");
    }
}

impl Reporter for BenchMode {
    fn checked(&mut self, result: &CheckResult) {
        self.results.push(result.clone());
    }

    fn wants(&self, group: &str, name: &str) -> bool {
        group == "bench_mode" && !self.omitted.contains(&name)
    }

    fn bench_mode(&self) -> Option<PowerStage> {
        Some(PowerStage { torque_per_duty_nm: Some(62.5) })
    }

    fn time_limit(&self) -> Duration {
        self.time_limit
    }
}
