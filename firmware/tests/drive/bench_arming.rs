//! Arming in bench mode: plausible encoders, a power stage without a fault, limits that the hardware can hold.

use lashloop_firmware::drive::PinReadings;
use lashloop_firmware::power_stage::PowerStageFault;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::Arm;

use crate::host::SESSION;
use crate::pin_host::PinHost;

/// One cause of a refusal, and its outcome.
type Cause = (&'static str, fn(&mut PinHost), Outcome);

const CAUSES: [Cause; 5] = [
    (
        "the break input is active",
        |host| host.readings.stage_fault = Some(PowerStageFault::BreakInput),
        Outcome::PowerStageFault,
    ),
    (
        "the fault line is active",
        |host| host.readings.stage_fault = Some(PowerStageFault::FaultLine),
        Outcome::PowerStageFault,
    ),
    (
        "motor encoder: both channels changed at once",
        |host| host.readings.motor.illegal_transitions = 1,
        Outcome::EncoderImplausible,
    ),
    (
        "load encoder: both channels changed at once",
        |host| host.readings.load.illegal_transitions = 3,
        Outcome::EncoderImplausible,
    ),
    // 2,500 counts of 131,072 in 1 ms are 120 rad/s.
    ("load encoder: faster than its limit", |host| host.turn(0, 2_500), Outcome::EncoderImplausible),
];

#[test]
fn arming_needs_plausible_pins_and_names_what_is_not() {
    for (cause, happen, outcome) in CAUSES {
        let mut host = PinHost::with(&[]);
        happen(&mut host);
        host.tick();
        let answers = host.send(Arm { session: SESSION });
        let [DriveMessage::Log(log), DriveMessage::CommandResult(result)] = answers[..] else {
            panic!("{answers:?}")
        };
        assert_eq!(log.text.as_str(), cause);
        assert_eq!((result.outcome, result.state), (outcome, State::Idle), "{cause}");
    }
}

#[test]
fn a_start_checks_the_pins_again() {
    for (cause, happen, outcome) in CAUSES {
        let mut host = PinHost::with(&[]);
        assert_eq!(host.arm().0, Outcome::Accepted);
        happen(&mut host);
        host.tick();
        assert_eq!(host.start(), (outcome, State::Armed), "{cause}");
        assert_eq!(host.stage_nm(), None);
    }
}

#[test]
fn pins_that_were_never_read_do_not_arm() {
    let mut host = PinHost::unread();
    assert_eq!(host.arm(), (Outcome::EncoderImplausible, State::Idle));
    host.tick();
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
}

#[test]
fn a_jump_before_arming_counts_until_the_reset() {
    let mut host = PinHost::with(&[]);
    host.turn(0, 2_500);
    host.tick();
    (0..50).for_each(|_| drop(host.tick()));
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
fn what_the_hardware_cannot_do_is_inconsistent_by_name() {
    use ParameterValue::{F32, U32};
    let cases: [(&str, &[(&str, ParameterValue)]); 6] = [
        ("period_us", &[("period_us", U32(65_536))]),
        // 32,767 counts of 131,072 in 2 ms are 785 rad/s.
        ("motor_speed_limit_rad_s", &[("period_us", U32(2000))]),
        // 32,767 counts in 0.25 ms are 131 million in a second; the filter passes 41 million, 1965 rad/s.
        ("motor_speed_limit_rad_s", &[("period_us", U32(250)), ("motor_speed_limit_rad_s", F32(2000.0))]),
        ("torque_limit_nm", &[("torque_per_duty_nm", F32(200.0))]),
        ("duty_min", &[("duty_min", F32(0.6))]),
        ("duty_offset", &[("duty_max", F32(0.4))]),
    ];
    for (name, settings) in cases {
        let mut host = PinHost::with(settings);
        let answers = host.send(Arm { session: SESSION });
        let [DriveMessage::Log(log), DriveMessage::CommandResult(result)] = answers[..] else {
            panic!("{name}: {answers:?}")
        };
        assert_eq!(log.text.as_str(), format!("{name} does not go with the others"));
        assert_eq!((result.outcome, result.state), (Outcome::Inconsistent, State::Idle));
    }
}
