//! The value of a metric, or the reason for its absence.

use std::fmt;

use serde::ser::{Serialize, Serializer};

/// The value of a metric, or the reason for its absence. Serialised as a number or null.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// A finite number in the metric's unit.
    Value(f64),
    /// The last sample lies outside the band.
    Never,
    /// The run ended before the window was full.
    RunTooShort,
    /// The metric refers to the initial error, which is zero.
    NoInitialError,
    /// The reference did not pass its middle in both directions, or has none.
    NoReversal,
    /// The drive sent no estimate, or none in the window.
    NoEstimate,
    /// The run, or this metric's sum, left the range of finite numbers.
    NotFinite,
}

impl Measured {
    /// The number, or `None` without a value.
    #[must_use]
    pub const fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Never
            | Self::RunTooShort
            | Self::NoInitialError
            | Self::NoReversal
            | Self::NoEstimate
            | Self::NotFinite => None,
        }
    }

    /// A finite number, or [`Measured::NotFinite`].
    pub(super) fn finite(value: f64) -> Self {
        if value.is_finite() { Self::Value(value) } else { Self::NotFinite }
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(value) => value.fmt(f),
            Self::Never => f.pad("never"),
            Self::RunTooShort => f.pad("run too short"),
            Self::NoInitialError => f.pad("no initial error"),
            Self::NoReversal => f.pad("no reversal"),
            Self::NoEstimate => f.pad("no estimate"),
            Self::NotFinite => f.pad("not finite"),
        }
    }
}

impl Serialize for Measured {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value().serialize(serializer)
    }
}
