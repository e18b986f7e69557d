//! No torque where there should be none.

use std::time::Duration;

use lashloop_firmware::drive::fault_frame;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, ClearFault, EmergencyStop, EncoderSample, Hello, Reset, Stop};
use lashloop_protocol::{Decoder, DriveMessage, PROTOCOL_VERSION};

use crate::host::{Host, SESSION, fault, sample, torque};

const MOTOR: i64 = 3 * 32_768;
const LOAD: i64 = 32_768;

/// Running, and giving torque.
fn pushing() -> Host {
    let mut host = Host::running(&[]);
    host.sample(0, MOTOR, LOAD);
    assert_ne!(host.drive.torque_nm(), 0.0);
    host
}

#[test]
fn missing_samples_trip_the_watchdog_and_the_torque_goes_to_zero() {
    let mut host = pushing();
    host.pass(Duration::from_millis(20));
    assert_ne!(host.drive.torque_nm(), 0.0, "the limit itself is still in time");
    host.pass(Duration::from_micros(100));
    assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Faulted));
    let report = fault(&host.listen());
    assert_eq!((report.code, report.sequence, report.limit), (FaultCode::Watchdog, 0, 0.02));
    assert!((report.value - 0.0201).abs() < 1e-6);
}

#[test]
fn a_sample_after_the_watchdog_s_time_is_too_late_even_without_a_tick() {
    let mut host = pushing();
    host.clock.advance(Duration::from_millis(21));
    let answers = host.sample(1, MOTOR, LOAD);
    assert_eq!(host.drive.torque_nm(), 0.0);
    assert_eq!(fault(&answers).code, FaultCode::Watchdog);
}

#[test]
fn repeating_one_sample_does_not_feed_the_watchdog() {
    let mut host = pushing();
    for _ in 0..30 {
        host.pass(Duration::from_millis(1));
        host.sample(0, MOTOR, LOAD);
    }
    assert_eq!(host.drive.state(), State::Faulted);
}

#[test]
fn a_drive_that_is_not_running_needs_no_samples() {
    let mut host = Host::idle();
    host.pass(Duration::from_secs(3600));
    assert_eq!(host.drive.state(), State::Idle);
}

#[test]
fn emergency_stop_latches_from_any_state() {
    let mut armed = Host::idle();
    armed.say(Arm { session: SESSION });
    for mut host in [Host::new(), Host::idle(), armed, pushing()] {
        let answers = host.say(EmergencyStop {});
        assert_eq!(fault(&answers).code, FaultCode::EmergencyStop);
        assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Faulted));
    }
}

#[test]
fn the_first_fault_is_the_one_that_is_told_again() {
    let mut host = Host::running(&[]);
    host.sample(0, 0, 0);
    host.sample(1, 8_388_607, 0);
    host.say(EmergencyStop {});
    let answers = host.say(Hello { protocol_version: PROTOCOL_VERSION, session: SESSION + 1 });
    assert_eq!(fault(&answers).code, FaultCode::MotorEncoderJump);
}

#[test]
fn a_late_sample_is_answered_before_its_fault_is_told() {
    let mut host = pushing();
    host.clock.advance(Duration::from_secs(1));
    let answers = host.sample(1, MOTOR, LOAD);
    assert_eq!((torque(&answers).torque_nm, torque(&answers).status.state), (0.0, State::Faulted));
    assert!(matches!(answers[1], DriveMessage::FaultReport(_)), "{answers:?}");
}

#[test]
fn one_count_is_never_a_jump_however_coarse_the_encoder() {
    let coarse = [("load_counts_per_rev", ParameterValue::U32(60)), ("period_us", ParameterValue::U32(100))];
    let mut host = Host::running(&coarse);
    host.sample(0, 0, 0);
    assert_eq!(torque(&host.sample(1, 0, 1)).status.state, State::Running);
    assert_eq!(fault(&host.sample(2, 0, 3)).code, FaultCode::LoadEncoderJump);
}

#[test]
fn a_twist_that_would_not_fit_is_refused_before_it_is_computed() {
    let mut host = Host::idle();
    host.set("reduction_ratio", ParameterValue::F32(1e4));
    host.set("motor_counts_per_rev", ParameterValue::U32(1 << 24));
    host.set("load_counts_per_rev", ParameterValue::U32(4));
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Inconsistent, State::Idle));
}

