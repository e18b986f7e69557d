//! The value of a parameter: an integer or a real number, with its type.

use core::fmt;

use crate::layout::FieldType;
use crate::wire::Wire;

wire_enum! {
    /// Type of a parameter's value.
    pub enum ParameterType {
        /// Unsigned integer, 4 bytes.
        U32 = 1,
        /// IEEE 754 binary32, 4 bytes.
        F32 = 2,
    }
}

/// A parameter's value with its type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// An unsigned integer.
    U32(u32),
    /// A real number.
    F32(f32),
}

impl ParameterValue {
    /// The type alone.
    #[must_use]
    pub const fn ty(self) -> ParameterType {
        match self {
            Self::U32(_) => ParameterType::U32,
            Self::F32(_) => ParameterType::F32,
        }
    }
}

impl fmt::Display for ParameterValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::U32(value) => value.fmt(out),
            Self::F32(value) => value.fmt(out),
        }
    }
}

impl Wire for ParameterValue {
    const LEN: usize = 5;
    const TYPE: FieldType = FieldType::ParameterValue;

    #[inline]
    fn put(self, out: &mut [u8]) {
        out[0] = self.ty() as u8;
        match self {
            Self::U32(value) => value.put(&mut out[1..]),
            Self::F32(value) => value.put(&mut out[1..]),
        }
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        match ParameterType::from_byte(bytes[0])? {
            ParameterType::U32 => u32::get(&bytes[1..]).map(Self::U32),
            ParameterType::F32 => f32::get(&bytes[1..]).map(Self::F32),
        }
    }
}
