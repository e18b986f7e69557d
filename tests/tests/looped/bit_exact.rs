//! Lockstep results are the same bits on every device and in every run.

use tests::paper::{BACKLASH_INVERSE, BRAKING_CURVE, RUNS};
use tests::twin::Twin;

#[test]
fn a_used_drive_gives_the_same_run_as_a_fresh_one() {
    let twin = Twin::start();
    // Other laws and parameters in between, and a repeated run: no state may carry over in the drive.
    for run in [1, 1, 0, 3, 2].map(|index| RUNS[index]).into_iter().chain([
        BRAKING_CURVE,
        BACKLASH_INVERSE,
        RUNS[1],
        BRAKING_CURVE,
        BACKLASH_INVERSE,
    ]) {
        let summary = run.pass_on(&twin.device());
        assert_eq!(summary["link"]["lost"], 0);
    }
}

#[test]
fn a_drive_left_running_gives_the_run_of_a_fresh_one() {
    let twin = Twin::start();
    let (bench, _records) = tests::loss::run_in_progress(&twin.device());
    bench.signal(rustix::process::Signal::KILL);
    assert_eq!(bench.wait().code, None);
    let _ = RUNS[1].pass_on(&twin.device());
}

#[test]
fn the_laws_beyond_the_paper_have_equal_torques_on_twin_and_in_process() {
    for run in [BACKLASH_INVERSE, BRAKING_CURVE] {
        let [in_process, twin] = ["inproc", "native"].map(|device| run.pass_on(device));
        assert_eq!(in_process["metrics"], twin["metrics"]);
    }
}
