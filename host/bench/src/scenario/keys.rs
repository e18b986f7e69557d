//! Sections and keys as tables: readers of keys, and the table form of a section.

use std::fmt::Display;
use std::ops::RangeInclusive;

use super::range::{NumberRange, positive};
use super::reader::Section;

/// Declares a section whose keys depend on no other key. An entry reads `key: Type = reader`; a reader is called with the
/// section and the key's name. Yields the struct and its reading. The doc lines of a key are its meaning on the page of
/// scenarios too, so they omit unit, range and default, which the reader has.
macro_rules! settings {
    (
        $(#[$attribute:meta])*
        pub struct $name:ident {
            $($(#[doc = $doc:literal])+ $(#[serde($($serde:tt)+)])? $key:ident: $type:ty = $read:expr,)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize)]
        pub struct $name {
            $($(#[doc = $doc])+ $(#[serde($($serde)+)])? pub $key: $type,)+
        }

        impl $name {
            pub(super) fn read(section: &mut $crate::scenario::reader::Section<'_>) -> Self {
                Self { $($key: $read(section.doc(concat!($($doc),+)), stringify!($key)),)+ }
            }
        }
    };
}

pub(super) use settings;

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
pub(super) fn integer_or<T: Copy + Display + PartialOrd + TryFrom<i64> + Into<i128>>(
    default: T,
    range: RangeInclusive<T>,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> T {
    move |section, key| section.integer(key, default, range)
}

/// An optional whole number.
pub(super) fn optional_integer(
    range: RangeInclusive<u64>,
) -> impl FnOnce(&mut Section<'_>, &'static str) -> Option<u64> {
    move |section, key| section.optional_integer(key, range)
}

/// A required fraction, > 0 and <= 1.
pub(super) fn fraction(section: &mut Section<'_>, key: &'static str) -> f64 {
    section.number(key, None, positive(1.0))
}
