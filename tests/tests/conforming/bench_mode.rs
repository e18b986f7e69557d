//! Wrong answers in bench mode fail: the drive in this process has a plant at its pins, and its messages are altered.

use std::fs;
use std::path::Path;

use lashloop_conformance::{CheckResult, CheckStatus};
use lashloop_protocol::enums::{FaultCode, Outcome, State, TorqueFlags};
use lashloop_protocol::message::{
    BenchSample, ChoiceDescription, CommandResult, EncoderSample, FaultReport, LineReport, Reference,
    Telemetry, TorqueAnswer,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, EncoderCounts, Message, Numbered};
use tests::battery::BenchMode;

use crate::altered::{Alteration, Altered};

fn with(alter: Alteration) -> BenchMode {
    let mut checks = BenchMode::default();
    checks.run("inproc", |drive| Box::new(Altered::over(drive, alter)));
    checks
}

fn frame(it: &Numbered<DriveMessage>, message: impl Into<DriveMessage>) -> Vec<u8> {
    message.into().numbered_frame(it.number).to_vec()
}

/// Reports altered by a function.
fn reports(it: &Numbered<DriveMessage>, alter: impl Fn(&mut BenchSample)) -> Vec<u8> {
    let mut message = it.message;
    if let DriveMessage::BenchSample(it) = &mut message {
        alter(it);
    }
    frame(it, message)
}

/// Fault reports altered by a function.
fn faults(it: &Numbered<DriveMessage>, alter: impl Fn(&mut FaultReport)) -> Vec<u8> {
    let mut message = it.message;
    if let DriveMessage::FaultReport(it) = &mut message {
        alter(it);
    }
    frame(it, message)
}

/// Line reports altered by a function.
fn lines(it: &Numbered<DriveMessage>, alter: impl Fn(&mut LineReport)) -> Vec<u8> {
    let mut message = it.message;
    if let DriveMessage::LineReport(it) = &mut message {
        alter(it);
    }
    frame(it, message)
}

/// Another code for faults of one.
fn as_code(it: &Numbered<DriveMessage>, code: FaultCode, other: FaultCode) -> Vec<u8> {
    faults(it, |it| {
        if it.code == code {
            it.code = other;
        }
    })
}

const NOTHING: Vec<u8> = Vec::new();

