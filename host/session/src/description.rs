//! What a drive describes of itself: laws, parameters with their choices, signals.

use std::ops::RangeInclusive;

use lashloop_plant::Signal;
use lashloop_protocol::enums::{ParameterFlags, ParameterValue};
use lashloop_protocol::limits::{MAX_LAWS, MAX_PARAMETERS, MAX_SIGNALS};
use lashloop_protocol::message::{DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, Identity};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use crate::error::SessionError;
use crate::laws::{Law, LawMask};
use crate::line::Line;
use crate::parameters::{Choice, Parameter};
use crate::refusal::Reply;
use crate::signals::DriveSignal;
use crate::text::printable;

/// A drive's description of itself. Each list is in the order of the index.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// The laws.
    pub laws: Vec<Law>,
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// The signals.
    pub signals: Vec<DriveSignal>,
}

impl Description {
    /// Requests everything that `identity` announces.
    ///
    /// # Errors
    /// The drive is silent, announces impossible numbers of laws, signals or parameters, rejects an index that it announced or
    /// describes impossible choices, or the line broke.
    pub fn read(line: &mut Line, identity: &Identity) -> Result<Self, SessionError> {
        if let Some(defect) = impossible_counts(identity).next() {
            return Err(defect);
        }
        let mut defects = Vec::new();
        let description = Self::read_possible(line, identity, &mut defects)?;
        defects.into_iter().next().map_or(Ok(description), Err)
    }

    /// Requests what a drive can have of everything that `identity` announces, for a bench that reports every defect of a
    /// description. A list ends before the first index that the drive rejects. A parameter with impossible choices has none.
    ///
    /// # Errors
    /// The drive is silent, or the line broke. Everything else is a defect, in the order of the requests.
    pub fn read_with_defects(
        line: &mut Line,
        identity: &Identity,
    ) -> Result<(Self, Vec<SessionError>), SessionError> {
        let mut defects: Vec<_> = impossible_counts(identity).collect();
        let description = Self::read_possible(line, identity, &mut defects)?;
        Ok((description, defects))
    }

    fn read_possible(
        line: &mut Line,
        identity: &Identity,
        defects: &mut Vec<SessionError>,
    ) -> Result<Self, SessionError> {
        let law_count = identity.law_count;
        let laws = 0..law_count.min(MAX_LAWS as u8);
        let laws = list(laws, defects, |index, _| law(line, index))?;
        let parameters = 0..identity.parameter_count.min(MAX_PARAMETERS as u8);
        let parameters =
            list(parameters, defects, |index, defects| parameter(line, index, law_count, defects))?;
        let signals = 0..identity.signal_count.min(MAX_SIGNALS as u8);
        let signals = list(signals, defects, |index, _| signal(line, index, law_count))?;
        Ok(Self { laws, parameters, signals })
    }
}

fn impossible_counts(identity: &Identity) -> impl Iterator<Item = SessionError> + use<> {
    let counts = [
        ("law_count", identity.law_count, 1..=MAX_LAWS),
        ("signal_count", identity.signal_count, 0..=MAX_SIGNALS),
        ("parameter_count", identity.parameter_count, 0..=MAX_PARAMETERS),
    ];
    counts.into_iter().filter(|(_, count, allowed)| !allowed.contains(&usize::from(*count))).map(
        |(field, count, allowed)| SessionError::Count {
            field,
            count,
            least: *allowed.start(),
            most: *allowed.end(),
        },
    )
}

/// The descriptions of these indices, up to the first that the drive rejects.
fn list<T>(
    indices: impl Iterator<Item = u8>,
    defects: &mut Vec<SessionError>,
    mut describe: impl FnMut(u8, &mut Vec<SessionError>) -> Result<T, SessionError>,
) -> Result<Vec<T>, SessionError> {
    let mut list = Vec::new();
    for index in indices {
        match describe(index, defects) {
            Ok(described) => list.push(described),
            Err(defect @ SessionError::Refused { .. }) => {
                defects.push(defect);
                break;
            }
            Err(error) => return Err(error),
        }
    }
    Ok(list)
}

