//! The drive's parameters, as the drive describes them.

use lashloop_protocol::enums::{Outcome, ParameterType, ParameterValue};

use crate::error::SessionError;
use crate::laws::LawMask;
use crate::names::{UnknownName, in_words};

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
    /// The laws that have it.
    pub laws: LawMask,
    /// The values by name; empty for a parameter without choices.
    pub choices: Vec<Choice>,
}

/// A named value of a parameter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// The value on the wire.
    pub value: u32,
    /// Its name.
    pub name: String,
}

/// A value as a user writes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WrittenValue<'a> {
    /// A number.
    Number(f64),
    /// The name of a choice.
    Name(&'a str),
}

impl From<f64> for WrittenValue<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<'a> From<&'a str> for WrittenValue<'a> {
    fn from(name: &'a str) -> Self {
        Self::Name(name)
    }
}

impl Parameter {
    /// The allowed values as text, for example `0 to 1000 N m` or `model or observed`.
    #[must_use]
    pub fn range(&self) -> String {
        if !self.choices.is_empty() {
            return in_words(self.choices.iter().map(|choice| &*choice.name), "or");
        }
        let whole = if self.default.ty() == ParameterType::U32 { "a whole number, " } else { "" };
        format!("{whole}{} to {} {}", self.min, self.max, self.unit).trim_end().to_owned()
    }

    /// The name of a value; `None` if the parameter has no choices, or none of this value.
    #[must_use]
    pub fn choice(&self, value: ParameterValue) -> Option<&str> {
        let ParameterValue::U32(value) = value else { return None };
        self.choices.iter().find(|choice| choice.value == value).map(|choice| &*choice.name)
    }

    /// The value that a user means.
    ///
    /// # Errors
    /// The value is out of range, or a name that no choice has.
    pub fn value(&self, written: WrittenValue<'_>) -> Result<ParameterValue, SetError> {
        match written {
            WrittenValue::Number(number) => {
                self.number(number).ok_or_else(|| SetError::OutOfRange { range: self.range() })
            }
            WrittenValue::Name(_) if self.choices.is_empty() => {
                Err(SetError::NotANumber { range: self.range() })
            }
            WrittenValue::Name(name) => {
                let choice = self.choices.iter().find(|choice| choice.name == name);
                choice.map(|choice| ParameterValue::U32(choice.value)).ok_or_else(|| {
                    let known = self.choices.iter().map(|choice| &*choice.name);
                    SetError::Unknown(UnknownName::new("this parameter", "choice", name, known))
                })
            }
        }
    }

    /// `number` as a value of this parameter's type; `None` outside its range.
    fn number(&self, number: f64) -> Option<ParameterValue> {
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
    /// The drive has no such parameter, or the parameter no such choice.
    #[error(transparent)]
    Unknown(UnknownName),
    /// The value is outside the drive's range.
    #[error("the drive takes {range}")]
    OutOfRange {
        /// The allowed values as text.
        range: String,
    },
    /// A text for a parameter without choices.
    #[error("it is a text; the drive takes {range}")]
    NotANumber {
        /// The allowed values as text.
        range: String,
    },
    /// The drive rejected the value or reads back another.
    #[error("the drive answered {cause} and has {in_force} in force")]
    Refused {
        /// The drive's answer.
        outcome: Outcome,
        /// The same in words.
        cause: String,
        /// The value in force.
        in_force: ParameterValue,
    },
    /// The session failed.
    #[error(transparent)]
    Session(#[from] SessionError),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source() -> Parameter {
        let [default, min, max] = [1, 0, 1].map(ParameterValue::U32);
        let choices = [(0, "model"), (1, "observed")];
        Parameter {
            index: 3,
            name: "source".to_owned(),
            unit: String::new(),
            default,
            min,
            max,
            live: false,
            laws: LawMask(2),
            choices: choices.map(|(value, name)| Choice { value, name: name.to_owned() }).to_vec(),
        }
    }

    #[test]
    fn a_choice_is_taken_by_its_name_or_its_number() {
        let source = source();
        assert_eq!(source.range(), "model or observed");
        for written in [WrittenValue::Name("model"), WrittenValue::Number(0.0)] {
            assert_eq!(source.value(written).expect("a choice"), ParameterValue::U32(0));
        }
        assert_eq!(source.choice(ParameterValue::U32(1)), Some("observed"));
        let error = source.value("observer".into()).expect_err("no such choice").to_string();
        assert_eq!(
            error,
            "this parameter has no choice of this name (did you mean observed?); it has model, observed"
        );
    }

    #[test]
    fn a_parameter_without_choices_takes_no_name() {
        let plain = Parameter { choices: Vec::new(), unit: "rad".to_owned(), ..source() };
        let error = plain.value("model".into()).expect_err("a text").to_string();
        assert_eq!(error, "it is a text; the drive takes a whole number, 0 to 1 rad");
        assert!(matches!(plain.value(0.5.into()), Err(SetError::OutOfRange { .. })));
    }
}
