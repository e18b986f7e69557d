//! Faults, and zero torque in every state but running.

use std::time::Duration;

use lashloop_firmware::drive::fault_frame;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, ClearFault, EmergencyStop, EncoderSample, Hello, Reset, Stop};
use lashloop_protocol::{Decoder, DriveMessage};

use crate::host::{HELLO, Host, SESSION, fault, sample, torque};

const MOTOR: i64 = 3 * 32_768;
const LOAD: i64 = 32_768;

/// A host of a running drive with a torque other than zero.
fn under_torque() -> Host {
    let mut host = Host::running(&[]);
    host.sample(0, MOTOR, LOAD);
    assert_ne!(host.drive.torque_nm(), 0.0);
    host
}

#[test]
fn missing_samples_trip_the_watchdog_and_zero_the_torque() {
    let mut host = under_torque();
    host.advance(Duration::from_millis(20));
    assert_ne!(host.drive.torque_nm(), 0.0, "the limit itself is in time");
    host.advance(Duration::from_micros(100));
    assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Faulted));
    let report = fault(&host.take_output());
    assert_eq!((report.code, report.sequence, report.limit), (FaultCode::Watchdog, 0, 0.02));
    assert!((report.value - 0.0201).abs() < 1e-6);
}

#[test]
fn a_late_sample_trips_the_watchdog_without_a_tick() {
    let mut host = under_torque();
    host.clock.advance(Duration::from_millis(21));
    let answers = host.sample(1, MOTOR, LOAD);
    assert_eq!(host.drive.torque_nm(), 0.0);
    assert_eq!((torque(&answers).torque_nm, torque(&answers).status.state), (0.0, State::Faulted));
    assert!(
        matches!(answers[1], DriveMessage::FaultReport(report) if report.code == FaultCode::Watchdog),
        "the torque precedes the report: {answers:?}"
    );
}

#[test]
fn a_repeated_sample_does_not_restart_the_watchdog() {
    let mut host = under_torque();
    for _ in 0..30 {
        host.advance(Duration::from_millis(1));
        host.sample(0, MOTOR, LOAD);
    }
    assert_eq!(host.drive.state(), State::Faulted);
}

#[test]
fn the_watchdog_counts_only_while_running() {
    let mut host = Host::idle();
    host.advance(Duration::from_secs(3600));
    assert_eq!(host.drive.state(), State::Idle);
}

#[test]
fn emergency_stop_latches_from_any_state() {
    let mut armed = Host::idle();
    armed.send(Arm { session: SESSION });
    for mut host in [Host::new(), Host::idle(), armed, under_torque()] {
        let answers = host.send(EmergencyStop {});
        assert_eq!(fault(&answers).code, FaultCode::EmergencyStop);
        assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Faulted));
    }
}

#[test]
fn the_first_fault_stays_latched_across_faults_and_sessions() {
    let mut host = Host::running(&[]);
    host.sample(0, 0, 0);
    host.sample(1, 8_388_607, 0);
    host.send(EmergencyStop {});
    let answers = host.send(Hello::new(SESSION + 1));
    assert!(matches!(answers[0], DriveMessage::Identity(identity) if identity.state == State::Faulted));
    assert_eq!(fault(&answers).code, FaultCode::MotorEncoderJump);
}

#[test]
fn a_latched_fault_is_reported_again_with_the_time_of_the_report() {
    let mut host = under_torque();
    host.send(EmergencyStop {});
    host.clock.advance(Duration::from_millis(5));
    let [DriveMessage::Identity(identity), DriveMessage::FaultReport(report)] = host.send(HELLO)[..] else {
        panic!("the identity, then the fault")
    };
    assert_eq!((identity.device_time_us, report.device_time_us), (Some(5_000), Some(5_000)));
}

#[test]
fn one_count_of_a_coarse_encoder_is_no_jump() {
    let coarse = [("load_counts_per_rev", ParameterValue::U32(60)), ("period_us", ParameterValue::U32(100))];
    let mut host = Host::running(&coarse);
    host.sample(0, 0, 0);
    assert_eq!(torque(&host.sample(1, 0, 1)).status.state, State::Running);
    assert_eq!(fault(&host.sample(2, 0, 3)).code, FaultCode::LoadEncoderJump);
}

#[test]
fn a_fault_stays_latched_until_it_is_cleared() {
    let mut host = under_torque();
    host.send(EmergencyStop {});
    host.send(Stop {});
    let answer = torque(&host.sample(1, MOTOR, LOAD));
    assert_eq!((answer.torque_nm, answer.status.state), (0.0, State::Faulted));
    assert_eq!(host.command(ClearFault {}), (Outcome::Accepted, State::Idle));
    assert_eq!(torque(&host.sample(2, MOTOR, LOAD)).torque_nm, 0.0, "clearing does not arm");
}

#[test]
fn clearing_a_fault_opens_no_session() {
    let mut host = Host::new();
    host.send(EmergencyStop {});
    assert_eq!(host.command(ClearFault {}), (Outcome::Accepted, State::Boot));
}

#[test]
fn an_encoder_faster_than_its_limit_is_a_fault() {
    // 1000 rad/s at 131,072 counts are 20,861 counts in a millisecond; the limit of the load is 100 rad/s.
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
fn lost_samples_allow_a_proportionally_larger_move() {
    let mut host = Host::running(&[]);
    host.sample(0, 0, 0);
    assert_eq!(torque(&host.sample(4, 4 * 20_800, 0)).status.state, State::Running);
}

#[test]
fn a_non_finite_reference_is_a_fault() {
    for reference_rad in [f32::NAN, f32::INFINITY] {
        let mut host = under_torque();
        let sample = EncoderSample { reference_rad, ..sample(1, MOTOR, LOAD) };
        let answers = host.send(sample);
        assert_eq!(fault(&answers).code, FaultCode::ReferenceNotFinite);
        assert_eq!(host.drive.torque_nm(), 0.0);
    }
}

#[test]
fn a_non_finite_torque_is_a_fault_and_is_never_sent() {
    let overflow = [("k_p2", ParameterValue::F32(1e6)), ("k_p1", ParameterValue::F32(1e6))];
    let mut host = Host::running(&overflow);
    let sample = EncoderSample { reference_rad: f32::MAX, ..sample(0, MOTOR, LOAD) };
    let answers = host.send(sample);
    assert_eq!(fault(&answers).code, FaultCode::TorqueNotFinite);
    assert_eq!((torque(&answers).torque_nm, torque(&answers).status.state), (0.0, State::Faulted));
}

#[test]
fn stop_and_reset_zero_the_torque() {
    let mut host = under_torque();
    host.send(Stop {});
    assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Idle));
    let mut host = under_torque();
    host.send(Reset {});
    assert_eq!((host.drive.torque_nm(), host.drive.state()), (0.0, State::Boot));
}

#[test]
fn the_fault_frame_of_a_handler_is_a_whole_fault_report() {
    let frame = fault_frame(FaultCode::ProcessorFault, 0x0800_1234, Duration::from_micros(77));
    let message = Decoder::new().next(&mut &frame[..]).expect("a frame").expect("a message").message;
    let DriveMessage::FaultReport(report) = message else { panic!("{message:?}") };
    assert_eq!((report.code, report.detail), (FaultCode::ProcessorFault, 0x0800_1234));
    assert_eq!(report.device_time_us, Some(77));
}
