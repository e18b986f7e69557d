//! A byte that a list of values has no name for.

/// Byte of a value without a name: neither 0 nor one of the list it was read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct UnknownByte(pub(crate) u8);

impl UnknownByte {
    /// The byte as received.
    #[inline]
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }
}
