//! Reactions that several groups of checks require.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{FaultCode, Outcome, State, TorqueFlags};
use lashloop_protocol::message::{EncoderSample, FaultReport, TorqueAnswer};
use lashloop_protocol::wire::Payload;

use super::answers::{command_result, fault, hello, sample, torque};
use super::assertion::{Failure, RuleResult, equal, expect, names, preparation};
use super::client::Client;

/// Requires torque zero, this state and no flags, and nothing after it.
pub(super) fn no_torque(client: &mut Client, sequence: u16, state: State) -> RuleResult {
    let answers = client.request(sample(sequence))?;
    equal(&format!("to sample {sequence} in {state:?}"), vec!["TorqueAnswer"], names(&answers))?;
    let it = torque(&answers)?;
    let wanted = (sequence, 0.0, state, TorqueFlags::empty());
    let got = (it.sequence, it.torque_nm, it.status.state, it.status.flags);
    equal("sequence, torque in N m, state and flags", wanted, got)
}

/// Requires a control step as the only answer, with exactly these flags but for `SATURATED`.
pub(super) fn accepted(
    client: &mut Client,
    sample: EncoderSample,
    flags: TorqueFlags,
) -> Result<TorqueAnswer, Failure> {
    let answers = client.request_one(sample)?;
    let EncoderSample { sequence, motor_counts, load_counts, reference_rad } = sample;
    let (motor, load) = (motor_counts.get(), load_counts.get());
    let what =
        format!("to sample {sequence} (motor {motor}, load {load} counts, reference {reference_rad} rad)");
    equal(&what, vec!["TorqueAnswer"], names(&answers))?;
    let it = torque(&answers)?;
    let got = (it.sequence, it.status.state, it.status.flags - TorqueFlags::SATURATED);
    let expected = format!("{what} sequence, state and flags but SATURATED");
    equal(&expected, (sequence, State::Running, flags), got)?;
    expect(it.torque_nm.is_finite(), format!("{what} a finite torque in N m"), it.torque_nm)?;
    Ok(it)
}

/// Sends the first sample of a run, as a preparation.
pub(super) fn first_sample(client: &mut Client) -> Result<TorqueAnswer, Failure> {
    let first = accepted(client, sample(0), TorqueFlags::empty());
    preparation("the first EncoderSample", first)
}

pub(super) fn refused_sample(client: &mut Client, sequence: u16) -> RuleResult {
    refused(client, sample(sequence))
}

/// Requires the refusal of a stray sample, and that the run continues.
pub(super) fn refused(client: &mut Client, sample: EncoderSample) -> RuleResult {
    let sequence = sample.sequence;
    let answers = client.request_one(sample)?;
    equal(&format!("to sample {sequence}"), vec!["CommandResult"], names(&answers))?;
    let it = command_result(&EncoderSample::LAYOUT, &answers)?;
    let wanted = (Outcome::OutOfSequence, State::Running, 0);
    equal(
        &format!("to sample {sequence} outcome, state and detail"),
        wanted,
        (it.outcome, it.state, it.detail),
    )
}

/// Requires the answers to a sample that latches a fault: zero torque without flags, then the report.
pub(super) fn fault_answer(answers: &[DriveMessage], code: FaultCode) -> Result<FaultReport, Failure> {
    fault_answer_with(answers, code, TorqueFlags::empty())
}

/// As [`fault_answer`], for a sample whose answer has flags.
pub(super) fn fault_answer_with(
    answers: &[DriveMessage],
    code: FaultCode,
    flags: TorqueFlags,
) -> Result<FaultReport, Failure> {
    equal("answers", vec!["TorqueAnswer", "FaultReport"], names(answers))?;
    let (answer, it) = (torque(answers)?, fault(answers)?);
    let got = (answer.torque_nm, answer.status.state, answer.status.flags);
    equal("torque in N m, state and flags", (0.0, State::Faulted, flags), got)?;
    equal("code and detail", (code, 0), (it.code, it.detail))?;
    equal("sequence of the FaultReport", answer.sequence, it.sequence)?;
    Ok(it)
}

/// Requires two reports to be equal; a NaN equals any other.
pub(super) fn same_report(what: &str, wanted: FaultReport, got: FaultReport) -> RuleResult {
    let same = |one: f32, other: f32| one == other || (one.is_nan() && other.is_nan());
    let holds = (wanted.code, wanted.sequence, wanted.detail) == (got.code, got.sequence, got.detail)
        && same(wanted.value, got.value)
        && same(wanted.limit, got.limit);
    expect(holds, format!("{what} {}", super::words::Words::words(&wanted)), got)
}

/// Requires the report of a latched fault after the identity, in the present session.
pub(super) fn still_reported(client: &mut Client, wanted: FaultReport) -> RuleResult {
    reported_to(client, client.session, wanted)
}

/// As [`still_reported`], for any session.
pub(super) fn reported_to(client: &mut Client, session: u32, wanted: FaultReport) -> RuleResult {
    let answers = client.request(hello(session))?;
    equal("to Hello with a fault latched", vec!["Identity", "FaultReport"], names(&answers))?;
    same_report("after the Identity", wanted, fault(&answers)?)?;
    equal("state", State::Faulted, client.state)
}
