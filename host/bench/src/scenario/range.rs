//! Allowed ranges of numbers, and how a message spells them.

use super::spelling::{spell_number, with_unit};

/// The numbers a key may take; never NaN, never infinite.
#[derive(Debug, Clone, Copy)]
pub(super) struct NumberRange {
    low: f64,
    low_is_allowed: bool,
    high: f64,
}

/// From `low` to `high`, both allowed.
pub(super) const fn within(low: f64, high: f64) -> NumberRange {
    NumberRange { low, low_is_allowed: true, high }
}

/// Above zero, up to `high`, which is allowed.
pub(super) const fn positive(high: f64) -> NumberRange {
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