#[test]
fn a_fault_stays_until_it_is_cleared() {
    let mut host = pushing();
    host.say(EmergencyStop {});
    host.say(Stop {});
    let answer = torque(&host.sample(1, MOTOR, LOAD));
    assert_eq!((answer.torque_nm, answer.status.state), (0.0, State::Faulted));
    assert_eq!(host.command(ClearFault {}), (Outcome::Accepted, State::Idle));
    assert_eq!(torque(&host.sample(2, MOTOR, LOAD)).torque_nm, 0.0, "cleared is not armed");
}

#[test]
fn clearing_a_fault_does_not_stand_in_for_the_greeting() {
    let mut host = Host::new();
    host.say(EmergencyStop {});
    assert_eq!(host.command(ClearFault {}), (Outcome::Accepted, State::Boot));
}

#[test]
fn an_encoder_faster_than_the_limit_is_a_fault_before_the_controller_sees_it() {
    // 1000 rad/s at 131072 counts are 20,861 counts in a millisecond; the load has 100 rad/s.
    let cases = [
        (20_800, 0, None),
        (20_900, 0, Some((FaultCode::MotorEncoderJump, 1000.0))),
        (-20_900, 0, Some((FaultCode::MotorEncoderJump, 1000.0))),
        (0, 2_000, None),
        (0, -2_100, Some((FaultCode::LoadEncoderJump, 100.0))),
        (-8_388_608, 0, Some((FaultCode::MotorEncoderJump, 1000.0))),
    ];
    for (motor, load, want) in cases {
        let mut host = Host::running(&[]);
        host.sample(0, 0, 0);
        let answers = host.sample(1, motor, load);
        match want {
            None => assert_eq!(torque(&answers).status.state, State::Running, "{motor} {load}"),
            Some((code, limit)) => {
                let report = fault(&answers);
                assert_eq!((report.code, report.limit, report.sequence), (code, limit, 1));
                assert!(report.value.abs() > limit);
                assert_eq!(
                    (torque(&answers).torque_nm, torque(&answers).status.state),
                    (0.0, State::Faulted)
                );
            }
        }
    }
}

#[test]
fn lost_samples_stretch_the_plausible_move() {
    let mut host = Host::running(&[]);
    host.sample(0, 0, 0);
    assert_eq!(torque(&host.sample(4, 4 * 20_800, 0)).status.state, State::Running);
}

#[test]
fn a_counter_may_wrap() {
    let mut host = Host::running(&[]);
    host.sample(0, 8_388_607, 0);
    assert_eq!(torque(&host.sample(1, -8_388_603, 0)).status.state, State::Running);
}

#[test]
fn a_reference_that_is_no_number_is_a_fault() {
    for reference_rad in [f32::NAN, f32::INFINITY] {
        let mut host = pushing();
        let sample = EncoderSample { reference_rad, ..sample(1, MOTOR, LOAD) };
        let answers = host.say(sample);
        assert_eq!(fault(&answers).code, FaultCode::ReferenceNotFinite);
        assert_eq!(host.drive.torque_nm(), 0.0);
    }
}

#[test]
fn a_torque_that_is_no_number_is_a_fault_and_never_leaves() {
    let overflow = [("k_p2", ParameterValue::F32(1e6)), ("k_p1", ParameterValue::F32(1e6))];
    let mut host = Host::running(&overflow);
    let sample = EncoderSample { reference_rad: f32::MAX, ..sample(0, MOTOR, LOAD) };
    let answers = host.say(sample);
    assert_eq!(fault(&answers).code, FaultCode::TorqueNotFinite);
    assert_eq!((torque(&answers).torque_nm, torque(&answers).status.state), (0.0, State::Faulted));
}

#[test]
fn stop_and_reset_take_the_torque_away() {
    let mut host = pushing();
    host.say(Stop {});
    assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Idle));
    let mut host = pushing();
    host.say(Reset {});
    assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Boot));
}

#[test]
fn the_last_words_of_a_dying_firmware_are_a_fault_report() {
    let frame = fault_frame(FaultCode::ProcessorFault, 0x0800_1234);
    let message = Decoder::new().next(&mut &frame[..]);
    assert!(
        matches!(message, Some(Ok(DriveMessage::FaultReport(r))) if r.code == FaultCode::ProcessorFault && r.detail == 0x0800_1234)
    );
}
