//! Reactions that several groups of checks require.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{FaultCode, Outcome, State};
use lashloop_protocol::message::{EncoderSample, FaultReport};

use super::answers::{fault, outcome, torque};
use super::assertion::{Failure, RuleResult, equal, expect, names};
use super::client::Client;

pub(super) fn no_torque(client: &mut Client, sequence: u16, state: State) -> RuleResult {
    let answer = client.torque(sequence)?;
    equal("torque and state", (0.0, state), (answer.torque_nm, answer.status.state))
}

pub(super) fn refused_sample(client: &mut Client, sequence: u16) -> RuleResult {
    let answers = client.sample(sequence)?;
    equal(&format!("to sample {sequence}"), vec!["CommandResult"], names(&answers))?;
    equal("outcome", Outcome::OutOfSequence, outcome::<EncoderSample>(&answers)?)?;
    equal("state", State::Running, client.state)
}

/// Requires the answers to a sample that latches a fault: zero torque, then the report.
pub(super) fn fault_answer(answers: &[DriveMessage], code: FaultCode) -> Result<FaultReport, Failure> {
    equal("answers", vec!["TorqueAnswer", "FaultReport"], names(answers))?;
    let answer = torque(answers)?;
    equal("torque and state", (0.0, State::Faulted), (answer.torque_nm, answer.status.state))?;
    let it = fault(answers)?;
    equal("code", code, it.code)?;
    Ok(it)
}

/// Requires a `CommandResult` as the only answer, after at least one `Log` that explains it. A log may take several lines.
pub(super) fn require_log_before_result(what: &str, answers: &[DriveMessage]) -> RuleResult {
    let got = names(answers);
    let is_explained = match got.split_first() {
        Some((&"Log", rest)) => rest.iter().filter(|name| **name != "Log").eq([&"CommandResult"]),
        _ => false,
    };
    expect(is_explained, format!("{what} Log and then CommandResult"), got)
}
