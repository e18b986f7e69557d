//! Readers of keys that a group's table names.

use std::ops::RangeInclusive;

use crate::scenario::range::{NumberRange, positive};
use crate::scenario::reader::Section;

/// A required number.
pub(super) fn number(range: impl Into<NumberRange>) -> impl FnOnce(&mut Section<'_>, &'static str) -> f64 {
    move |section, key| section.number(key, None, range)
}

/// A number with a default.
pub(super) fn number_or(
    default: f64,
    range: impl Into<NumberRange>,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> f64 {
    move |section, key| section.number(key, default, range)
}

/// A required whole number.
pub(super) fn integer(range: RangeInclusive<u32>) -> impl FnOnce(&mut Section<'_>, &'static str) -> u32 {
    move |section, key| section.integer(key, None, range)
}

/// A whole number with a default.
pub(super) fn integer_or(
    default: u32,
    range: RangeInclusive<u32>,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> u32 {
    move |section, key| section.integer(key, default, range)
}

/// A required fraction, > 0 and <= 1.
pub(super) fn fraction(section: &mut Section<'_>, key: &'static str) -> f64 {
    section.number(key, None, positive(1.0))
}
