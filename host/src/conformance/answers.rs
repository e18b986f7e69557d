//! The answers of a drive by kind, and the sample that most checks send.

use lashloop_protocol::enums::Outcome;
use lashloop_protocol::message::{EncoderSample, FaultReport, Identity, ParameterReport, TorqueAnswer};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, EncoderCounts};

use super::assertion::{Failure, find};

/// The mechanics at rest at zero, and the load wanted at 1 rad: any controller pushes.
pub(super) fn sample(sequence: u16) -> EncoderSample {
    let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
    EncoderSample { sequence, motor_counts, load_counts, reference_rad: 1.0 }
}

/// The identity among answers.
pub(super) fn identity(answers: &[DriveMessage]) -> Result<Identity, Failure> {
    find("an Identity", answers, |answer| match answer {
        DriveMessage::Identity(identity) => Some(*identity),
        _ => None,
    })
}

/// The torque among answers.
pub(super) fn torque(answers: &[DriveMessage]) -> Result<TorqueAnswer, Failure> {
    find("a TorqueAnswer", answers, |answer| match answer {
        DriveMessage::TorqueAnswer(answer) => Some(*answer),
        _ => None,
    })
}

/// The fault among answers.
pub(super) fn fault(answers: &[DriveMessage]) -> Result<FaultReport, Failure> {
    find("a FaultReport", answers, |answer| match answer {
        DriveMessage::FaultReport(fault) => Some(*fault),
        _ => None,
    })
}

/// What became of a request among answers to it.
pub(super) fn outcome<Request: Payload>(answers: &[DriveMessage]) -> Result<Outcome, Failure> {
    let what = format!("a CommandResult for {}", Request::LAYOUT.name);
    find(&what, answers, |answer| match answer {
        DriveMessage::CommandResult(result) if result.request == Request::LAYOUT.kind => Some(result.outcome),
        _ => None,
    })
}

/// The report of a parameter among answers.
pub(super) fn report(index: u8, answers: &[DriveMessage]) -> Result<ParameterReport, Failure> {
    find(&format!("a ParameterReport for index {index}"), answers, |answer| match answer {
        DriveMessage::ParameterReport(report) if report.index == index => Some(*report),
        _ => None,
    })
}
