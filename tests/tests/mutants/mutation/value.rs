//! The value at a site of a drive, and the operators that alter it.

use std::hash::{Hash, Hasher};

/// How a number is stored, which decides what can go wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    U8,
    U16,
    U32,
    I24,
    /// An `I24` that is about to become a wider number.
    Reading,
    F32,
    /// A whole number in a calculation.
    Whole,
    /// A real number in a calculation.
    Real,
}

#[derive(Clone, Debug)]
pub enum Value {
    /// One of `of` alternatives: a flag (false, true), a state, an outcome, the fate of a message.
    Pick {
        index: usize,
        of: usize,
    },
    /// `other`: what a mistaken drive would take instead, such as the other encoder's number.
    Number {
        value: f64,
        width: Width,
        other: Option<f64>,
    },
    Text(Vec<u8>),
    List(Vec<f32>),
}

/// What a mutant makes of a value.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Operator {
    /// Always this alternative.
    To(usize),
    /// The next alternative; of a flag the opposite.
    Next,
    /// The value of the time before.
    Previous,
    Zero,
    Add(f64),
    Scale(f64),
    Negated,
    Absolute,
    /// Not sign extended.
    Unsigned,
    /// In the other order: the bytes of a number, the elements of a list.
    Reversed,
    Other,
    Empty,
    Shortened,
    /// Another text of the same length.
    Altered,
    /// A byte after the first zero.
    Unterminated,
}

impl Width {
    const fn is_signed(self) -> bool {
        matches!(self, Self::I24 | Self::Reading | Self::F32 | Self::Whole | Self::Real)
    }

    const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::Whole | Self::Real => 1,
            Self::U16 => 2,
            Self::I24 | Self::Reading => 3,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Reads a number from its bytes.
    pub fn read(self, bytes: &[u8]) -> f64 {
        let mut four = [0; 4];
        four[..bytes.len()].copy_from_slice(bytes);
        match self {
            Self::F32 => f32::from_le_bytes(four).into(),
            Self::I24 | Self::Reading => f64::from(i32::from_le_bytes(four) << 8 >> 8),
            _ => u32::from_le_bytes(four).into(),
        }
    }

    /// Writes a number, as far as it fits.
    pub fn write(self, value: f64, bytes: &mut [u8]) {
        let four = match self {
            Self::F32 => (value as f32).to_le_bytes(),
            _ => (value as i64 as u32).to_le_bytes(),
        };
        bytes.copy_from_slice(&four[..bytes.len()]);
    }
}

impl Value {
    /// Every operator for a value of this type. The first one also occurs now and then, or in one state alone.
    pub fn operators(&self) -> Vec<Operator> {
        use Operator::*;
        match self {
            Self::Pick { of: 2, .. } => vec![Next, To(0), To(1)],
            Self::Pick { of, .. } => [Next, Previous].into_iter().chain((0..*of).map(To)).collect(),
            Self::Number { width, other, .. } => {
                let mut operators =
                    vec![Add(1.0), Add(-1.0), Zero, Scale(2.0), Scale(1e3), Scale(1e-3), Previous];
                if width.is_signed() {
                    operators.extend([Negated, Absolute]);
                }
                if *width == Width::Reading {
                    operators.push(Unsigned);
                }
                if width.bytes() > 1 {
                    operators.push(Reversed);
                }
                operators.extend(other.map(|_| Other));
                operators
            }
            Self::Text(_) => vec![Altered, Previous, Empty, Shortened, Unterminated],
            Self::List(_) => vec![Zero, Previous, Reversed, Shortened],
        }
    }

    /// The value that a mutant uses instead of this one. An operator leaves a value of another type alone.
    pub fn mutated(&self, operator: Operator, previous: Option<&Self>) -> Self {
        use Operator::*;
        match (self.clone(), operator) {
            (value, Previous) => previous.cloned().unwrap_or(value),
            (Self::Pick { of, .. }, To(index)) => Self::Pick { index, of },
            (Self::Pick { index, of }, Next) => Self::Pick { index: (index + 1) % of, of },
            (Self::Number { value, width, other }, operator) => {
                let value = match operator {
                    Zero => 0.0,
                    Add(more) => value + more,
                    Scale(factor) => value * factor,
                    Negated => 0.0 - value,
                    Absolute => value.abs(),
                    Unsigned => value.rem_euclid(f64::from(1 << 24)),
                    Other => other.unwrap_or(value),
                    Reversed => {
                        let mut bytes = [0; 4];
                        let bytes = &mut bytes[..width.bytes()];
                        width.write(value, bytes);
                        bytes.reverse();
                        width.read(bytes)
                    }
                    _ => value,
                };
                Self::Number { value, width, other }
            }
            (Self::Text(mut text), operator) => {
                let end = text.iter().position(|byte| *byte == 0).unwrap_or(text.len());
                match operator {
                    Empty => text.fill(0),
                    Shortened if end > 0 => text[end - 1] = 0,
                    Altered => text[0] = if text[0] == b'z' { b'y' } else { b'z' },
                    Unterminated if end + 1 < text.len() => *text.last_mut().expect("a byte") = b'z',
                    _ => {}
                }
                Self::Text(text)
            }
            (Self::List(mut list), operator) => {
                match operator {
                    Zero => list[0] = 0.0,
                    Reversed => list.reverse(),
                    Shortened => drop(list.pop()),
                    _ => {}
                }
                Self::List(list)
            }
            (value, _) => value,
        }
    }

    pub fn is(&self, other: &Self) -> bool {
        let bits = |list: &[f32]| list.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
        match (self, other) {
            (Self::Pick { index, .. }, Self::Pick { index: other, .. }) => index == other,
            (Self::Number { value, .. }, Self::Number { value: other, .. }) => {
                value.to_bits() == other.to_bits()
            }
            (Self::Text(text), Self::Text(other)) => text == other,
            (Self::List(list), Self::List(other)) => bits(list) == bits(other),
            _ => false,
        }
    }

    /// Whether both are of one type.
    pub fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Pick { of, .. }, Self::Pick { of: other, .. }) => of == other,
            (Self::Number { .. }, Self::Number { .. })
            | (Self::Text(_), Self::Text(_))
            | (Self::List(_), Self::List(_)) => true,
            _ => false,
        }
    }

    pub fn hash(&self, into: &mut impl Hasher) {
        match self {
            Self::Pick { index, .. } => index.hash(into),
            Self::Number { value, .. } => value.to_bits().hash(into),
            Self::Text(text) => text.hash(into),
            Self::List(list) => list.iter().for_each(|it| it.to_bits().hash(into)),
        }
    }

    pub const fn is_negative(&self) -> Option<bool> {
        match self {
            Self::Number { value, .. } if *value != 0.0 => Some(*value < 0.0),
            _ => None,
        }
    }
}
