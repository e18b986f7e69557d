//! The drive's parameters, as the drive describes them.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterType, ParameterValue};
use lashloop_protocol::message::DescribeParameter;

use super::error::SessionError;
use super::line::Line;

/// A parameter of the drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Index on the wire.
    pub index: u8,
    /// Name; its ending is the unit.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Value after power-up.
    pub default: ParameterValue,
    /// Smallest value accepted.
    pub min: ParameterValue,
    /// Largest value accepted.
    pub max: ParameterValue,
    /// Whether it may be set while the drive runs.
    pub live: bool,
}

impl Parameter {
    /// Range and unit as text, for example `0 to 1000 N m`.
    #[must_use]
    pub fn range(&self) -> String {
        let whole = if self.default.ty() == ParameterType::U32 { "a whole number, " } else { "" };
        format!("{whole}{} to {} {}", self.min, self.max, self.unit).trim_end().to_owned()
    }

    /// `number` as a value of this parameter's type; `None` outside its range.
    pub(super) fn value(&self, number: f64) -> Option<ParameterValue> {
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

/// Why a parameter can't be set.
#[derive(Debug, thiserror::Error)]
pub enum SetError {
    /// The drive has no such parameter.
    #[error("the drive has no such parameter; did you mean {nearest}? It has {known}")]
    Unknown {
        /// The most similar name.
        nearest: String,
        /// All names of the drive, separated by commas.
        known: String,
    },
    /// The value is outside the drive's range.
    #[error("the drive takes {range}")]
    OutOfRange {
        /// Range and unit as text.
        range: String,
    },
    /// The drive rejected the value or reads back another.
    #[error("the drive answered {outcome:?} and has {in_force} in force")]
    Refused {
        /// The drive's answer.
        outcome: Outcome,
        /// The value in force.
        in_force: ParameterValue,
    },
    /// The session failed.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// Reads the descriptions of all `count` parameters, in the order of their index.
///
/// # Errors
/// The drive is silent, or the line broke.
pub fn read_all(line: &mut Line, count: u8) -> Result<Vec<Parameter>, SessionError> {
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
