//! Requests by name, for the checks and their preparation.

use super::answers::{command_result, hello, identity, is, report, sample, torque};
use super::assertion::{Failure, RuleResult, broken, equal, preparation};
use super::client::Client;
use super::range::in_type_of;
use super::words::Words;
use crate::prelude::wire::*;

impl Client {
    /// Sends a request that is answered by a `CommandResult`, and returns its outcome and state.
    pub(super) fn command(&mut self, command: impl Into<HostMessage>) -> Result<(Outcome, State), Failure> {
        let command = command.into();
        let kind = command.layout().kind;
        let answers = if kind == Start::LAYOUT.kind {
            // The receiver's counts of a run start with the marker, in every check.
            self.request(command)?
        } else {
            self.request_until(
                command,
                |answer| matches!(answer, DriveMessage::CommandResult(it) if it.request == kind),
            )?
        };
        command_result(command.layout(), &answers).map(|result| (result.outcome, result.state))
    }

    pub(super) fn handshake(&mut self, session: u32) -> Result<Identity, Failure> {
        let request = hello(session);
        if self.state == Faulted {
            return identity(&self.request(request)?);
        }
        identity(&self.request_until(request, is::<Identity>)?)
    }

    pub(super) fn parameter(&self, name: &str) -> Result<&Parameter, Failure> {
        let found = self.description.parameters.iter().find(|parameter| parameter.name == name);
        let found = found.ok_or_else(|| broken(format!("a parameter {name}"), "a drive without it"));
        preparation(format!("a parameter {name}"), found)
    }

    /// Index of the signal that is the request of the law, if the drive has it.
    pub(super) fn requested_torque(&self) -> Option<u8> {
        let signals = &self.description.signals;
        signals.iter().find(|it| it.signal.name == "requested_torque_nm").map(|it| it.index)
    }

    /// Index of the law in force after a reset.
    pub(super) fn default_law(&self) -> u8 {
        match self.parameter(CONTROLLER).map(|it| it.default) {
            Ok(U32(index)) => index as u8,
            _ => 0,
        }
    }

    /// Sets a parameter, as a preparation. An integer is sent in the parameter's own type: the page allows `F32` for numbers
    /// with a reserved name.
    pub(super) fn put(&mut self, name: &str, value: ParameterValue) -> RuleResult {
        let parameter = self.parameter(name)?;
        let index = parameter.index;
        let value = in_type_of(parameter, value);
        let set = self.set(index, value).and_then(|report| {
            equal(&format!("{name} = {value}:"), (Accepted, value), (report.outcome, report.value))
        });
        preparation(format!("SetParameter {name}"), set)
    }

    /// Puts a law in force; a drive with one law may have no parameter for it.
    pub(super) fn put_law(&mut self, law: u8) -> RuleResult {
        let is_needed = self.description.laws.len() > 1 || self.parameter(CONTROLLER).is_ok();
        if is_needed { self.put(CONTROLLER, U32(law.into())) } else { Ok(()) }
    }

    /// As [`Self::put`], for several parameters.
    pub(super) fn put_all(&mut self, settings: &[(&str, ParameterValue)]) -> RuleResult {
        settings.iter().try_for_each(|(name, value)| self.put(name, *value))
    }

    pub(super) fn set(&mut self, index: u8, value: ParameterValue) -> Result<ParameterReport, Failure> {
        report(index, &self.request_until(SetParameter { index, value }, reports(index))?)
    }

    pub(super) fn get(&mut self, index: u8) -> Result<ParameterReport, Failure> {
        report(index, &self.request_until(GetParameter { index }, reports(index))?)
    }

    /// The value of a real parameter, as a preparation.
    pub(super) fn real(&mut self, name: &str) -> Result<f32, Failure> {
        let index = self.parameter(name)?.index;
        let value = self.get(index).and_then(|report| match report.value {
            F32(value) => Ok(value),
            value => Err(broken(format!("{name} of type F32"), value.ty().words())),
        });
        preparation(format!("GetParameter {name}"), value)
    }

    /// Sends a sample with the mechanics at rest at zero, and returns all answers.
    pub(super) fn sample(&mut self, sequence: u16) -> Result<Vec<DriveMessage>, Failure> {
        self.request(sample(sequence))
    }

    /// Sends the sample of [`Self::sample`] and returns its torque.
    pub(super) fn torque(&mut self, sequence: u16) -> Result<TorqueAnswer, Failure> {
        torque(&self.request_to(sample(sequence), TorqueAnswer::LAYOUT.name)?)
    }
}

/// Whether an answer is the report of a parameter.
fn reports(index: u8) -> impl Fn(&DriveMessage) -> bool {
    move |answer| matches!(answer, DriveMessage::ParameterReport(it) if it.index == index)
}
