//! Faults, late samples and repetitions: what an answer and a report carry in each case.

use std::time::Duration;

use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{
    EmergencyStop, EncoderSample, FaultReport, Hello, LineReport, Reset, Stop, TorqueAnswer,
};
use lashloop_protocol::{DriveMessage, EncoderCounts};

use crate::host::{HELLO, Host, SESSION, names, refusal, request, rest};

/// A watchdog of these tests, as in the default parameters.
const WATCHDOG: Duration = Duration::from_millis(20);
/// Past the watchdog.
const LATE: Duration = Duration::from_millis(21);

fn torque(answers: &[DriveMessage]) -> TorqueAnswer {
    match answers[0] {
        DriveMessage::TorqueAnswer(answer) => answer,
        other => panic!("{other:?} instead of a torque"),
    }
}

fn report(answers: &[DriveMessage]) -> FaultReport {
    let mut reports = answers.iter().filter_map(|answer| match answer {
        DriveMessage::FaultReport(report) => Some(*report),
        _ => None,
    });
    reports.next().unwrap_or_else(|| panic!("no report in {answers:?}"))
}

/// A sample one radian off its reference.
fn off(sequence: u16) -> EncoderSample {
    EncoderSample { reference_rad: 1.0, ..rest(sequence) }
}

/// Samples that fault, each by another rule.
fn faulting(sequence: u16) -> [(FaultCode, EncoderSample); 3] {
    // Half the range: faster than any limit over any gap of these tests.
    let far = EncoderCounts::wrapping(1 << 22);
    [
        (FaultCode::ReferenceNotFinite, EncoderSample { reference_rad: f32::NEG_INFINITY, ..rest(sequence) }),
        (FaultCode::MotorEncoderJump, EncoderSample { motor_counts: far, ..rest(sequence) }),
        (FaultCode::LoadEncoderJump, EncoderSample { load_counts: far, ..rest(sequence) }),
    ]
}

#[test]
fn a_faulting_sample_keeps_gap_and_no_other_flag() {
    for (sequence, flags) in [(1, TorqueFlags::empty()), (3, TorqueFlags::GAP)] {
        for (code, sample) in faulting(sequence) {
            let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(0.01))]);
            assert_eq!(torque(&host.send(off(0))).status.flags, TorqueFlags::SATURATED);
            let answers = host.send(sample);
            let answer = torque(&answers);
            assert_eq!((answer.sequence, answer.torque_nm), (sequence, 0.0), "{code:?}");
            assert_eq!((answer.status.state, answer.status.flags), (State::Faulted, flags), "{code:?}");
            assert_eq!((report(&answers).code, report(&answers).sequence), (code, sequence));
        }
    }
}

#[test]
fn a_repetition_is_the_last_answer_with_one_more_flag() {
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(0.01))]);
    host.send(off(0));
    let answer = torque(&host.send(off(3)));
    assert_eq!(answer.status.flags, TorqueFlags::GAP | TorqueFlags::SATURATED);
    for _ in 0..3 {
        // The number alone makes a repetition.
        let again = torque(&host.send(EncoderSample { reference_rad: f32::NAN, ..off(3) }));
        assert_eq!(again.status.flags, answer.status.flags | TorqueFlags::REPEATED);
        assert_eq!(TorqueAnswer { status: answer.status, ..again }, answer);
    }
    assert_eq!(torque(&host.send(off(4))).status.flags, TorqueFlags::SATURATED);
}

#[test]
fn a_late_sample_of_any_number_is_answered_as_in_faulted() {
    // New, after a gap, repeated, stray.
    for sequence in [3, 9, 2, 1, 40_000] {
        let mut host = Host::running(&[]);
        (0..=2).for_each(|sequence| drop(host.send(off(sequence))));
        host.wait(LATE);
        let answers = host.send(off(sequence));
        assert_eq!(names(&answers), "TorqueAnswer, FaultReport", "{sequence}");
        let answer = torque(&answers);
        assert_eq!((answer.sequence, answer.torque_nm), (sequence, 0.0));
        assert_eq!((answer.status.state, answer.status.flags), (State::Faulted, TorqueFlags::empty()));
        let report = report(&answers);
        assert_eq!((report.code, report.sequence), (FaultCode::Watchdog, 2), "the last sample accepted");
        assert_eq!([report.value, report.limit], [LATE.as_secs_f32(), WATCHDOG.as_secs_f32()]);
    }
}

#[test]
fn a_report_keeps_its_sequence_after_the_run_and_over_sessions() {
    let sequence = |host: &mut Host| report(&host.send(EmergencyStop {})).sequence;
    let mut host = Host::running(&[]);
    (0..=5).for_each(|sequence| drop(host.send(off(sequence))));
    host.send(off(5));
    host.send(off(2000));
    host.send(Stop {});
    host.send(Hello::new(SESSION + 1));
    assert_eq!(sequence(&mut host), 5);
    let first = host.send(HELLO);
    host.wait(10 * LATE);
    host.send(off(6));
    host.send(Stop {});
    for session in [SESSION, SESSION + 1] {
        let again = report(&host.send(Hello::new(session)));
        assert!(again.device_time_us > report(&first).device_time_us, "the time of this answer");
        assert_eq!(
            FaultReport { device_time_us: None, ..again },
            FaultReport { device_time_us: None, ..report(&first) }
        );
    }
    host.send(request("ClearFault"));
    host.send(HELLO);
    host.send(request("Arm"));
    host.send(request("Start"));
    assert_eq!(sequence(&mut host), 0, "no sample since the start");
    let mut host = Host::running(&[]);
    (0..=5).for_each(|sequence| drop(host.send(off(sequence))));
    host.send(Reset {});
    assert_eq!(sequence(&mut host), 0, "nothing remains after a reset");
}

#[test]
fn a_version_of_0_or_255_is_another_version_and_feeds_no_watchdog() {
    let mut host = Host::running(&[]);
    host.send(off(0));
    for protocol_version in [0, 255] {
        host.wait(WATCHDOG / 2);
        let answers = host.send(Hello { protocol_version, ..Hello::new(1) });
        assert_eq!(refusal(&answers), Some(Outcome::VersionMismatch));
        assert!(
            matches!(answers[0], DriveMessage::Identity(it) if (it.session, it.state) == (1, State::Running))
        );
    }
    assert_eq!(host.tick(), [], "exactly the limit");
    host.wait(Duration::from_nanos(1));
    assert_eq!(report(&host.tick()).code, FaultCode::Watchdog);
}

#[test]
fn counts_of_the_receiver_restart_at_the_start_only() {
    let counts = |host: &mut Host| match host.send(Stop {})[0] {
        DriveMessage::LineReport(LineReport { messages, .. }) => messages,
        other => panic!("{other:?}"),
    };
    let mut host = Host::running(&[]);
    host.send(off(0));
    assert_eq!(counts(&mut host), 2, "the sample and the stop");
    host.send(Reset {});
    assert_eq!(counts(&mut host), 4, "the reset and the second stop too");
    host.send(HELLO);
    host.send(request("Arm"));
    host.send(request("Start"));
    assert_eq!(counts(&mut host), 1);
}