fn law(line: &mut Line, index: u8) -> Result<Law, SessionError> {
    described(line, DescribeLaw { index }, |answer| match answer {
        DriveMessage::LawDescription(it) if it.index == index => {
            Some(Ok(Law { index, name: printable(it.name.as_str()) }))
        }
        _ => None,
    })
}

fn parameter(
    line: &mut Line,
    index: u8,
    law_count: u8,
    defects: &mut Vec<SessionError>,
) -> Result<Parameter, SessionError> {
    let (flags, mut parameter) = described(line, DescribeParameter { index }, |answer| match answer {
        DriveMessage::ParameterDescription(it) if it.index == index => {
            let parameter = Parameter {
                index,
                name: printable(it.name.as_str()),
                unit: printable(it.unit.as_str()),
                default: it.default,
                min: it.min,
                max: it.max,
                live: it.flags.contains(ParameterFlags::LIVE),
                laws: LawMask::of_drive(it.laws, law_count),
                choices: Vec::new(),
            };
            Some(Ok((it.flags, parameter)))
        }
        // The answer to an index that the drive does not have; it describes every other.
        DriveMessage::ParameterReport(it) if it.index == index => Some(Err(it.into())),
        _ => None,
    })?;
    if flags.contains(ParameterFlags::CHOICES) {
        match choice_values(&parameter) {
            Ok(values) => parameter.choices = list(values, defects, |value, _| choice(line, index, value))?,
            Err(defect) => defects.push(defect),
        }
    }
    Ok(parameter)
}

/// The values that have names. A choice is one byte on the wire.
fn choice_values(parameter: &Parameter) -> Result<RangeInclusive<u8>, SessionError> {
    let byte = |value| match value {
        ParameterValue::U32(value) => u8::try_from(value).ok(),
        ParameterValue::F32(_) | ParameterValue::Unknown { .. } => None,
    };
    match (byte(parameter.min), byte(parameter.max)) {
        (Some(min), Some(max)) if min <= max => Ok(min..=max),
        _ => Err(SessionError::Choices {
            parameter: parameter.name.clone(),
            min: parameter.min,
            max: parameter.max,
        }),
    }
}

fn choice(line: &mut Line, parameter: u8, choice: u8) -> Result<Choice, SessionError> {
    described(line, DescribeChoice { parameter, choice }, |answer| match answer {
        DriveMessage::ChoiceDescription(it) if (it.parameter, it.choice) == (parameter, choice) => {
            Some(Ok(Choice { value: choice.into(), name: printable(it.name.as_str()) }))
        }
        _ => None,
    })
}

fn signal(line: &mut Line, index: u8, law_count: u8) -> Result<DriveSignal, SessionError> {
    described(line, DescribeSignal { index }, |answer| match answer {
        DriveMessage::SignalDescription(it) if it.index == index => {
            let [name, unit] = [it.name.as_str(), it.unit.as_str()].map(|text| printable(text).into());
            Some(Ok(DriveSignal {
                index,
                laws: LawMask::of_drive(it.laws, law_count),
                signal: Signal { name, unit },
            }))
        }
        _ => None,
    })
}

/// Sends a request until the drive has answered it with a description or rejected it, by a `CommandResult` or by an answer
/// that `answer_of` recognises.
fn described<R: Payload + Into<HostMessage>, T>(
    line: &mut Line,
    request: R,
    answer_of: impl Fn(&DriveMessage) -> Option<Result<T, Reply>>,
) -> Result<T, SessionError> {
    let answered = line.request(&request.into(), |answer| match answer {
        DriveMessage::CommandResult(it) if it.request == R::LAYOUT.kind => Some(Err(it.into())),
        answer => answer_of(answer),
    })?;
    answered.with.map_err(|reply| line.refused(R::LAYOUT.name, reply, &[], &[]))
}

#[cfg(test)]
mod tests;
