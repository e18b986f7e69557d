//! The requests that most checks send, and the answers of a drive by kind.

use lashloop_protocol::TelemetryValues;
use lashloop_protocol::layout::MessageLayout;

use super::assertion::{Failure, find};
use crate::prelude::wire::*;

pub(super) const fn hello(session: u32) -> Hello {
    Hello::new(session)
}

/// A `Hello` of the next version.
pub(super) fn other(session: u32) -> HostMessage {
    of_version(PROTOCOL_VERSION.wrapping_add(1), session).into()
}

pub(super) const fn of_version(protocol_version: u8, session: u32) -> Hello {
    Hello { protocol_version, ..Hello::new(session) }
}

/// What a receiver without overruns reports.
pub(super) const fn counted(messages: u32, damaged: u32, refused: u32) -> LineReport {
    LineReport { messages, damaged, refused, overruns: 0, device_time_us: None }
}

/// The report of a fault without limit and detail.
pub(super) const fn latched(code: FaultCode, sequence: u16, value: f32) -> FaultReport {
    FaultReport { code, sequence, value, limit: 0.0, detail: 0, device_time_us: None }
}

/// Mechanics at rest at zero and a reference of 1 rad: every control law requests a torque.
pub(super) fn sample(sequence: u16) -> EncoderSample {
    let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
    EncoderSample { sequence, motor_counts, load_counts, reference_rad: 1.0 }
}

/// A message as one of this kind, if it is one.
pub(super) fn of<T: for<'a> TryFrom<&'a DriveMessage>>(message: &DriveMessage) -> Option<T> {
    T::try_from(message).ok()
}

/// Whether a message is of this kind.
pub(super) fn is<T: for<'a> TryFrom<&'a DriveMessage>>(message: &DriveMessage) -> bool {
    of::<T>(message).is_some()
}

/// Declares a function that finds the first answer of a kind.
macro_rules! finders {
    ($($name:ident: $kind:ident as $what:literal,)+) => {
        $(pub(super) fn $name(answers: &[DriveMessage]) -> Result<$kind, Failure> {
            find($what, answers, of)
        })+
    };
}

finders! {
    identity: Identity as "an Identity",
    torque: TorqueAnswer as "a TorqueAnswer",
    fault: FaultReport as "a FaultReport",
    line_report: LineReport as "a LineReport",
    telemetry: Telemetry as "a Telemetry",
}

/// The `CommandResult` of a request.
pub(super) fn command_result(
    request: &MessageLayout,
    answers: &[DriveMessage],
) -> Result<CommandResult, Failure> {
    let wanted = |answer: &_| of::<CommandResult>(answer).filter(|it| it.request == request.kind);
    find(&format!("a CommandResult for {}", request.name), answers, wanted)
}

pub(super) fn outcome<Request: Payload>(answers: &[DriveMessage]) -> Result<Outcome, Failure> {
    command_result(&Request::LAYOUT, answers).map(|result| result.outcome)
}

pub(super) fn report(index: u8, answers: &[DriveMessage]) -> Result<ParameterReport, Failure> {
    let wanted = |answer: &_| of::<ParameterReport>(answer).filter(|it| it.index == index);
    find(&format!("a ParameterReport for index {index}"), answers, wanted)
}

/// Clears what differs between two equal answers: times, counts and signals.
pub(super) fn forget_time(answer: &mut DriveMessage) {
    match answer {
        DriveMessage::TorqueAnswer(it) => it.compute_tenths_us = 0,
        // Equal samples need not have equal signals.
        DriveMessage::Telemetry(it) => {
            let zeros = [0.0; MAX_TELEMETRY_VALUES];
            it.values = TelemetryValues::new(&zeros[..it.values.as_slice().len()]).unwrap_or(it.values);
        }
        DriveMessage::LineReport(it) => *it = counted(0, 0, 0),
        _ => {}
    }
}
