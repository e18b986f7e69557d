//! When a fault is there.

use super::scenario;
use crate::fault::Schedule;

fn schedule(fault: &str) -> (u32, u32) {
    let scenario = scenario(&[fault]);
    let Schedule { from, until } = Schedule::of(&scenario.faults[0], &scenario.run);
    (from, until)
}

#[test]
fn times_go_to_the_nearest_step() {
    assert_eq!(schedule("kind = \"torque-dead\"\nat_s = 0.1004\nfor_s = 0.0206"), (100, 121));
}

#[test]
fn a_fault_is_there_for_one_step_at_least() {
    assert_eq!(schedule("kind = \"torque-dead\"\nat_s = 0.1\nfor_s = 1e-6"), (100, 101));
}

#[test]
fn a_fault_without_a_duration_stays() {
    assert_eq!(schedule("kind = \"torque-dead\"\nat_s = 0.1"), (100, u32::MAX));
}

#[test]
fn a_reset_is_over_at_once() {
    assert_eq!(schedule("kind = \"device-reset\"\nat_s = 0.1"), (100, 101));
}

#[test]
fn the_first_step_is_in_and_the_last_is_out() {
    let schedule = Schedule { from: 3, until: 5 };
    assert_eq!([2, 3, 4, 5].map(|step| schedule.contains(step)), [false, true, true, false]);
}
