//! It closes the loop. Its law computes in single precision in the firmware's order, so there is no tolerance: the
//! torques have to be those that are pinned for every device.

use serde_json::Value;
use tests::paper::{PaperRun, RUNS};
use tests::program;
use tests::python;

/// Far above what is usual: only a drive that has lost its speed is slower than the plant's own time.
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

pub(crate) fn again() {
    let drive = python::drive();
    let device = drive.device();
    for arguments in [["--set", "run.duration_s=0.5"], ["--set", "run.control_period_us=500"]] {
        // Half a second can't settle; half a period is another loop, and what it leaves must not reach the next run.
        let _ = program::run(
            ["run", "scenarios/smooth-before.toml", "--device", &device].into_iter().chain(arguments),
        );
    }
    let _ = passed(named("smooth-before"), &device);
}

pub(crate) fn not_offered() {
    let drive = python::drive();
    let device = drive.device();
    let ended = program::run(["run", "scenarios/smooth-after.toml", "--device", &device]).with_code(4);
    let want = format!(
        "lashloop: drive on {device}: it does not offer the control law merzouki, which the scenario needs; it offers pd; \
         the firmware does not fit this bench\n"
    );
    assert_eq!((ended.stderr.as_str(), ended.stdout.as_str()), (want.as_str(), ""));
}

fn named(name: &str) -> PaperRun {
    RUNS.into_iter().find(|run| run.name == name).expect("a run of the paper")
}

/// Runs it to its PASS with the pinned torques and nothing lost; gives the time on the wall.
fn passed(run: PaperRun, device: &str) -> f64 {
    let summary = run.pass_on(device);
    for key in ["crc_errors", "lost", "late", "damaged_at_drive", "overruns_at_drive"] {
        assert_eq!(summary["link"][key], 0, "{}: {key}", run.name);
    }
    summary.get("wall_s").and_then(Value::as_f64).expect("the time on the wall")
}
