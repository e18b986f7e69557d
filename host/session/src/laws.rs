//! The drive's laws, as the drive describes them.

use crate::names::in_words;

/// A control law of the drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Law {
    /// Index on the wire; the value of the parameter `controller`.
    pub index: u8,
    /// Name, as scenarios write it.
    pub name: String,
}

/// A set of laws: bit `n` stands for the law with index `n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LawMask(pub u16);

impl LawMask {
    /// The mask of a description. Bits of laws that the drive does not have mean nothing.
    #[must_use]
    pub fn of_drive(bits: u16, law_count: u8) -> Self {
        let unknown = u16::MAX.checked_shl(law_count.into()).unwrap_or(0);
        Self(bits & !unknown)
    }

    /// Whether the law with this index is in the set.
    #[must_use]
    pub fn contains(self, index: u8) -> bool {
        u32::from(self.0).checked_shr(index.into()).is_some_and(|bits| bits & 1 != 0)
    }

    /// Whether all of `laws` are in the set: what it marks belongs to the drive itself.
    #[must_use]
    pub fn is_all(self, laws: &[Law]) -> bool {
        laws.iter().all(|law| self.contains(law.index))
    }

    /// The names of those of `laws` that are in the set, such as `pd and merzouki`; `no law` for none.
    #[must_use]
    pub fn names(self, laws: &[Law]) -> String {
        let names = laws.iter().filter(|law| self.contains(law.index)).map(|law| &*law.name);
        let names = in_words(names, "and");
        if names.is_empty() { "no law".to_owned() } else { names }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_names_its_laws() {
        let laws = ["pd", "merzouki", "own"].map(str::to_owned);
        let laws: Vec<_> = (0..).zip(laws).map(|(index, name)| Law { index, name }).collect();
        assert_eq!(LawMask(0b101).names(&laws), "pd and own");
        assert_eq!(LawMask(0b111).names(&laws), "pd, merzouki and own");
        assert_eq!(LawMask(0b1000).names(&laws), "no law");
        assert!(LawMask(0b111).is_all(&laws) && !LawMask(0b110).is_all(&laws));
        assert!(LawMask(u16::MAX).contains(15) && !LawMask(u16::MAX).contains(16));
        assert!(!LawMask(u16::MAX).contains(200));
    }

    #[test]
    fn bits_of_laws_that_do_not_exist_are_ignored() {
        assert_eq!(LawMask::of_drive(0b1010_0110, 3), LawMask(0b110));
        assert_eq!(LawMask::of_drive(u16::MAX, 16), LawMask(u16::MAX));
    }
}
