//! Lockstep results are the same bits on every device and in every run.

use tests::paper::{BACKLASH_INVERSE, RUNS};
use tests::twin::Twin;

#[test]
fn a_used_drive_gives_the_same_run_as_a_fresh_one() {
    let twin = Twin::start();
    // Other controllers and parameters in between, and one run right after its like: nothing may stick to the drive.
    for run in [1, 1, 0, 3, 2].map(|index| RUNS[index]).into_iter().chain([
        BACKLASH_INVERSE,
        RUNS[1],
        BACKLASH_INVERSE,
    ]) {
        let summary = run.pass_on(&twin.device());
        assert_eq!(summary["link"]["lost"], 0);
    }
}

#[test]
fn a_drive_that_was_left_running_gives_the_same_run_as_a_fresh_one() {
    let twin = Twin::start();
    let (bench, _records) = tests::loss::run_in_progress(&twin.device());
    bench.signal(rustix::process::Signal::KILL);
    assert_eq!(bench.wait().code, None);
    let _ = RUNS[1].pass_on(&twin.device());
}

#[test]
fn the_compensating_law_gives_the_same_torques_in_process_and_on_the_twin() {
    let [in_process, twin] = ["inproc", "native"].map(|device| BACKLASH_INVERSE.pass_on(device));
    assert_eq!(in_process["metrics"], twin["metrics"]);
}
