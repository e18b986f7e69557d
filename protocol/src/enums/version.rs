//! The version of a firmware.

use core::fmt;

use crate::layout::FieldType;
use crate::wire::Wire;

/// Version of the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Version {
    /// Incompatible changes.
    pub major: u8,
    /// Additions.
    pub minor: u8,
    /// Corrections.
    pub patch: u8,
}

impl fmt::Display for Version {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

impl Wire for Version {
    const LEN: usize = 3;
    const TYPE: FieldType = FieldType::Version;

    #[inline]
    fn put(self, out: &mut [u8]) {
        out.copy_from_slice(&[self.major, self.minor, self.patch]);
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        let &[major, minor, patch] = bytes else { return None };
        Some(Self { major, minor, patch })
    }
}
