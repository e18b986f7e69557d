//! Reactions that several groups of checks require.

use super::answers::{command_result, fault, hello, sample, torque};
use super::assertion::{Failure, RuleResult, equal, expect, names, of_kinds, preparation};
use super::client::Client;
use super::words::Words;
use crate::prelude::wire::*;

/// Requires torque zero, this state and no flags, and nothing after it.
pub(super) fn no_torque(client: &mut Client, sequence: u16, state: State) -> RuleResult {
    no_torque_to(client, sample(sequence), state)
}

/// As [`no_torque`], for any sample.
pub(super) fn no_torque_to(client: &mut Client, sample: EncoderSample, state: State) -> RuleResult {
    let what = format!("to sample {} in {state:?}", sample.sequence);
    zero_torque(sample.sequence, state, &of_kinds(&what, &["TorqueAnswer"], client.request(sample)?)?)
}

/// Requires torque zero, this state and no flags.
pub(super) fn zero_torque(sequence: u16, state: State, answers: &[DriveMessage]) -> RuleResult {
    let it = torque(answers)?;
    let got = (it.sequence, it.torque_nm, it.status.state, it.status.flags);
    equal("sequence, torque in N m, state and flags", (sequence, 0.0, state, NONE), got)
}

/// Requires a control step as the only answer, with exactly these flags but for `SATURATED`.
pub(super) fn accepted(
    client: &mut Client,
    sample: EncoderSample,
    flags: TorqueFlags,
) -> Result<TorqueAnswer, Failure> {
    let EncoderSample { sequence, motor_counts, load_counts, reference_rad } = sample;
    let (motor, load) = (motor_counts.get(), load_counts.get());
    let what =
        format!("to sample {sequence} (motor {motor}, load {load} counts, reference {reference_rad} rad)");
    let it = torque(&of_kinds(&what, &["TorqueAnswer"], client.request_one(sample)?)?)?;
    let got = (it.sequence, it.status.state, it.status.flags - TorqueFlags::SATURATED);
    let expected = format!("{what} sequence, state and flags but SATURATED");
    equal(&expected, (sequence, Running, flags), got)?;
    expect(it.torque_nm.is_finite(), format!("{what} a finite torque in N m"), it.torque_nm)?;
    Ok(it)
}

/// Sends the first sample of a run, as a preparation.
pub(super) fn first_sample(client: &mut Client) -> Result<TorqueAnswer, Failure> {
    let first = accepted(client, sample(0), NONE);
    preparation("the first EncoderSample", first)
}

pub(super) fn refused_sample(client: &mut Client, sequence: u16) -> RuleResult {
    refused(client, sample(sequence))
}

/// Requires the refusal of a stray sample, and that the run continues.
pub(super) fn refused(client: &mut Client, sample: EncoderSample) -> RuleResult {
    let sequence = sample.sequence;
    let what = format!("to sample {sequence}");
    let answers = of_kinds(&what, &["CommandResult"], client.request_one(sample)?)?;
    let it = command_result(&EncoderSample::LAYOUT, &answers)?;
    let wanted = (OutOfSequence, Running, 0);
    equal(
        &format!("to sample {sequence} outcome, state and detail"),
        wanted,
        (it.outcome, it.state, it.detail),
    )
}

/// Requires the answers to a sample that latches a fault: zero torque without flags, then the report.
pub(super) fn fault_answer(answers: &[DriveMessage], code: FaultCode) -> Result<FaultReport, Failure> {
    fault_answer_with(answers, code, NONE)
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
    equal("torque in N m, state and flags", (0.0, Faulted, flags), got)?;
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
    expect(holds, format!("{what} {}", wanted.words()), got)
}

/// Requires the report of a latched fault after the identity, in the present session.
pub(super) fn still_reported(client: &mut Client, wanted: FaultReport) -> RuleResult {
    reported_to(client, client.session, wanted)
}

/// As [`still_reported`], for any session.
pub(super) fn reported_to(client: &mut Client, session: u32, wanted: FaultReport) -> RuleResult {
    let kinds = ["Identity", "FaultReport"];
    let answers = of_kinds("to Hello with a fault latched", &kinds, client.request(hello(session))?)?;
    same_report("after the Identity", wanted, fault(&answers)?)?;
    equal("state", Faulted, client.state)
}
