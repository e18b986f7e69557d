//! Runs in bench mode: the drive counts the edges of its encoders and drives its bridge, with the plant behind the pins.

use tests::paper::PATIENCE;
use tests::program::{self, Ended};
use tests::records::Records;

/// The paper's experiment in bench mode: name of the scenario.
pub(crate) const SMOOTH_BEFORE: &str = "bench-smooth-before";
pub(crate) const SMOOTH_AFTER: &str = "bench-smooth-after";
pub(crate) const FRICTION_AFTER: &str = "bench-friction-after";

/// Runs a scenario on virtual silicon, with its record.
pub(crate) fn on_silicon(scenario: &str, more: &[&str]) -> (Ended, Records) {
    let records = Records::new();
    let (path, out) = (format!("scenarios/{scenario}.toml"), records.out());
    let arguments = ["run", &path, "--device", "silicon", "--out", &out];
    let ended = program::run([&arguments[..], &PATIENCE[..], more].concat());
    (ended, records)
}

/// Device time stands still until the host sends, so nothing but the scenario decides on a torque.
pub(crate) fn repeats() {
    let digest = || {
        let (ended, records) =
            on_silicon(SMOOTH_AFTER, &["--set", "run.duration_s=0.5", "--set", "expect=[]"]);
        let _ = ended.with_code(0);
        let summary = records.summary();
        assert_eq!((&summary["mode"], &summary["steps"]), (&"bench".into(), &500.into()));
        summary["torque_sha256"].as_str().expect("a digest").to_owned()
    };
    assert_eq!(digest(), digest());
}

pub(crate) fn fails() {
    let (ended, records) = on_silicon(SMOOTH_AFTER, &["--set", "run.duration_s=0.2"]);
    let ended = ended.with_code(1);
    assert!(ended.stdout.contains("MISSED settle_time_s: never"), "{}", ended.stdout);
    assert_eq!(records.summary()["verdict"], "FAIL");
}

/// More than half a second without a frame in either direction. The drive removes the torque; the tests of virtual silicon
/// see the bridge go off.
pub(crate) fn unplugged_for_a_while() {
    // At rest and at 200 Hz the chip is emulated faster than it runs, on a busy machine too.
    let settings = [
        "run.duration_s=2",
        "run.control_period_us=5000",
        // An encoder may turn by half the range of its 16-bit counter in a period.
        "encoders.motor_counts_per_rev=8192",
        "controller.parameters.watchdog_us=200000",
        "reference.position_rad=1.5707963267948966",
        "expect=[]",
        "fault=[{kind=\"link-stall\",at_s=0.3,for_s=0.7}]",
    ];
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let more: Vec<_> = ["--clock", "real-time"].into_iter().chain(settings).collect();
    let (ended, records) = on_silicon(SMOOTH_AFTER, &more);
    let ended = ended.with_code(3);
    assert!(ended.stdout.contains("ENDED  the drive latched Watchdog"), "{}", ended.stdout);
    let steps = records.summary()["steps"].as_u64().expect("steps");
    assert!(steps < 200, "no step is recorded once the host is silent, but there are {steps}");
}

pub(crate) fn unplugged_for_good() {
    let fault = "fault=[{kind=\"link-cut\",at_s=0.3,for_s=30}]";
    let (ended, records) = on_silicon(SMOOTH_AFTER, &["--set", "run.duration_s=2", "--set", fault]);
    let ended = ended.with_code(4);
    assert!(ended.stderr.contains("closed the line"), "{}", ended.stderr);
    assert!(records.summary_text().is_none(), "a run without a verdict has no summary");
}
