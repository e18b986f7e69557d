//! Faults of the motor.

use super::scenario;
use crate::fault::motor::MotorFaults;

/// What the motor makes of the torques 1, 2, 3 and so on.
fn given(faults: &[&str]) -> Vec<f32> {
    let mut faults = MotorFaults::new(&scenario(faults));
    (0..6_u8).map(|step| faults.apply(step.into(), f32::from(step) + 1.0)).collect()
}

const FROM_2_FOR_3: &str = "at_s = 0.002\nfor_s = 0.003\n";

fn one(fault: &str) -> Vec<f32> {
    given(&[&format!("{FROM_2_FOR_3}{fault}")])
}

#[test]
fn saturation_limits_either_way() {
    assert_eq!(one("kind = \"torque-saturation\"\nlimit_nm = 3.5"), [1.0, 2.0, 3.0, 3.5, 3.5, 6.0]);
    let scenario = scenario(&["kind = \"torque-saturation\"\nlimit_nm = 3.5\nat_s = 0"]);
    assert_eq!(MotorFaults::new(&scenario).apply(0, -9.0), -3.5);
}

#[test]
fn a_gain_may_be_any_also_a_motor_wired_the_wrong_way() {
    assert_eq!(one("kind = \"torque-gain\"\ngain = -0.5"), [1.0, 2.0, -1.5, -2.0, -2.5, 6.0]);
}

#[test]
fn a_dead_motor_gives_nothing() {
    assert_eq!(one("kind = \"torque-dead\""), [1.0, 2.0, 0.0, 0.0, 0.0, 6.0]);
}

#[test]
fn a_delay_applies_earlier_torques_and_zero_before_the_first() {
    assert_eq!(one("kind = \"torque-delay\"\nsteps = 2"), [1.0, 2.0, 1.0, 2.0, 3.0, 6.0]);
    assert_eq!(given(&["kind = \"torque-delay\"\nsteps = 4\nat_s = 0"]), [0.0, 0.0, 0.0, 0.0, 1.0, 2.0]);
}

#[test]
fn a_gain_and_a_delay_both_act_whichever_stands_first() {
    let delay = "kind = \"torque-delay\"\nsteps = 1\nat_s = 0";
    let gain = "kind = \"torque-gain\"\ngain = 10\nat_s = 0";
    let both = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0];
    assert_eq!(given(&[delay, gain]), both);
    assert_eq!(given(&[gain, delay]), both);
}

#[test]
fn two_delays_add_up() {
    let delay = "kind = \"torque-delay\"\nsteps = 2\nat_s = 0";
    assert_eq!(given(&[delay, delay]), [0.0, 0.0, 0.0, 0.0, 1.0, 2.0]);
}