/// What a wrong drive sends instead of its messages.
const WRONG: &[(&str, Alteration)] = &[
    ("steps numbered from 1", |it, _| reports(it, |it| it.sequence = it.sequence.wrapping_add(1))),
    ("numbers of steps in 7 bits", |it, _| reports(it, |it| it.sequence &= 0x7f)),
    ("every second number only", |it, _| reports(it, |it| it.sequence *= 2)),
    ("no number of a reference", |it, _| reports(it, |it| it.reference_number = 0)),
    ("numbers of references in 8 bits", |it, _| reports(it, |it| it.reference_number &= 0xff)),
    ("the number of the next reference", |it, _| {
        reports(it, |it| it.reference_number = it.reference_number.wrapping_add(0x3b1d))
    }),
    ("a torque one bit off", |it, _| {
        reports(it, |it| it.torque_nm = f32::from_bits(it.torque_nm.to_bits() ^ 1))
    }),
    ("a torque of the wrong sign", |it, _| reports(it, |it| it.torque_nm = -it.torque_nm)),
    ("a torque that is not finite", |it, _| reports(it, |it| it.torque_nm = f32::NAN)),
    ("a torque beyond the limit", |it, _| reports(it, |it| it.torque_nm *= 1e6)),
    ("reports from Idle", |it, _| reports(it, |it| it.status.state = State::Idle)),
    ("reports in Running always", |it, _| reports(it, |it| it.status.state = State::Running)),
    ("a gap in every step", |it, _| reports(it, |it| it.status.flags |= TorqueFlags::GAP)),
    ("no SATURATED", |it, _| reports(it, |it| it.status.flags -= TorqueFlags::SATURATED)),
    ("SATURATED in every step", |it, _| reports(it, |it| it.status.flags |= TorqueFlags::SATURATED)),
    ("the counts of the other encoder", |it, _| {
        reports(it, |it| std::mem::swap(&mut it.motor_counts, &mut it.load_counts))
    }),
    ("a motor that counts backwards in its reports", |it, _| {
        reports(it, |it| it.motor_counts = EncoderCounts::wrapping(-i64::from(it.motor_counts.get())))
    }),
    ("a load that stands still in its reports", |it, _| {
        reports(it, |it| it.load_counts = EncoderCounts::default())
    }),
    ("a step that is late and raises no fault", |it, _| reports(it, |it| it.lateness_tenths_us = u16::MAX)),
    ("a step that takes long and raises no fault", |it, _| reports(it, |it| it.compute_tenths_us = u16::MAX)),
    ("reports lost now and then", |it, _| match &it.message {
        DriveMessage::BenchSample(sample) if sample.sequence % 5 == 3 => NOTHING,
        other => frame(it, *other),
    }),
    ("the first report lost", |it, _| match &it.message {
        DriveMessage::BenchSample(sample) if sample.sequence == 0 => NOTHING,
        other => frame(it, *other),
    }),
    ("the report of the step with the fault lost", |it, _| match &it.message {
        DriveMessage::BenchSample(sample) if sample.status.state == State::Faulted => NOTHING,
        other => frame(it, *other),
    }),
    ("a torque in the step with the fault", |it, _| {
        reports(it, |it| {
            if it.status.state == State::Faulted {
                it.torque_nm = 0.5;
            }
        })
    }),
    ("reports twice", |it, _| match &it.message {
        DriveMessage::BenchSample(sample) => [frame(it, *sample), frame(it, *sample)].concat(),
        other => frame(it, *other),
    }),
    ("a report after the fault", |it, _| match &it.message {
        DriveMessage::FaultReport(fault) => {
            let status =
                lashloop_protocol::enums::TorqueStatus { state: State::Faulted, flags: TorqueFlags::empty() };
            let late = BenchSample {
                sequence: fault.sequence.wrapping_add(1),
                motor_counts: EncoderCounts::default(),
                load_counts: EncoderCounts::default(),
                reference_number: 0,
                torque_nm: 0.0,
                status,
                compute_tenths_us: 0,
                lateness_tenths_us: 0,
            };
            [frame(it, *fault), frame(it, late)].concat()
        }
        other => frame(it, *other),
    }),
    ("no telemetry", |it, _| match &it.message {
        DriveMessage::Telemetry(_) => NOTHING,
        other => frame(it, *other),
    }),
    ("telemetry of the step before", |it, _| match &it.message {
        DriveMessage::Telemetry(telemetry) => {
            frame(it, Telemetry { sequence: telemetry.sequence.wrapping_sub(1), ..*telemetry })
        }
        other => frame(it, *other),
    }),
    ("a Reference that is answered", |it, _| match &it.message {
        DriveMessage::BenchSample(sample) if sample.sequence == 2 => {
            let result = CommandResult {
                request: Reference::LAYOUT.kind,
                outcome: Outcome::Accepted,
                state: State::Running,
                detail: 0,
                device_time_us: None,
            };
            [frame(it, *sample), frame(it, result)].concat()
        }
        other => frame(it, *other),
    }),
    ("a sample that is out of sequence", |it, _| match &it.message {
        DriveMessage::CommandResult(result) if result.request == EncoderSample::LAYOUT.kind => {
            frame(it, CommandResult { outcome: Outcome::OutOfSequence, ..*result })
        }
        other => frame(it, *other),
    }),
    ("a watchdog that is another fault", |it, _| as_code(it, FaultCode::Watchdog, FaultCode::TickOverrun)),
    ("a motor's jump as the load's", |it, _| {
        as_code(it, FaultCode::MotorEncoderJump, FaultCode::LoadEncoderJump)
    }),
    ("a load's jump as the motor's", |it, _| {
        as_code(it, FaultCode::LoadEncoderJump, FaultCode::MotorEncoderJump)
    }),
    ("a twist that is a jump", |it, _| as_code(it, FaultCode::LoadEncoderLost, FaultCode::LoadEncoderJump)),
    ("a reference as a torque that is not finite", |it, _| {
        as_code(it, FaultCode::ReferenceNotFinite, FaultCode::TorqueNotFinite)
    }),
    ("faults without a value", |it, _| faults(it, |it| it.value = 0.0)),
    ("faults without a limit", |it, _| faults(it, |it| it.limit = 0.0)),
    ("faults with a detail", |it, _| faults(it, |it| it.detail = 1)),
    ("faults of the step before", |it, _| faults(it, |it| it.sequence = it.sequence.wrapping_sub(1))),
    ("a load that is lost as a motor", |it, _| {
        as_code(it, FaultCode::LoadEncoderLost, FaultCode::MotorEncoderLost)
    }),
    ("twice the twist", |it, _| {
        faults(it, |it| {
            if it.code == FaultCode::LoadEncoderLost {
                it.value *= 2.0;
            }
        })
    }),
    ("an EmergencyStop with a torque", |it, _| {
        faults(it, |it| {
            if it.code == FaultCode::EmergencyStop {
                it.value = 0.5;
            }
        })
    }),
    ("references that are not counted", |it, _| lines(it, |it| it.messages = 0)),
    ("an overrun in every run", |it, _| lines(it, |it| it.overruns = 1)),
    ("no number 0", |it, _| reports(it, |it| it.reference_number = it.reference_number.max(1))),
    ("a torque in Idle", |it, _| match &it.message {
        DriveMessage::TorqueAnswer(answer) if answer.status.state == State::Idle => {
            frame(it, TorqueAnswer { torque_nm: 0.5, ..*answer })
        }
        other => frame(it, *other),
    }),
    ("no name of the report", |it, _| match &it.message {
        DriveMessage::ChoiceDescription(choice) if choice.choice == BenchSample::LAYOUT.kind => {
            frame(it, ChoiceDescription { name: Text::new(""), ..*choice })
        }
        other => frame(it, *other),
    }),
    ("no fault reports", |it, _| match &it.message {
        DriveMessage::FaultReport(_) => NOTHING,
        other => frame(it, *other),
    }),
];

#[test]
fn wrong_messages_of_bench_mode_fail() {
    let right = with(|it, _| frame(it, it.message));
    assert_eq!(right.not_passed(), Vec::<&CheckResult>::new());
    let failed = |it: &CheckResult| matches!(it.status, CheckStatus::Failed { .. });
    let borne: Vec<_> = WRONG
        .iter()
        .filter(|(_, alter)| !with(*alter).results.iter().any(failed))
        .map(|(what, _)| *what)
        .collect();
    let (count, found) = (WRONG.len(), WRONG.len() - borne.len());
    let line = format!("conformance: {found} of {count} wrong answers in bench mode found\n");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("reports");
    let written =
        fs::create_dir_all(&folder).and_then(|()| fs::write(folder.join("conformance-bench-mode.txt"), line));
    written.expect("a folder for reports");
    assert!(borne.is_empty(), "no check fails with {borne:#?}");
}
