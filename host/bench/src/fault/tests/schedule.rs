//! The steps in which a fault is active.

use super::scenario;
use crate::fault::schedule::Schedule;

fn schedule(fault: &str) -> (u32, Option<u32>) {
    let scenario = scenario(&[fault]);
    let Schedule { from, until } = Schedule::of(&scenario.faults[0], &scenario.run);
    (from, until)
}

#[test]
fn times_round_to_the_nearest_step() {
    assert_eq!(schedule("kind = \"torque-dead\"\nat_s = 0.1004\nfor_s = 0.0206"), (100, Some(121)));
}

#[test]
fn a_fault_lasts_one_step_at_least() {
    assert_eq!(schedule("kind = \"torque-dead\"\nat_s = 0.1\nfor_s = 1e-6"), (100, Some(101)));
}

#[test]
fn a_fault_without_a_duration_lasts_to_the_end() {
    assert_eq!(schedule("kind = \"torque-dead\"\nat_s = 0.1"), (100, None));
}

#[test]
fn a_reset_lasts_one_step() {
    assert_eq!(schedule("kind = \"device-reset\"\nat_s = 0.1"), (100, Some(101)));
}

#[test]
fn a_schedule_includes_its_start_and_excludes_its_end() {
    let schedule = Schedule { from: 3, until: Some(5) };
    assert_eq!([2, 3, 4, 5].map(|step| schedule.contains(step)), [false, true, true, false]);
}
