//! Bench mode: the drive's own encoders and power stage instead of the host's samples.

use std::collections::BTreeSet;
use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{Outcome, ParameterFlags, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{
    DescribeChoice, DescribeParameter, EncoderSample, GetParameter, Hello, Reference, Reset, Stop, Subscribe,
};

use crate::host::{HELLO, Host, SESSION, torque};
use crate::pin_host::{PERIOD, PinHost, index, table};

#[test]
fn a_drive_without_pins_offers_no_parameter_of_bench_mode() {
    let mut host = Host::idle();
    let identity = host.identity(HELLO);
    assert_eq!(usize::from(identity.parameter_count), Laws::PARAMETERS.len());
    let index = index("sample_source");
    assert_eq!(index, identity.parameter_count);
    let answers = host.send(GetParameter { index });
    assert!(
        matches!(answers[..], [DriveMessage::ParameterReport(it)] if it.outcome == Outcome::UnknownIndex),
        "{answers:?}"
    );
}

#[test]
fn a_drive_with_pins_describes_its_further_parameters() {
    let mut host = PinHost::idle();
    let identity = host.send(HELLO);
    assert!(
        matches!(identity[..], [DriveMessage::Identity(it)] if usize::from(it.parameter_count) == table().count())
    );
    let mut names = BTreeSet::new();
    for (entry, index) in table().zip(0..) {
        let answers = host.send(DescribeParameter { index });
        let [DriveMessage::ParameterDescription(it)] = answers[..] else { panic!("{answers:?}") };
        assert_eq!((it.index, it.name.as_str(), it.unit.as_str()), (index, entry.name, entry.unit));
        assert_eq!(it.flags.contains(ParameterFlags::CHOICES), entry.range.choices().is_some());
        assert_ne!(it.laws, 0, "{}", entry.name);
        assert!(names.insert(entry.name), "{} is unique", entry.name);
        if usize::from(index) >= Laws::PARAMETERS.len() {
            assert_eq!(it.laws, (1 << Laws::NAMES.len()) - 1, "{} is of all laws", entry.name);
        }
        for value in [entry.range.min(), entry.range.max(), entry.range.default()] {
            let report = host.set(entry.name, value);
            assert_eq!((report.outcome, report.value), (Outcome::Accepted, value), "{}", entry.name);
        }
        for (name, choice) in entry.range.choices().unwrap_or_default().iter().zip(0..) {
            let answers = host.send(DescribeChoice { parameter: index, choice });
            assert!(
                matches!(&answers[..], [DriveMessage::ChoiceDescription(it)] if it.name.as_str() == *name)
            );
        }
    }
    let after_the_last = names.len() as u8;
    let answers = host.send(DescribeParameter { index: after_the_last });
    assert!(
        matches!(answers[..], [DriveMessage::ParameterReport(it)] if it.outcome == Outcome::UnknownIndex)
    );
}

#[test]
fn reset_returns_to_hil_mode() {
    let mut host = PinHost::running(&[]);
    host.send(Reset {});
    host.send(HELLO);
    let index = index("sample_source");
    let answers = host.send(GetParameter { index });
    assert!(
        matches!(answers[..], [DriveMessage::ParameterReport(it)] if it.value == ParameterValue::U32(0)),
        "{answers:?}"
    );
}

/// Three times the default, so that load and motor have equal counts at no twist.
const LOAD_COUNTS_PER_REV: u32 = 393_216;

/// Counts of motor and load through the gap and across the wraparound of both encoders, forwards or backwards from 0, and
/// references near to them.
fn trajectory(is_backward: bool) -> impl Iterator<Item = (i64, i64, f32)> {
    let (mut motor, mut load, mut velocity) = (8_388_000_i64, 8_388_500_i64, 900_i64);
    (0..3000_u16).map(move |k| {
        velocity -= (motor - 8_390_000) / 900 + velocity / 200;
        motor += velocity / 16;
        load += (motor - load) / 1500;
        let reference_rad = 134.05 + f32::from(k % 1400) * 5e-4 - 0.3;
        if is_backward { (-motor, -load, -reference_rad) } else { (motor, load, reference_rad) }
    })
}

#[test]
fn the_same_counts_through_link_and_pins_give_the_same_torques() {
    let laws = 0..Laws::NAMES.len() as u32;
    for (law, is_backward) in laws.flat_map(|law| [(law, false), (law, true)]) {
        let settings = [
            ("controller", ParameterValue::U32(law)),
            ("load_counts_per_rev", ParameterValue::U32(LOAD_COUNTS_PER_REV)),
            // Within the limit at these references.
            ("torque_per_rad_nm", ParameterValue::F32(0.5)),
        ];
        let mut pins = PinHost::running(&settings);
        let mut link =
            Host::running(&[&settings[..], &[("torque_limit_nm", ParameterValue::F32(100.0))]].concat());
        let (mut torques, mut wrapped) = (BTreeSet::new(), 0);
        for ((motor, load, reference_rad), sequence) in trajectory(is_backward).zip(0..) {
            pins.refer(reference_rad);
            pins.turn(motor, load);
            let have = pins.step();
            let [motor_counts, load_counts] = [motor, load].map(EncoderCounts::wrapping);
            let sample = EncoderSample { sequence, motor_counts, load_counts, reference_rad };
            let want = torque(&link.send(sample));
            assert_eq!(have.torque_nm.to_bits(), want.torque_nm.to_bits(), "law {law}, step {sequence}");
            assert_eq!((have.sequence, have.status), (want.sequence, want.status));
            assert_eq!((have.motor_counts, have.load_counts), (motor_counts, load_counts));
            assert_eq!(pins.stage_nm(), Some(have.torque_nm));
            torques.insert(have.torque_nm.to_bits());
            let is_wrapped = |counts: EncoderCounts| (counts.get() < 0) != is_backward;
            wrapped |= u8::from(is_wrapped(motor_counts)) | u8::from(is_wrapped(load_counts)) << 1;
        }
        assert_eq!(wrapped, 0b11, "both encoders wrapped");
        assert!(torques.len() > 1000, "{} different torques", torques.len());
    }
}

/// Observers start from the torque that was, which is less than the commanded one where a supply is weak.
#[test]
fn a_law_gets_the_torque_that_was_measured() {
    let law = Laws::NAMES.iter().position(|name| *name == "braking-curve").expect("a law with observers");
    let torques = |measured: fn(f32) -> Option<f32>| {
        let mut host = PinHost::running(&[
            ("controller", ParameterValue::U32(law as u32)),
            ("load_counts_per_rev", ParameterValue::U32(LOAD_COUNTS_PER_REV)),
        ]);
        let steps = trajectory(false).take(500).map(|(motor, load, reference_rad)| {
            host.refer(reference_rad);
            host.turn(motor, load);
            let torque_nm = host.step().torque_nm;
            host.readings.torque_nm = measured(torque_nm);
            torque_nm.to_bits()
        });
        steps.collect::<Vec<_>>()
    };
    let commanded = torques(|_| None);
    assert_eq!(torques(Some), commanded);
    assert_ne!(torques(|commanded_nm| Some(0.5 * commanded_nm)), commanded);
}

#[test]
fn telemetry_of_a_step_follows_its_report() {
    let mut host = PinHost::running(&[]);
    host.send(Subscribe { signals: 0b1, every: 2 });
    host.refer(0.5);
    for sequence in 0..6 {
        match host.tick()[..] {
            [DriveMessage::BenchSample(sample), DriveMessage::Telemetry(telemetry)] => {
                assert_eq!((sample.sequence, telemetry.sequence, sequence % 2), (sequence, sequence, 0));
                assert_eq!(telemetry.values.as_slice(), [sample.torque_nm]);
            }
            [DriveMessage::BenchSample(sample)] => assert_eq!((sample.sequence, sequence % 2), (sequence, 1)),
            ref other => panic!("{other:?}"),
        }
    }
}

#[test]
fn every_nth_step_is_reported() {
    let mut host = PinHost::running(&[("bench_sample_every", ParameterValue::U32(4))]);
    host.refer(0.5);
    let reported: Vec<bool> = (0..12).map(|_| !host.tick().is_empty()).collect();
    let want: Vec<bool> = (0..12).map(|k| k % 4 == 0).collect();
    assert_eq!(reported, want);
}

#[test]
fn reports_stay_n_steps_apart_where_sequence_numbers_wrap() {
    // 5 does not divide 65,536.
    let mut host = PinHost::running(&[("bench_sample_every", ParameterValue::U32(5))]);
    host.refer(0.5);
    for step in 0..65_600_u32 {
        if step % 10 == 0 {
            // Before the watchdog.
            host.refer(0.5);
        }
        let reported = host.tick();
        assert_eq!(!reported.is_empty(), step % 5 == 0, "step {step}: {reported:?}");
    }
}

#[test]
fn a_report_has_the_number_of_the_reference_in_force() {
    let mut host = PinHost::running(&[]);
    host.send(Reference { number: 40_000, reference_rad: 0.1 });
    assert_eq!(host.step().reference_number, 40_000);
    assert_eq!(host.step().reference_number, 40_000, "the reference is held");
    host.send(Reference { number: 7, reference_rad: 0.2 });
    assert_eq!(host.step().reference_number, 7);
}

#[test]
fn no_step_is_made_before_the_first_reference() {
    let mut host = PinHost::running(&[]);
    for _ in 0..5 {
        assert_eq!(host.tick(), []);
        assert_eq!(host.stage_nm(), Some(0.0));
    }
    host.refer(0.0);
    assert_eq!(host.step().sequence, 0);
}

#[test]
fn the_stage_is_on_while_running_only() {
    let mut host = PinHost::with(&[]);
    assert_eq!(host.stage_nm(), None, "Idle");
    host.arm();
    assert_eq!(host.stage_nm(), None, "Armed");
    host.start();
    assert_eq!(host.stage_nm(), Some(0.0), "Running");
    host.send(Stop {});
    assert_eq!(host.stage_nm(), None, "stopped");
    let mut host = PinHost::running(&[]);
    host.send(Hello { session: SESSION + 1, ..HELLO });
    assert_eq!(host.stage_nm(), None, "another session");
    let mut host = PinHost::running(&[]);
    host.send(Reset {});
    assert_eq!(host.stage_nm(), None, "reset");
}

#[test]
fn a_run_in_hil_mode_leaves_the_stage_off() {
    let mut host = PinHost::idle();
    assert_eq!((host.arm().0, host.start().0), (Outcome::Accepted, Outcome::Accepted));
    let answer = torque(&host.send(EncoderSample { reference_rad: 1.0, ..crate::host::sample(0, 0, 0) }));
    assert_ne!(answer.torque_nm, 0.0);
    assert_eq!(host.stage_nm(), None);
    assert_eq!(host.tick(), [], "the tick makes no step");
    assert_eq!(host.drive.torque_nm(), answer.torque_nm);
}

#[test]
fn a_sample_of_the_other_mode_is_refused_and_changes_nothing() {
    let mut host = PinHost::under_torque();
    let before = host.stage_nm();
    assert_eq!(host.command(crate::host::sample(0, 5, 5)), (Outcome::WrongState, State::Running));
    assert_eq!(host.stage_nm(), before);
    assert_eq!(host.step().sequence, 1);

    let reference = Reference { number: 1, reference_rad: 1.0 };
    let mut hil = Host::running(&[]);
    hil.sample(0, 1000, 1000);
    let before = hil.drive.torque_nm();
    assert_eq!(hil.command(reference), (Outcome::WrongState, State::Running));
    assert_eq!(hil.drive.torque_nm(), before);
}

#[test]
fn a_reference_is_refused_unless_running() {
    let reference = Reference { number: 1, reference_rad: 1.0 };
    let mut host = PinHost::with(&[]);
    assert_eq!(host.command(reference), (Outcome::WrongState, State::Idle));
    host.arm();
    assert_eq!(host.command(reference), (Outcome::WrongState, State::Armed));
    host.send(Reset {});
    assert_eq!(host.command(reference), (Outcome::WrongState, State::Boot));
}

#[test]
fn torque_is_clamped_and_flagged_as_in_hil_mode() {
    for sign in [1.0, -1.0] {
        let mut host = PinHost::running(&[("torque_limit_nm", ParameterValue::F32(0.5))]);
        host.refer(sign);
        let sample = host.step();
        assert_eq!((sample.torque_nm, sample.status.flags), (sign * 0.5, TorqueFlags::SATURATED));
    }
}

#[test]
fn each_encoder_counts_in_its_own_direction() {
    for (motor, load) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let mut host = PinHost::running(&[
            ("motor_direction", ParameterValue::U32(motor)),
            ("load_direction", ParameterValue::U32(load)),
        ]);
        host.turn(300, -100);
        host.refer(0.0);
        let sample = host.step();
        let sign = |direction: u32| 1 - 2 * direction.cast_signed();
        let want = (300 * sign(motor), -100 * sign(load));
        assert_eq!((sample.motor_counts.get(), sample.load_counts.get()), want);
    }
}

#[test]
fn a_report_has_the_times_of_its_step() {
    let mut host = PinHost::running(&[]);
    host.refer(0.0);
    match host.tick_after(Duration::from_micros(37))[..] {
        [DriveMessage::BenchSample(it)] => {
            assert_eq!((it.lateness_tenths_us, it.compute_tenths_us), (370, 0));
        }
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn a_line_that_is_full_omits_reports_and_no_answer() {
    let mut host = PinHost::running(&[]);
    host.refer(0.5);
    for _ in 0..100 {
        host.clock.set(host.due);
        host.drive.sample(&host.readings, host.due, &host.clock);
        host.due += PERIOD;
        host.number += 1;
        // The references are taken while there is space for their answers; the watchdog needs one in 20 ms.
        if host.number.is_multiple_of(10) {
            let sent = host.take_output().len();
            assert!((1..=10).contains(&sent));
            host.refer(0.5);
        }
    }
    assert_eq!(host.drive.state(), State::Running);
}
