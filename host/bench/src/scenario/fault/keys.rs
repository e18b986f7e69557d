//! Readers of keys that a group's table names.

use std::ops::RangeInclusive;

use crate::scenario::range::{NumberRange, positive};
use crate::scenario::reader::Section;
use crate::scenario::unit;

/// A required number.
pub(super) fn number(
    unit: &'static str,
    range: NumberRange,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> f64 {
    move |section, key| section.number(key, unit, None, range)
}

/// A number with a default.
pub(super) fn number_or(
    default: f64,
    unit: &'static str,
    range: NumberRange,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> f64 {
    move |section, key| section.number(key, unit, default, range)
}

/// A required whole number.
pub(super) fn integer(
    unit: &'static str,
    range: RangeInclusive<u32>,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> u32 {
    move |section, key| section.integer(key, unit, None, range)
}

/// A whole number with a default.
pub(super) fn integer_or(
    default: u32,
    unit: &'static str,
    range: RangeInclusive<u32>,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> u32 {
    move |section, key| section.integer(key, unit, default, range)
}

/// A required fraction, > 0 and <= 1.
pub(super) fn fraction(section: &mut Section<'_>, key: &'static str) -> f64 {
    section.number(key, unit::NONE, None, positive(1.0))
}
