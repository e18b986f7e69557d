//! Access to a parameter by its name.

use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::{GetParameter, ParameterReport, SetParameter};
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::client::Session;
use crate::error::SessionError;
use crate::names::UnknownName;
use crate::parameters::{Parameter, SetError, WrittenValue};

impl Session {
    /// The parameter of this name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// Checks a name and a value against the drive's description of its parameters. Nothing is sent.
    ///
    /// # Errors
    /// Unknown name or choice, or value outside the drive's range.
    pub fn fits<'a>(&self, name: &str, value: impl Into<WrittenValue<'a>>) -> Result<(), SetError> {
        self.on_wire(name, value.into()).map(drop)
    }

    /// Sets a parameter and checks the value read back.
    ///
    /// # Errors
    /// Unknown name or choice, value outside the drive's range, a rejection by the drive, or a failed session.
    pub fn set<'a>(&mut self, name: &str, value: impl Into<WrittenValue<'a>>) -> Result<(), SetError> {
        let (index, value) = self.on_wire(name, value.into())?;
        let report = self.report_of(index, &SetParameter { index, value }.into())?;
        if report.outcome == Outcome::Accepted && report.value == value {
            self.values_set.insert(index, value);
            Ok(())
        } else {
            let (outcome, in_force) = (report.outcome, report.value);
            let cause = match outcome {
                Outcome::Accepted => outcome.to_string(),
                _ => self.line.cause_of((&report).into(), &self.parameters, &self.signals),
            };
            Err(SetError::Refused { outcome, in_force, cause })
        }
    }

    /// The value in force since the last reset: as it was set and read back, else the default. Nothing is sent.
    #[must_use]
    pub fn in_force(&self, parameter: &Parameter) -> ParameterValue {
        self.values_set.get(&parameter.index).copied().unwrap_or(parameter.default)
    }

    /// Reads the value in force of the parameter with this index.
    ///
    /// # Errors
    /// The drive is silent, or the line broke.
    pub fn get(&mut self, index: u8) -> Result<ParameterValue, SessionError> {
        Ok(self.report_of(index, &GetParameter { index }.into())?.value)
    }

    /// Index and value on the wire.
    fn on_wire(&self, name: &str, value: WrittenValue<'_>) -> Result<(u8, ParameterValue), SetError> {
        let parameter = self.parameter(name).ok_or_else(|| {
            let known = self.parameters.iter().map(|parameter| &*parameter.name);
            SetError::Unknown(UnknownName::new("the drive", "parameter", name, known))
        })?;
        Ok((parameter.index, parameter.value(value)?))
    }

    fn report_of(&mut self, index: u8, request: &HostMessage) -> Result<ParameterReport, SessionError> {
        let layout = request.layout();
        let reported = self.line.request(request, |answer| match answer {
            DriveMessage::ParameterReport(report) if report.index == index => Some(Ok(*report)),
            DriveMessage::CommandResult(it) if it.request == layout.kind => Some(Err(it.into())),
            _ => None,
        })?;
        reported.with.map_err(|reply| self.line.refused(layout.name, reply, &self.parameters, &self.signals))
    }
}
