//! The value of a metric, or the reason for its absence.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The value of a metric or a statistic, or the reason for its absence. Serialised as a number or null, which reads back as
/// [`NotMeasured`](Self::NotMeasured).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// A finite number in the metric's unit.
    Value(f64),
    /// The last sample lies outside the band, or the load never came far enough.
    Never,
    /// The run ended before the window was full.
    RunTooShort,
    /// The metric refers to the distance from the reference at its first sample, which is zero.
    NoInitialError,
    /// The reference did not pass its middle in both directions, or has none.
    NoReversal,
    /// The reference never changed.
    NoMove,
    /// The reference was still changing at the end.
    NoEndOfMotion,
    /// The reference had no stretch of constant velocity that is long enough.
    NoSteadyVelocity,
    /// Neither plant nor telemetry has a signal that the metric needs.
    MissingSignal(&'static str),
    /// Neither plant nor telemetry has the signal of this statistic.
    UnknownSignal,
    /// The metric compares with the truth of a simulated plant, and a bench of hardware has none.
    NoTruth,
    /// No telemetry arrived, or none in the window.
    NoTelemetry,
    /// The run did not measure this quantity.
    NotMeasured,
    /// The run, or this metric's sum, left the range of finite numbers.
    NotFinite,
}

impl Measured {
    /// The number, or `None` without a value.
    #[must_use]
    pub const fn value(self) -> Option<f64> {
        if let Self::Value(value) = self { Some(value) } else { None }
    }

    /// Why there is no value; `None` with one.
    #[must_use]
    pub fn reason(self) -> Option<String> {
        match self {
            Self::Value(_) => None,
            reason => Some(reason.to_string()),
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
            Self::NoMove => f.pad("no move"),
            Self::NoEndOfMotion => f.pad("no end of motion"),
            Self::NoSteadyVelocity => f.pad("no steady velocity"),
            Self::MissingSignal(name) => f.pad(&format!("no signal {name}")),
            Self::UnknownSignal => f.pad("unknown signal"),
            Self::NoTruth => f.pad("not measured on a bench"),
            Self::NoTelemetry => f.pad("no telemetry"),
            Self::NotMeasured => f.pad("not measured"),
            Self::NotFinite => f.pad("not finite"),
        }
    }
}

impl Serialize for Measured {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Measured {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Option::deserialize(deserializer)?.map_or(Self::NotMeasured, Self::Value))
    }
}
