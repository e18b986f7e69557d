//! The value of a parameter: an integer or a real number, with its type.

use core::fmt;

use crate::enums::unknown_byte::UnknownByte;
use crate::layout::FieldType;
use crate::wire::Wire;

wire_list! {
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
    /// A value of a type that this version doesn't know.
    Unknown {
        /// Byte of the type.
        ty: UnknownByte,
        /// The value as received.
        bytes: [u8; 4],
    },
}

impl ParameterValue {
    /// The type alone.
    #[must_use]
    pub const fn ty(self) -> ParameterType {
        match self {
            Self::U32(_) => ParameterType::U32,
            Self::F32(_) => ParameterType::F32,
            Self::Unknown { ty, .. } => ParameterType::Unknown(ty),
        }
    }
}

impl fmt::Display for ParameterValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::U32(value) => value.fmt(out),
            Self::F32(value) => value.fmt(out),
            Self::Unknown { bytes, .. } => write!(out, "{:#010x}", u32::from_le_bytes(*bytes)),
        }
    }
}

impl Wire for ParameterValue {
    const LEN: usize = 5;
    const TYPE: FieldType = FieldType::ParameterValue;

    #[inline]
    fn put(self, out: &mut [u8]) {
        out[0] = self.ty().byte();
        match self {
            Self::U32(value) => value.put(&mut out[1..]),
            Self::F32(value) => value.put(&mut out[1..]),
            Self::Unknown { bytes, .. } => out[1..].copy_from_slice(&bytes),
        }
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        match ParameterType::from_byte(bytes[0])? {
            ParameterType::U32 => u32::get(&bytes[1..]).map(Self::U32),
            ParameterType::F32 => f32::get(&bytes[1..]).map(Self::F32),
            ParameterType::Unknown(ty) => Some(Self::Unknown { ty, bytes: bytes[1..].try_into().ok()? }),
        }
    }
}
