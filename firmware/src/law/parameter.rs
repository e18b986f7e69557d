//! A parameter as data: name, unit, default and range.

use lashloop_protocol::enums::{Outcome, ParameterValue};

/// One parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name, with the unit at its end; at most 27 bytes.
    pub name: &'static str,
    /// Unit as text, at most 10 bytes; empty for a pure number.
    pub unit: &'static str,
    /// Type, default and allowed values.
    pub range: Range,
    /// Laws that have the parameter, bit `n` for law `n` of the set. A group declares none; `laws!` collects them.
    pub laws: u16,
    /// Whether the drive takes a value while it is armed or running. A group declares none; `laws!` collects them.
    pub live: bool,
}

/// Type of a parameter, with its default and its allowed values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// An unsigned integer.
    U32 {
        /// Value after power-up.
        default: u32,
        /// Smallest value.
        min: u32,
        /// Largest value.
        max: u32,
    },
    /// A real number.
    F32 {
        /// Value after power-up.
        default: f32,
        /// Smallest value.
        min: f32,
        /// Largest value.
        max: f32,
    },
    /// One of several names; the value is the index of the name.
    Choice {
        /// Value after power-up.
        default: u32,
        /// Names in the order of their values, at most 28 bytes each.
        names: &'static [&'static str],
    },
}

impl Parameter {
    /// A parameter of no law yet.
    #[must_use]
    pub const fn new(name: &'static str, unit: &'static str, range: Range) -> Self {
        Self { name, unit, range, laws: 0, live: false }
    }
}

impl Range {
    /// Value after power-up.
    #[must_use]
    pub const fn default(self) -> ParameterValue {
        match self {
            Self::U32 { default, .. } | Self::Choice { default, .. } => ParameterValue::U32(default),
            Self::F32 { default, .. } => ParameterValue::F32(default),
        }
    }

    /// Smallest allowed value.
    #[must_use]
    pub const fn min(self) -> ParameterValue {
        match self {
            Self::U32 { min, .. } => ParameterValue::U32(min),
            Self::F32 { min, .. } => ParameterValue::F32(min),
            Self::Choice { .. } => ParameterValue::U32(0),
        }
    }

    /// Largest allowed value.
    #[must_use]
    pub const fn max(self) -> ParameterValue {
        match self {
            Self::U32 { max, .. } => ParameterValue::U32(max),
            Self::F32 { max, .. } => ParameterValue::F32(max),
            Self::Choice { names, .. } => ParameterValue::U32(names.len() as u32 - 1),
        }
    }

    /// Names of the values, of a choice only.
    #[must_use]
    pub const fn choices(self) -> Option<&'static [&'static str]> {
        match self {
            Self::Choice { names, .. } => Some(names),
            Self::U32 { .. } | Self::F32 { .. } => None,
        }
    }

    /// The value of this type in a 32-bit word.
    #[must_use]
    pub const fn value(self, word: u32) -> ParameterValue {
        match self {
            Self::U32 { .. } | Self::Choice { .. } => ParameterValue::U32(word),
            Self::F32 { .. } => ParameterValue::F32(f32::from_bits(word)),
        }
    }

    /// The 32-bit word of the default.
    #[must_use]
    pub const fn default_word(self) -> u32 {
        match self {
            Self::U32 { default, .. } | Self::Choice { default, .. } => default,
            Self::F32 { default, .. } => default.to_bits(),
        }
    }

    /// The 32-bit word of a value.
    ///
    /// # Errors
    /// [`Outcome::WrongType`], and [`Outcome::OutOfRange`] for a value beyond the range. NaN is in no range.
    pub fn word(self, value: ParameterValue) -> Result<u32, Outcome> {
        use ParameterValue::{F32, U32};
        let (is_allowed, word) = match (self.min(), value, self.max()) {
            (U32(min), U32(value), U32(max)) => ((min..=max).contains(&value), value),
            (F32(min), F32(value), F32(max)) => ((min..=max).contains(&value), value.to_bits()),
            _ => return Err(Outcome::WrongType),
        };
        if is_allowed { Ok(word) } else { Err(Outcome::OutOfRange) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_keeps_every_bit_of_a_value() {
        let range = Range::F32 { default: 0.1, min: -1.0, max: 1.0 };
        assert_eq!(range.value(range.default_word()), ParameterValue::F32(0.1));
        assert_eq!(range.word(ParameterValue::F32(-0.0)), Ok((-0.0_f32).to_bits()));
        assert_eq!(range.word(ParameterValue::F32(f32::NAN)), Err(Outcome::OutOfRange));
        assert_eq!(range.word(ParameterValue::U32(0)), Err(Outcome::WrongType));
    }

    #[test]
    fn a_choice_ranges_over_its_names() {
        let range = Range::Choice { default: 1, names: &["a", "b", "c"] };
        assert_eq!((range.min(), range.max()), (ParameterValue::U32(0), ParameterValue::U32(2)));
        assert_eq!(range.word(ParameterValue::U32(3)), Err(Outcome::OutOfRange));
    }
}
