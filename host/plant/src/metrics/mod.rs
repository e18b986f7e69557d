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
//! The drive's estimates are scored while they are made. Telemetry comes every n-th step; each is compared with the truth of
//! the sample it is of, and steps without one have no part in a score:
//!
//! | metric | unit | meaning |
//! |---|---|---|
//! | `dead_zone_settle_time_s` | s | time of the first estimate after the last one more than 0.02 rad from the true j0 |
//! | `dead_zone_bias_rad` | rad | mean of estimate less true j0 over the last 5 s |
//! | `dead_zone_largest_error_rad` | rad | largest abs(estimate - j0) since an estimate first was within 0.02 rad, settled or not: how far it strays once it has been right |
//! | `disturbing_torque_rms_error_nm` | N m | root of the mean square of w_hat - w over the run, with the plant's own w = C - K z |
//! | `disturbing_torque_bias_nm` | N m | mean of w_hat - w over the run |
//!
//! A law that estimates nothing is scored like any other: it tells the amplitude it was given and w_hat = 0, so its root mean
//! square is that of w itself, which is what an estimator has to beat. On the paper's smooth plant the gap is four times as
//! wide as j0, and a law that identifies the gap it finds is far from j0 there.
//!
//! A metric that can't be had has no value but a reason ([`Measured`]): it never settled, the run is shorter
//! than the window, there was no initial error to compare with, the reference never reversed, the drive told no estimate,
//! or something was not finite. One position, reference or torque that isn't finite takes the value from every metric of the run,
//! and so does a plant that could not be followed to the end: a run that diverged can't score well by what
//! happened before or by a comparison that drops NaN. An estimate that isn't finite takes the scores of that estimate only.

mod estimates;
mod measurement;
mod settling;

use std::fmt;

use serde::ser::{Serialize, SerializeMap, Serializer};

pub use self::estimates::Estimates;
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
    /// Time of the estimate of the half gap into the band of 0.02 rad, for good.
    DeadZoneSettleTime,
    /// Mean error of the estimate of the half gap over the last 5 s.
    DeadZoneBias,
    /// Largest error of the estimate of the half gap since it first was within the band.
    DeadZoneLargestError,
    /// Root mean square of the error of the disturbing torque.
    DisturbingTorqueRmsError,
    /// Mean error of the disturbing torque.
    DisturbingTorqueBias,
}

impl Metric {
    /// Every metric, in the order of reports.
    pub const ALL: [Self; 17] = [
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
        Self::DeadZoneSettleTime,
        Self::DeadZoneBias,
        Self::DeadZoneLargestError,
        Self::DisturbingTorqueRmsError,
        Self::DisturbingTorqueBias,
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
            Self::DeadZoneSettleTime => "dead_zone_settle_time_s",
            Self::DeadZoneBias => "dead_zone_bias_rad",
            Self::DeadZoneLargestError => "dead_zone_largest_error_rad",
            Self::DisturbingTorqueRmsError => "disturbing_torque_rms_error_nm",
            Self::DisturbingTorqueBias => "disturbing_torque_bias_nm",
        }
    }

    /// The unit, as it is spelled in scenarios and reports.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::SettleTime
            | Self::SettleTime5Pct
            | Self::SettleTime2Pct
            | Self::SettleTime1Pct
            | Self::DeadZoneSettleTime => "s",
            Self::StaticError
            | Self::Hunting
            | Self::Overshoot
            | Self::LostMotion
            | Self::DeadZoneEstimate
            | Self::DeadZoneError
            | Self::DeadZoneBias
            | Self::DeadZoneLargestError => "rad",
            Self::Effort => "N^2 m^2 s",
            Self::TorqueTotalVariation | Self::DisturbingTorqueRmsError | Self::DisturbingTorqueBias => "N m",
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
    /// The drive told no estimate, or none in the window.
    NoEstimate,
    /// The run, or this metric's sum, left the finite numbers.
    NotFinite,
}

impl Measured {
    /// The number, if there is one.
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
