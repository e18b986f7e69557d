//! Wall-clock time of runs. The bounds are ten times the goals, so that only a regression of the loop exceeds them.

use serde_json::Value;
use tests::paper::{PATIENCE, RUNS};
use tests::program;
use tests::records::Records;

/// The best of three runs, because other load only adds time.
fn best_wall_s(device: &str) -> f64 {
    let wall_s = || {
        let records = Records::new();
        let arguments = ["run", &RUNS[1].scenario(), "--device", device, "--out", &records.out()];
        let _ = program::run(arguments.into_iter().chain(PATIENCE)).with_code(0);
        records.summary().get("wall_s").and_then(Value::as_f64).expect("the wall-clock time")
    };
    (0..3).map(|_| wall_s()).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_loop_is_far_faster_than_plant_time() {
    for (device, goal_s) in [("inproc", 0.1), ("native", 2.5)] {
        let (best_s, cap_s) = (best_wall_s(device), 10.0 * goal_s);
        assert!(best_s <= cap_s, "{device}: 25 s of the plant took {best_s} s, at most {cap_s} s");
    }
}
