//! Runs with the Python drive. Its law computes in single precision in the order of the firmware, so the torque digest must
//! be the pinned one, without a tolerance.

use serde_json::Value;
use tests::paper::{PaperRun, RUNS};
use tests::program;
use tests::python;

/// Far above the usual time, so that only a regression exceeds it.
const CAP_S: f64 = 25.0;

pub(crate) fn smooth() {
    let drive = python::drive();
    let wall_s = passed(named("smooth-before"), &drive.device());
    assert!(wall_s <= CAP_S, "25 s of the plant took {wall_s} s, at most {CAP_S} s");
}

pub(crate) fn friction() {
    let drive = python::drive();
    let _ = passed(named("friction-before"), &drive.device());
}

pub(crate) fn started_by_the_bench() {
    let device = python::on_standard_streams("-m lashloop drive --stdio");
    let _ = passed(named("friction-before"), &device);
}

pub(crate) fn again() {
    let drive = python::drive();
    let device = drive.device();
    for arguments in [["--set", "run.duration_s=5"], ["--set", "run.control_period_us=500"]] {
        // The load can't settle in five seconds; half a period is another loop. No state of either may carry over.
        let _ = program::run(
            ["run", "scenarios/smooth-before.toml", "--device", &device].into_iter().chain(arguments),
        );
    }
    let _ = passed(named("smooth-before"), &device);
}

pub(crate) fn not_offered() {
    let drive = python::drive();
    let device = drive.device();
    let ended = program::run(["run", "scenarios/smooth-after.toml", "--device", &device]).with_code(2);
    let want = "lashloop: scenarios/smooth-after.toml:25: controller.name: \"merzouki\" is refused: the drive has no law of this \
                name; it has pd\n";
    assert_eq!((ended.stderr.as_str(), ended.stdout.as_str()), (want, ""));
}

fn named(name: &str) -> PaperRun {
    RUNS.into_iter().find(|run| run.name == name).expect("a run of the paper")
}

/// Runs the scenario, checks verdict, pinned torques and link counts, and returns the wall-clock time.
fn passed(run: PaperRun, device: &str) -> f64 {
    let summary = run.pass_on(device);
    for key in ["crc_errors", "lost", "late", "damaged_at_drive", "overruns_at_drive"] {
        assert_eq!(summary["link"][key], 0, "{}: {key}", run.name);
    }
    summary.get("wall_s").and_then(Value::as_f64).expect("the wall-clock time")
}
