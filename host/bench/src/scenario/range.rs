//! Allowed ranges of numbers, and how a message spells them.

use std::ops::RangeInclusive;

use super::spelling::{spell_number, with_unit};

/// The numbers a key may take; never NaN, never infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NumberRange {
    /// Lower end.
    pub low: f64,
    /// Whether the lower end is allowed itself.
    pub low_is_allowed: bool,
    /// Upper end, which is allowed.
    pub high: f64,
}

impl From<RangeInclusive<f64>> for NumberRange {
    fn from(range: RangeInclusive<f64>) -> Self {
        Self { low: *range.start(), low_is_allowed: true, high: *range.end() }
    }
}

/// Above zero, up to `high`, which is allowed.
#[must_use]
pub const fn positive(high: f64) -> NumberRange {
    NumberRange { low: 0.0, low_is_allowed: false, high }
}

impl NumberRange {
    pub(super) fn contains(self, number: f64) -> bool {
        let above = if self.low_is_allowed { number >= self.low } else { number > self.low };
        above && number <= self.high
    }

    /// `> 0 and <= 1e6 N m/rad`.
    pub(super) fn describe(self, unit: &str) -> String {
        let sign = if self.low_is_allowed { ">=" } else { ">" };
        with_unit(format!("{sign} {} and <= {}", spell_number(self.low), spell_number(self.high)), unit)
    }
}
