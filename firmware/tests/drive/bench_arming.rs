//! Arming in bench mode: plausible encoders, a power stage without a fault, limits that the hardware can hold.

use lashloop_firmware::drive::PinReadings;
use lashloop_firmware::power_stage::PowerStageFault;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, Start};

use crate::host::SESSION;
use crate::pin_host::{PinHost, index};

/// One cause of a refusal, with outcome and detail.
type Cause = (&'static str, fn(&mut PinHost), Outcome, u32);

const CAUSES: [Cause; 6] = [
    (
        "the break input is active",
        |host| host.readings.stage_fault = Some(PowerStageFault::BreakInput),
        Outcome::PowerStageFault,
        1,
    ),
    (
        "the fault line is active",
        |host| host.readings.stage_fault = Some(PowerStageFault::FaultLine),
        Outcome::PowerStageFault,
        2,
    ),
    // 25,000 counts of 131,072 in 1 ms are 1198 rad/s.
    ("motor encoder: faster than its limit", |host| host.turn(25_000, 0), Outcome::EncoderImplausible, 2),
    // 2,500 counts are 120 rad/s.
    ("load encoder: faster than its limit", |host| host.turn(0, 2_500), Outcome::EncoderImplausible, 3),
    (
        "motor encoder: both channels changed at once",
        |host| host.readings.motor.illegal_transitions = 1,
        Outcome::EncoderImplausible,
        4,
    ),
    (
        "load encoder: both channels changed at once",
        |host| host.readings.load.illegal_transitions = 3,
        Outcome::EncoderImplausible,
        5,
    ),
];

#[test]
fn arming_needs_plausible_pins_and_says_what_is_not() {
    for (cause, happen, outcome, detail) in CAUSES {
        let mut host = PinHost::with(&[]);
        happen(&mut host);
        host.tick();
        let refusal = host.refusal(Arm { session: SESSION });
        assert_eq!(refusal, (outcome, detail, State::Idle), "{cause}");
    }
}

#[test]
fn a_start_checks_the_pins_again() {
    for (cause, happen, outcome, detail) in CAUSES {
        let mut host = PinHost::with(&[]);
        assert_eq!(host.arm().0, Outcome::Accepted);
        happen(&mut host);
        host.tick();
        let refusal = host.refusal(Start { session: SESSION });
        assert_eq!(refusal, (outcome, detail, State::Armed), "{cause}");
        assert_eq!(host.stage_nm(), None);
    }
}

/// The stage of the tests is an amplifier, which has a current loop of its own.
#[test]
fn a_torque_source_that_the_stage_does_not_have_is_named() {
    for source in [1, 2] {
        let mut host = PinHost::with(&[("torque_source", ParameterValue::U32(source))]);
        host.tick();
        let refusal = host.refusal(Arm { session: SESSION });
        assert_eq!(refusal, (Outcome::Inconsistent, index("torque_source").into(), State::Idle));
    }
}

#[test]
fn an_encoder_at_its_limit_but_for_rounding_is_plausible() {
    // 2,001 counts less one, over 1 ms. The product of scale and counts is rounded otherwise than the limit.
    let limit_rad_s = 2_000.0 / 131_072.0 * std::f64::consts::TAU / 1e-3;
    let arm = |limit_rad_s: f64| {
        let mut host = PinHost::with(&[("load_speed_limit_rad_s", ParameterValue::F32(limit_rad_s as f32))]);
        host.turn(0, 2_001);
        host.tick();
        host.arm().0
    };
    assert_eq!(arm(limit_rad_s * (1.0 - 0.5e-6)), Outcome::Accepted);
    assert_eq!(arm(limit_rad_s * (1.0 - 2e-6)), Outcome::EncoderImplausible);
}

#[test]
fn pins_that_were_never_read_do_not_arm() {
    let mut host = PinHost::unread();
    let refusal = host.refusal(Arm { session: SESSION });
    assert_eq!(refusal, (Outcome::EncoderImplausible, 1, State::Idle));
    host.tick();
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
}

#[test]
fn a_jump_before_arming_counts_until_the_reset() {
    let mut host = PinHost::with(&[]);
    host.turn(0, 2_500);
    host.tick();
    // What follows is slow.
    for count in 2_500..2_550 {
        host.turn(0, 2 * count - 2_500);
        host.tick();
    }
    assert_eq!(host.arm(), (Outcome::EncoderImplausible, State::Idle));
    host.reset();
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
}

#[test]
fn a_reset_keeps_the_latest_readings_for_arming() {
    let mut host = PinHost::with(&[]);
    host.reset();
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
    host.readings.stage_fault = Some(PowerStageFault::FaultLine);
    host.tick();
    host.reset();
    assert_eq!(host.arm(), (Outcome::PowerStageFault, State::Idle));
}

#[test]
fn illegal_transitions_before_a_run_are_no_fault_of_it() {
    let mut host = PinHost::with(&[]);
    host.readings.load.illegal_transitions = 3;
    host.tick();
    host.reset();
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
    assert_eq!(host.start(), (Outcome::Accepted, State::Running));
    host.refer(0.0);
    host.step();
    assert_eq!(host.drive.state(), State::Running);
}

#[test]
fn a_fault_of_the_stage_that_ended_allows_arming() {
    let mut host = PinHost::with(&[]);
    host.readings.stage_fault = Some(PowerStageFault::FaultLine);
    host.tick();
    assert_eq!(host.arm().0, Outcome::PowerStageFault);
    host.readings = PinReadings::default();
    host.tick();
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
}

#[test]
fn hil_mode_arms_without_plausible_pins() {
    let mut host = PinHost::idle();
    host.readings.stage_fault = Some(PowerStageFault::BreakInput);
    host.tick();
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
}

#[test]
fn a_limit_at_the_end_of_the_hardware_but_for_rounding_is_accepted() {
    // Half the range of a counter of 16 bits in 2 ms.
    let fastest_rad_s = 32_767.0 / 131_072.0 * std::f64::consts::TAU / 2e-3;
    for (factor, want) in [(1.0 + 0.5e-6, Outcome::Accepted), (1.0 + 2e-6, Outcome::Inconsistent)] {
        let limit = ParameterValue::F32((fastest_rad_s * factor) as f32);
        let period = ("period_us", ParameterValue::U32(2_000));
        let mut host = PinHost::with(&[period, ("motor_speed_limit_rad_s", limit)]);
        assert_eq!(host.arm().0, want, "{factor}");
    }
}

#[test]
fn what_the_hardware_cannot_do_is_inconsistent_by_name() {
    use ParameterValue::{F32, U32};
    let cases: [(&str, &[(&str, ParameterValue)]); 7] = [
        ("period_us", &[("period_us", U32(65_536))]),
        // 32,767 counts of 131,072 in 2 ms are 785 rad/s.
        ("motor_speed_limit_rad_s", &[("period_us", U32(2000))]),
        // 32,767 counts in 0.25 ms are 131 million in a second; the default filter passes 31 million, 1510 rad/s.
        ("motor_speed_limit_rad_s", &[("period_us", U32(250)), ("motor_speed_limit_rad_s", F32(1515.0))]),
        // The one that stops 119 ns passes 10.5 million, 503 rad/s.
        (
            "motor_speed_limit_rad_s",
            &[("encoder_filter_ns", U32(119)), ("motor_speed_limit_rad_s", F32(505.0))],
        ),
        ("torque_limit_nm", &[("torque_per_duty_nm", F32(200.0))]),
        ("duty_min", &[("duty_min", F32(0.6))]),
        ("duty_offset", &[("duty_max", F32(0.4))]),
    ];
    for (name, settings) in cases {
        let mut host = PinHost::with(settings);
        let refusal = host.refusal(Arm { session: SESSION });
        assert_eq!(refusal, (Outcome::Inconsistent, index(name).into(), State::Idle), "{name}");
    }
}
