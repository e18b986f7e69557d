//! Runs in bench mode: the drive counts the edges of its encoders and drives its bridge, with the plant behind the pins.

use std::fs;
use std::time::Duration;

use lashloop_conformance::CheckResult;
use tests::battery::BenchMode;
use tests::paper::PATIENCE;
use tests::program::{self, Ended};
use tests::records::Records;

/// A scenario of the paper's experiment in bench mode.
const SMOOTH_AFTER: &str = "bench-smooth-after";

/// Runs a scenario on virtual silicon, with its record.
fn on_silicon(scenario: &str, more: &[&str]) -> (Ended, Records) {
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

/// The chip is emulated slower than it runs, so that its own clock times the steps. All laws in process are enough.
pub(crate) fn conforms() {
    let omitted = &["every law gives the torques and telemetry of HIL mode"];
    let mut checks = BenchMode { time_limit: Duration::from_secs(500), omitted, ..BenchMode::default() };
    checks.run("silicon", |drive| drive);
    assert_eq!(checks.not_passed(), Vec::<&CheckResult>::new());
    assert!(checks.results.len() >= 20, "{}", checks.results.len());
}

/// At 4 kHz the line has no capacity for a report of every step.
pub(crate) fn reports_every_fourth_step() {
    let settings = ["run.control_period_us=250", "run.duration_s=0.5", "bench.sample_every=4", "expect=[]"];
    let settings: Vec<_> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    let (ended, records) = on_silicon(SMOOTH_AFTER, &settings);
    let _ = ended.with_code(0);
    let summary = records.summary();
    let link = &summary["link"];
    assert_eq!((&summary["steps"], &link["lost"], &link["late"]), (&2_000.into(), &0.into(), &0.into()));
    let trace = records.trace();
    let [torque_nm, time_s] = ["torque_nm", "time_s"].map(|name| trace.column(name));
    assert!((time_s[1_999] - 1_999.0 * 250e-6).abs() < 1e-9, "{}", time_s[1_999]);
    for (number, report) in torque_nm.chunks(4).enumerate() {
        assert!(report.iter().all(|torque| *torque == report[0]), "report {number}: {report:?}");
    }
    let changes = torque_nm.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(changes > 400, "{changes} of 500 reports differ from the one before");
}

/// The boards with a pin map besides the bare one, whose image has no name of a board.
fn boards_besides_the_bare_one() -> Vec<String> {
    let files = fs::read_dir(tests::workspace().join("virtual-silicon/boards")).expect("the pin maps");
    let boards = files.map(|file| file.expect("a pin map").path().with_extension(""));
    let boards = boards.map(|board| board.file_name().expect("a name").to_string_lossy().into_owned());
    let mut boards: Vec<_> = boards.filter(|board| board != "stm32f405").collect();
    boards.sort();
    assert!(boards.len() >= 4, "{boards:?}");
    boards
}

/// A run of 0.3 s on the image of a board, or elsewhere.
fn short_run(scenario: &str, device: &str) -> Records {
    let records = Records::new();
    let (path, out) = (format!("scenarios/{scenario}.toml"), records.out());
    let settings = ["--set", "run.duration_s=0.3", "--set", "expect=[]"];
    let arguments = [&["run", &path, "--device", device, "--out", &out], &settings[..], &PATIENCE].concat();
    let _ = program::run(arguments).with_code(0);
    records
}

fn silicon_of(board: &str) -> String {
    format!("silicon:{}", tests::workspace().join(format!("target/lashloop-firmware-{board}.elf")).display())
}

/// The image names its board, and virtual silicon has the pins there.
pub(crate) fn other_boards() {
    for board in boards_besides_the_bare_one() {
        let records = short_run(SMOOTH_AFTER, &silicon_of(&board));
        let summary = records.summary();
        let device = summary["device"].as_str().expect("the device");
        assert!(device.contains(&format!("({board}, firmware ")), "{device}");
        // The load moves by counts of the encoder that the board has at other pins.
        let load_rad = records.trace().column("load_position_rad");
        assert!((load_rad[299] - load_rad[0]).abs() > 1e-3, "{} rad", load_rad[299] - load_rad[0]);
    }
}

/// A simulated plant gives the same torques to every chip.
pub(crate) fn hil_of_other_boards() {
    let digest = |device: &str| {
        short_run("smooth-after", device).summary()["torque_sha256"].as_str().expect("a digest").to_owned()
    };
    let want = digest("inproc");
    for board in boards_besides_the_bare_one() {
        assert_eq!(digest(&silicon_of(&board)), want, "{board}");
    }
}

pub(crate) fn fails() {
    let (ended, records) = on_silicon(SMOOTH_AFTER, &["--set", "run.duration_s=0.2"]);
    let ended = ended.with_code(1);
    assert!(ended.stdout.contains("MISSED settle_time_s: never"), "{}", ended.stdout);
    assert_eq!(records.summary()["verdict"], "FAIL");
}

/// More than a second without a frame in either direction. The drive removes the torque; the tests of virtual silicon
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
        "fault=[{kind=\"link-stall\",at_s=0.3,for_s=1.2}]",
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
