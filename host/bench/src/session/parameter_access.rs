//! Access to a parameter by its name.

use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::{GetParameter, ParameterReport, SetParameter};
use lashloop_protocol::{DriveMessage, HostMessage};

use super::client::Session;
use super::error::SessionError;
use super::parameters::{Parameter, SetError};

impl Session {
    /// The parameter of this name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// Checks a name and a value against the drive's description of its parameters. Nothing is sent.
    ///
    /// # Errors
    /// Unknown name, or value outside the drive's range.
    pub fn fits(&self, name: &str, number: f64) -> Result<(), SetError> {
        self.on_wire(name, number).map(drop)
    }

    /// Sets a parameter and checks the value read back.
    ///
    /// # Errors
    /// Unknown name, value outside the drive's range, a rejection by the drive, or a failed session.
    pub fn set(&mut self, name: &str, number: f64) -> Result<(), SetError> {
        let (index, value) = self.on_wire(name, number)?;
        let report = self.report_of(index, &SetParameter { index, value }.into())?;
        if report.outcome == Outcome::Accepted && report.value == value {
            Ok(())
        } else {
            Err(SetError::Refused { outcome: report.outcome, in_force: report.value })
        }
    }

    /// Reads the value in force of the parameter with this index.
    ///
    /// # Errors
    /// The drive is silent, or the line broke.
    pub fn get(&mut self, index: u8) -> Result<ParameterValue, SessionError> {
        Ok(self.report_of(index, &GetParameter { index }.into())?.value)
    }

    /// Index and value on the wire.
    fn on_wire(&self, name: &str, number: f64) -> Result<(u8, ParameterValue), SetError> {
        let parameter = self.parameter(name).ok_or_else(|| self.unknown(name))?;
        let value =
            parameter.value(number).ok_or_else(|| SetError::OutOfRange { range: parameter.range() })?;
        Ok((parameter.index, value))
    }

    fn unknown(&self, name: &str) -> SetError {
        let known: Vec<_> = self.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let similarity = |known: &&&str| strsim::jaro_winkler(known, name);
        let nearest = known.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b))).copied();
        SetError::Unknown { nearest: nearest.unwrap_or_default().to_owned(), known: known.join(", ") }
    }

    fn report_of(&mut self, index: u8, request: &HostMessage) -> Result<ParameterReport, SessionError> {
        let reported = self.line.request(request, |answer| match answer {
            DriveMessage::ParameterReport(report) if report.index == index => Some(*report),
            _ => None,
        });
        reported.map(|answered| answered.with)
    }
}
