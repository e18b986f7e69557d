//! What a run is worth, in numbers.
//!
//! With the error e = load position - reference, sampled once per control period:
//!
//! | metric | unit | meaning |
//! |---|---|---|
//! | `settle_time_s` | s | first sample time after the last sample with abs(e) > 0.05 rad |
//! | `settle_time_5pct_s` | s | the same with a band of 5 % of the initial abs(e) |
//! | `settle_time_2pct_s` | s | the same with a band of 2 % |
//! | `settle_time_1pct_s` | s | the same with a band of 1 % |
//! | `static_error_rad` | rad | mean of e over the last second |
//! | `hunting_rad` | rad | peak to peak of e over the last 10 s |
//! | `overshoot_rad` | rad | largest abs(e) on the far side of the reference, seen from the initial error; 0 if none |
//! | `lost_motion_rad` | rad | between the load's positions where the reference passes its middle, last time upwards and last time downwards |
//! | `effort_nm2s` | N^2 m^2 s | integral of the torque squared, the torque being held over each period |
//! | `torque_total_variation_nm` | N m | sum of abs(U_k - U_(k-1)) |
//! | `dead_zone_estimate_rad` | rad | the drive's last estimate of j0 |
//! | `dead_zone_error_rad` | rad | the drive's last estimate less the true j0 of that time |
//!
//! A metric that can't be had has no value but a reason ([`Measured`]): it never settled, the run is shorter
//! than the window, there was no initial error to compare with, the reference never reversed, or something was
//! not finite. One position, reference or torque that isn't finite takes the value from every metric of the run,
//! and so does a plant that could not be followed to the end: a run that diverged can't score well by what
//! happened before or by a comparison that drops NaN.

mod measurement;

use std::fmt;

use serde::ser::{Serialize, SerializeMap, Serializer};

pub use self::measurement::{Measurement, Sample};

/// A quantity by which a run is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// Time into the band of 0.05 rad, for good.
    SettleTime,
    /// Time into the band of 5 % of the initial error, for good.
    SettleTime5Pct,
    /// Time into the band of 2 % of the initial error, for good.
    SettleTime2Pct,
    /// Time into the band of 1 % of the initial error, for good.
    SettleTime1Pct,
    /// Mean error of the last second.
    StaticError,
    /// Peak to peak of the error over the last 10 s.
    Hunting,
    /// Largest error beyond the reference.
    Overshoot,
    /// Distance between the load's two ways through the middle of the reference.
    LostMotion,
    /// Integral of the torque squared.
    Effort,
    /// Sum of the torque's changes.
    TorqueTotalVariation,
    /// The drive's last estimate of the half gap.
    DeadZoneEstimate,
    /// That estimate less the true half gap.
    DeadZoneError,
}

impl Metric {
    /// Every metric, in the order of reports.
    pub const ALL: [Self; 12] = [
        Self::SettleTime,
        Self::SettleTime5Pct,
        Self::SettleTime2Pct,
        Self::SettleTime1Pct,
        Self::StaticError,
        Self::Hunting,
        Self::Overshoot,
        Self::LostMotion,
        Self::Effort,
        Self::TorqueTotalVariation,
        Self::DeadZoneEstimate,
        Self::DeadZoneError,
    ];

    /// The name in scenarios and summaries.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SettleTime => "settle_time_s",
            Self::SettleTime5Pct => "settle_time_5pct_s",
            Self::SettleTime2Pct => "settle_time_2pct_s",
            Self::SettleTime1Pct => "settle_time_1pct_s",
            Self::StaticError => "static_error_rad",
            Self::Hunting => "hunting_rad",
            Self::Overshoot => "overshoot_rad",
            Self::LostMotion => "lost_motion_rad",
            Self::Effort => "effort_nm2s",
            Self::TorqueTotalVariation => "torque_total_variation_nm",
            Self::DeadZoneEstimate => "dead_zone_estimate_rad",
            Self::DeadZoneError => "dead_zone_error_rad",
        }
    }

    /// The unit, as it is spelled in scenarios and reports.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::SettleTime | Self::SettleTime5Pct | Self::SettleTime2Pct | Self::SettleTime1Pct => "s",
            Self::StaticError
            | Self::Hunting
            | Self::Overshoot
            | Self::LostMotion
            | Self::DeadZoneEstimate
            | Self::DeadZoneError => "rad",
            Self::Effort => "N^2 m^2 s",
            Self::TorqueTotalVariation => "N m",
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Metric {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// The value of a metric, or why it has none. Serialised as a number or null.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// A finite number in the metric's unit.
    Value(f64),
    /// The last sample is still outside the band.
    Never,
    /// The run ended before the window was full.
    RunTooShort,
    /// The metric compares with the initial error, and that is zero.
    NoInitialError,
    /// The reference did not pass its middle in both directions, or has none.
    NoReversal,
    /// The run, or this metric's sum, left the finite numbers.
    NotFinite,
}

impl Measured {
    /// The number, if there is one.
    #[must_use]
    pub const fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Never | Self::RunTooShort | Self::NoInitialError | Self::NoReversal | Self::NotFinite => {
                None
            }
        }
    }

    /// A number, unless it isn't finite.
    fn finite(value: f64) -> Self {
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
            Self::NotFinite => f.pad("not finite"),
        }
    }
}

impl Serialize for Measured {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value().serialize(serializer)
    }
}

/// All metrics of one run. Serialised as a map from name to number or null.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    values: [Measured; Metric::ALL.len()],
    finite: bool,
}

impl Metrics {
    /// One metric.
    #[must_use]
    pub const fn get(&self, metric: Metric) -> Measured {
        self.values[metric as usize]
    }

    /// Whether every position, reference and torque of the run was finite.
    #[must_use]
    pub const fn run_was_finite(&self) -> bool {
        self.finite
    }

    /// Every metric with its value, in the order of reports.
    pub fn iter(&self) -> impl Iterator<Item = (Metric, Measured)> {
        Metric::ALL.into_iter().zip(self.values)
    }
}

impl Serialize for Metrics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len()))?;
        for (metric, measured) in self.iter() {
            map.serialize_entry(metric.name(), &measured)?;
        }
        map.end()
    }
}
