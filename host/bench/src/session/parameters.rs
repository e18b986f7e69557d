//! The drive's parameters, as the drive describes them.

use lashloop_protocol::enums::{Outcome, ParameterType, ParameterValue};
use lashloop_protocol::message::{DescribeParameter, GetParameter, ParameterReport, SetParameter};
use lashloop_protocol::{DriveMessage, HostMessage};

use super::line::Line;
use super::{Session, SessionError};

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Index on the wire.
    pub index: u8,
    /// Name, with the unit at its end.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Value after power-up.
    pub default: ParameterValue,
    /// Smallest value taken.
    pub min: ParameterValue,
    /// Largest value taken.
    pub max: ParameterValue,
    /// Whether it may be set while running.
    pub live: bool,
}

impl Parameter {
    /// Range and unit in words.
    #[must_use]
    pub fn range(&self) -> String {
        let whole = if self.default.ty() == ParameterType::U32 { "a whole number, " } else { "" };
        format!("{whole}{} to {} {}", self.min, self.max, self.unit).trim_end().to_owned()
    }

    /// A number as this parameter's type, if it is in range.
    fn value(&self, number: f64) -> Option<ParameterValue> {
        match (self.min, self.max) {
            (ParameterValue::U32(min), ParameterValue::U32(max)) => {
                let whole = number.fract() == 0.0 && (f64::from(min)..=f64::from(max)).contains(&number);
                whole.then_some(ParameterValue::U32(number as u32))
            }
            (ParameterValue::F32(min), ParameterValue::F32(max)) => {
                let number = number as f32;
                (min..=max).contains(&number).then_some(ParameterValue::F32(number))
            }
            _ => None,
        }
    }
}

/// Why a parameter could not be set.
#[derive(Debug, thiserror::Error)]
pub enum SetError {
    /// The drive has no such parameter.
    #[error("the drive has no such parameter; did you mean {nearest}? It has {known}")]
    Unknown {
        /// The name most like it.
        nearest: String,
        /// The names it has.
        known: String,
    },
    /// The value is not in the range that the drive gave.
    #[error("the drive takes {range}")]
    OutOfRange {
        /// Range and unit in words.
        range: String,
    },
    /// The drive refused, or reads back something else.
    #[error("the drive answered {outcome:?} and has {in_force} in force")]
    Refused {
        /// What it said.
        outcome: Outcome,
        /// What is in force.
        in_force: ParameterValue,
    },
    /// The conversation broke.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// Asks the drive for all its parameters.
pub fn learn(line: &mut Line, count: u8) -> Result<Vec<Parameter>, SessionError> {
    (0..count)
        .map(|index| {
            let described = line.request(&DescribeParameter { index }.into(), |answer| match answer {
                DriveMessage::ParameterDescription(it) if it.index == index => Some(Parameter {
                    index,
                    name: it.name.as_str().to_owned(),
                    unit: it.unit.as_str().to_owned(),
                    default: it.default,
                    min: it.min,
                    max: it.max,
                    live: it.live == 1,
                }),
                _ => None,
            });
            described.map(|answered| answered.with)
        })
        .collect()
}

impl Session {
    /// The drive's parameters, in the order of their index.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The parameter of this name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// Whether the drive has a parameter of this name and takes this number, by what it says of itself.
    ///
    /// # Errors
    /// Unknown name, or value out of the drive's range.
    pub fn fits(&self, name: &str, number: f64) -> Result<(), SetError> {
        self.placed(name, number).map(drop)
    }

    /// Sets a parameter and checks what is read back.
    ///
    /// # Errors
    /// Unknown name, value out of the drive's range, a drive that refuses, or a broken conversation.
    pub fn set(&mut self, name: &str, number: f64) -> Result<(), SetError> {
        let (index, value) = self.placed(name, number)?;
        let report = self.report_of(index, &SetParameter { index, value }.into())?;
        if report.outcome == Outcome::Accepted && report.value == value {
            Ok(())
        } else {
            Err(SetError::Refused { outcome: report.outcome, in_force: report.value })
        }
    }

    /// The value in force of the parameter with this index.
    ///
    /// # Errors
    /// The conversation broke.
    pub fn get(&mut self, index: u8) -> Result<ParameterValue, SessionError> {
        Ok(self.report_of(index, &GetParameter { index }.into())?.value)
    }

    /// Index and value on the wire.
    fn placed(&self, name: &str, number: f64) -> Result<(u8, ParameterValue), SetError> {
        let parameter = self.parameter(name).ok_or_else(|| self.unknown(name))?;
        let value =
            parameter.value(number).ok_or_else(|| SetError::OutOfRange { range: parameter.range() })?;
        Ok((parameter.index, value))
    }

    fn unknown(&self, name: &str) -> SetError {
        let known: Vec<_> = self.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let likeness = |known: &&&str| strsim::jaro_winkler(known, name);
        let nearest = known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).copied();
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
