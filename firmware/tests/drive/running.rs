//! The control path.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{ParameterValue, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::LineReport;

use crate::host::{Host, torque};

/// Quarter of a turn on the load with the reducer in line, in counts of the default encoders.
const MOTOR: i64 = 3 * 32_768;
const LOAD: i64 = 32_768;

fn running(flags: TorqueFlags) -> TorqueStatus {
    TorqueStatus { state: State::Running, flags }
}

#[test]
fn pd_gives_the_paper_s_torque_for_a_position_error() {
    // e_s = pi/2, z = 0: theta_e_d = -10 e_s, U = -(theta_e - theta_e_d) = -(3 pi/2 + 10 pi/2).
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(100.0))]);
    let answer = torque(&host.sample(0, MOTOR, LOAD));
    let want = -13.0 * std::f32::consts::FRAC_PI_2;
    // The middle of a count is half a count, 2.4e-5 rad, off, thirteenfold.
    assert!((answer.torque_nm - want).abs() < 1e-3, "have {}, want {want}", answer.torque_nm);
    assert_eq!((answer.sequence, answer.status), (0, running(TorqueFlags::empty())));
    assert_eq!(host.drive.torque_nm(), answer.torque_nm);
}

#[test]
fn torque_is_limited_and_flagged() {
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(5.0))]);
    let answer = torque(&host.sample(0, MOTOR, LOAD));
    assert_eq!((answer.torque_nm, answer.status), (-5.0, running(TorqueFlags::SATURATED)));
}

#[test]
fn a_repeated_sample_gets_the_same_answer_and_makes_no_step() {
    let merzouki = [("controller", ParameterValue::U32(2)), ("torque_limit_nm", ParameterValue::F32(100.0))];
    let (mut once, mut twice) = (Host::running(&merzouki), Host::running(&merzouki));
    let first = torque(&once.sample(0, MOTOR, LOAD));
    twice.sample(0, MOTOR, LOAD);
    let again = torque(&twice.sample(0, MOTOR, LOAD));
    assert_eq!((again.torque_nm, again.status), (first.torque_nm, running(TorqueFlags::REPEATED)));
    // A step more would have moved the estimate and the filters.
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
fn a_sample_of_another_run_is_refused_and_moves_nothing() {
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
    let torques: Vec<f32> = (1..=3)
        .map(|law| {
            let limit = ("torque_limit_nm", ParameterValue::F32(100.0));
            let mut host = Host::running(&[("controller", ParameterValue::U32(law)), limit]);
            host.sample(0, MOTOR + 20_000, LOAD);
            torque(&host.sample(1, MOTOR + 20_500, LOAD)).torque_nm
        })
        .collect();
    assert!(torques[0] != torques[1] && torques[1] != torques[2] && torques[0] != torques[2], "{torques:?}");
}

#[test]
fn telemetry_comes_every_n_th_step_after_its_torque() {
    let mut host = Host::running(&[("telemetry_every", ParameterValue::U32(3))]);
    for sequence in 0..7 {
        let answers = host.sample(sequence, MOTOR, LOAD);
        let telemetry: Vec<u16> = answers
            .iter()
            .filter_map(|answer| match answer {
                DriveMessage::Telemetry(telemetry) => Some(telemetry.sequence),
                _ => None,
            })
            .collect();
        let want: &[u16] = if sequence % 3 == 0 { &[sequence] } else { &[] };
        assert_eq!(telemetry, want);
    }
}

#[test]
fn a_new_run_starts_from_the_initial_state() {
    use lashloop_protocol::message::{Arm, Start, Stop};
    let merzouki = [("controller", ParameterValue::U32(2)), ("torque_limit_nm", ParameterValue::F32(100.0))];
    let mut host = Host::running(&merzouki);
    let run = |host: &mut Host| -> Vec<u32> {
        (0..50)
            .map(|k| torque(&host.sample(k, MOTOR - 300 * i64::from(k), LOAD)).torque_nm.to_bits())
            .collect()
    };
    let first = run(&mut host);
    host.say(Stop {});
    let session = crate::host::SESSION;
    host.say(Arm { session });
    host.say(Start { session });
    assert_eq!(run(&mut host), first);
}

#[test]
fn after_a_run_on_a_noisy_line_the_drive_tells_of_the_damage() {
    let mut host = Host::running(&[]);
    host.send(b"noise\0more noise\0");
    host.drive.note_overruns(3);
    host.sample(0, 0, 0);
    let answers = host.say(lashloop_protocol::message::Stop {});
    // The sample and the stop itself are the good ones.
    let want = LineReport { messages: 2, damaged: 2, refused: 0, overruns: 3 };
    assert_eq!(answers[0], DriveMessage::LineReport(want));
}
