//! One mutant per broken rule, and the check that must fail.

mod description;
mod encoders;
mod foreign;
mod handshake;
mod line;
mod parameters;
mod profile_pd;
mod safety;
mod samples;
mod telemetry;
mod transitions;

use lashloop_protocol::message::{
    CommandResult, EncoderSample, ParameterDescription, ParameterReport, SetParameter, TorqueAnswer,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use crate::mutants::{Memory, Variant};
pub use foreign::{FINE, FIXED, FIXED_CREDULOUS, SLOW};

/// Every mutant, in the order of the checks.
pub fn all() -> impl Iterator<Item = Variant> {
    [
        handshake::VARIANTS,
        transitions::VARIANTS,
        description::VARIANTS,
        parameters::VARIANTS,
        samples::VARIANTS,
        telemetry::VARIANTS,
        encoders::VARIANTS,
        safety::VARIANTS,
        line::VARIANTS,
        profile_pd::VARIANTS,
    ]
    .into_iter()
    .flatten()
    .copied()
}

/// A mutant that changes requests.
const fn alters_requests(
    does: &'static str,
    caught_by: &'static str,
    on_request: fn(&mut Memory, HostMessage) -> Vec<HostMessage>,
) -> Variant {
    Variant { does, caught_by, on_request, ..Variant::UNCHANGED }
}

/// A mutant that changes answers.
const fn alters_answers(
    does: &'static str,
    caught_by: &'static str,
    on_answers: fn(&mut Memory, Vec<DriveMessage>) -> Vec<DriveMessage>,
) -> Variant {
    Variant { does, caught_by, on_answers, ..Variant::UNCHANGED }
}

fn each(mut answers: Vec<DriveMessage>, alter: impl FnMut(&mut DriveMessage)) -> Vec<DriveMessage> {
    answers.iter_mut().for_each(alter);
    answers
}

fn torques(answers: Vec<DriveMessage>, mut alter: impl FnMut(&mut TorqueAnswer)) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let DriveMessage::TorqueAnswer(it) = answer {
            alter(it);
        }
    })
}

fn describing(answers: Vec<DriveMessage>, alter: impl Fn(&mut ParameterDescription)) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let DriveMessage::ParameterDescription(it) = answer {
            alter(it);
        }
    })
}

/// Alters the reports that answer a set.
fn reporting(
    memory: &Memory,
    answers: Vec<DriveMessage>,
    alter: impl Fn(&mut ParameterReport, SetParameter),
) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let (DriveMessage::ParameterReport(it), Some(HostMessage::SetParameter(set))) =
            (answer, memory.request)
        {
            alter(it, set);
        }
    })
}

/// Puts a torque in place of the refusal of a sample.
fn answering(
    memory: &Memory,
    answers: Vec<DriveMessage>,
    torque: impl Fn(EncoderSample, CommandResult) -> Option<TorqueAnswer>,
) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let (DriveMessage::CommandResult(it), Some(HostMessage::EncoderSample(sample))) =
            (&*answer, memory.request)
            && let Some(torque) = torque(sample, *it)
        {
            *answer = torque.into();
        }
    })
}

fn is_result_of<Request: Payload>(answer: &DriveMessage) -> bool {
    matches!(answer, DriveMessage::CommandResult(it) if it.request == Request::LAYOUT.kind)
}
