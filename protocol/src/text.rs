//! Short texts of fixed length: names, units, log lines.

use core::fmt;

use crate::layout::FieldType;
use crate::wire::Wire;

/// Name of a control law, and of a choice: the choices of the parameter `controller` are the laws.
pub type LawName = Text<28>;

/// Name of a choice of a parameter.
pub type ChoiceName = LawName;

/// Name of a parameter.
pub type ParameterName = Text<27>;

/// Name of a signal.
pub type SignalName = Text<32>;

/// Unit of a parameter or of a signal; empty for a pure number.
pub type UnitName = Text<10>;

/// UTF-8 of at most `N` bytes, padded with zeros on the wire.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Text<const N: usize> {
    bytes: [u8; N],
    len: usize,
}

impl<const N: usize> Text<N> {
    /// Longest text, in bytes.
    pub const CAPACITY: usize = N;

    /// The empty text.
    pub const EMPTY: Self = Self { bytes: [0; N], len: 0 };

    /// The text, truncated after the last whole character that fits. Zeros are dropped, because zero is the padding.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let mut this = Self::EMPTY;
        this.push(text);
        this
    }

    /// Appends as many whole characters of `text` as fit.
    pub fn push(&mut self, text: &str) {
        for character in text.chars().filter(|&c| c != '\0') {
            let Some(free) = self.bytes[self.len..].get_mut(..character.len_utf8()) else { break };
            character.encode_utf8(free);
            self.len += character.len_utf8();
        }
    }

    /// The text without padding.
    #[must_use]
    pub fn as_str(&self) -> &str {
        core::str::from_utf8(&self.bytes[..self.len]).unwrap_or_default()
    }
}

impl<const N: usize> fmt::Debug for Text<N> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_str().fmt(out)
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_str().fmt(out)
    }
}

impl<const N: usize> Wire for Text<N> {
    const LEN: usize = N;
    const TYPE: FieldType = FieldType::Text;

    fn put(self, out: &mut [u8]) {
        out.copy_from_slice(&self.bytes);
    }

    /// Rejects invalid UTF-8 and bytes after the first zero, so that every text has one encoding.
    fn get(bytes: &[u8]) -> Option<Self> {
        let bytes: [u8; N] = bytes.try_into().ok()?;
        let len = bytes.iter().position(|&b| b == 0).unwrap_or(N);
        let padded = bytes[len..].iter().all(|&b| b == 0);
        (padded && core::str::from_utf8(&bytes[..len]).is_ok()).then_some(Self { bytes, len })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_truncated_between_characters() {
        assert_eq!(Text::<4>::new("N·m²").as_str(), "N·m");
        assert_eq!(Text::<3>::new("N·m²").as_str(), "N·");
    }

    #[test]
    fn bytes_after_the_padding_are_rejected() {
        assert!(Text::<4>::get(b"a\0\0\0").is_some());
        assert!(Text::<4>::get(b"a\0b\0").is_none());
        assert!(Text::<4>::get(&[0xff, 0, 0, 0]).is_none());
    }
}
