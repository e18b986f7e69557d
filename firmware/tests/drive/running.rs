//! The control path.

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{ParameterValue, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{Arm, LineReport, Start, Stop};

use crate::host::{Host, SESSION, torque};

/// Quarter of a turn on the load with the reducer in line, in counts of the default encoders.
const MOTOR: i64 = 3 * 32_768;
const LOAD: i64 = 32_768;

fn running(flags: TorqueFlags) -> TorqueStatus {
    TorqueStatus { state: State::Running, flags }
}

#[test]
fn pd_gives_the_torque_of_the_paper_for_a_position_error() {
    // e_s = pi/2, z = 0: theta_e_d = -10 e_s, U = -(theta_e - theta_e_d) = -(3 pi/2 + 10 pi/2).
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(100.0))]);
    let answer = torque(&host.sample(0, MOTOR, LOAD));
    let want = -13.0 * std::f32::consts::FRAC_PI_2;
    // The middle of a count is half a count, 2.4e-5 rad, off; the gain is 13.
    assert!((answer.torque_nm - want).abs() < 1e-3, "have {}, want {want}", answer.torque_nm);
    assert_eq!((answer.sequence, answer.status), (0, running(TorqueFlags::empty())));
    assert_eq!(host.drive.torque_nm(), answer.torque_nm);
}

#[test]
fn torque_is_clamped_and_flagged() {
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(5.0))]);
    let answer = torque(&host.sample(0, MOTOR, LOAD));
    assert_eq!((answer.torque_nm, answer.status), (-5.0, running(TorqueFlags::SATURATED)));
}

#[test]
fn a_repeated_sample_gets_the_same_answer_without_a_step() {
    let merzouki = [("controller", ParameterValue::U32(1)), ("torque_limit_nm", ParameterValue::F32(100.0))];
    let (mut once, mut twice) = (Host::running(&merzouki), Host::running(&merzouki));
    let first = torque(&once.sample(0, MOTOR, LOAD));
    twice.sample(0, MOTOR, LOAD);
    let again = torque(&twice.sample(0, MOTOR, LOAD));
    assert_eq!((again.torque_nm, again.status), (first.torque_nm, running(TorqueFlags::REPEATED)));
    // Another step would have changed the estimate and the filters.
    let (a, b) = (torque(&once.sample(1, MOTOR - 500, LOAD)), torque(&twice.sample(1, MOTOR - 500, LOAD)));
    assert_eq!(a.torque_nm.to_bits(), b.torque_nm.to_bits());
}

#[test]
fn a_gap_is_flagged_and_does_not_double_the_velocity() {
    let settings = [("torque_limit_nm", ParameterValue::F32(100.0)), ("k_d1", ParameterValue::F32(0.1))];
    let (mut whole, mut gappy) = (Host::running(&settings), Host::running(&settings));
    for (sequence, counts) in [(0, 0), (1, 100), (2, 200)] {
        whole.sample(sequence, counts, 0);
    }
    gappy.sample(0, 0, 0);
    let answer = torque(&gappy.sample(2, 200, 0));
    assert_eq!(answer.status, running(TorqueFlags::GAP));
    let (want, have) = (torque(&whole.sample(3, 300, 0)), torque(&gappy.sample(3, 300, 0)));
    assert!((want.torque_nm - have.torque_nm).abs() < 1e-4, "want {want:?}, have {have:?}");
}

#[test]
fn a_sample_of_another_run_is_rejected_and_changes_nothing() {
    let mut host = Host::running(&[]);
    assert!(matches!(host.sample(5, 9, 9)[..], [DriveMessage::CommandResult(_)]), "a run begins with 0");
    host.sample(0, 0, 0);
    host.sample(1, 0, 0);
    let before = host.drive.torque_nm();
    for stray in [0, 5_000, 32_769, u16::MAX] {
        assert!(
            matches!(host.sample(stray, 90, 90)[..], [DriveMessage::CommandResult(_)]),
            "sequence {stray}"
        );
    }
    assert_eq!(host.drive.torque_nm(), before);
}

#[test]
fn every_law_gives_a_torque_of_its_own() {
    let torques: Vec<f32> = (0..Laws::NAMES.len() as u32)
        .map(|law| {
            let limit = ("torque_limit_nm", ParameterValue::F32(100.0));
            let mut host = Host::running(&[("controller", ParameterValue::U32(law)), limit]);
            host.sample(0, MOTOR + 20_000, LOAD);
            torque(&host.sample(1, MOTOR + 20_500, LOAD)).torque_nm
        })
        .collect();
    for (k, torque) in torques.iter().enumerate() {
        assert!(!torques[..k].contains(torque), "{torques:?}");
    }
}

#[test]
fn a_new_run_starts_from_the_initial_state() {
    let merzouki = [("controller", ParameterValue::U32(1)), ("torque_limit_nm", ParameterValue::F32(100.0))];
    let mut host = Host::running(&merzouki);
    let run = |host: &mut Host| -> Vec<u32> {
        (0..50)
            .map(|k| torque(&host.sample(k, MOTOR - 300 * i64::from(k), LOAD)).torque_nm.to_bits())
            .collect()
    };
    let first = run(&mut host);
    host.send(Stop {});
    let session = SESSION;
    host.send(Arm { session });
    host.send(Start { session });
    assert_eq!(run(&mut host), first);
}

#[test]
fn the_line_report_counts_the_damage_of_the_run() {
    let mut host = Host::running(&[]);
    host.send_bytes(b"noise\0more noise\0");
    host.drive.note_overruns(3);
    host.sample(0, 0, 0);
    let answers = host.send(Stop {});
    // The good messages are the sample and the stop.
    let want = LineReport { messages: 2, damaged: 2, refused: 0, overruns: 3, device_time_us: Some(0) };
    assert_eq!(answers[0], DriveMessage::LineReport(want));
}
