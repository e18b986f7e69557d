//! The metrics: names, units and values.

use std::fmt;

use serde::ser::{Serialize, Serializer};

/// Each metric once: its meaning, its name in scenarios and summaries, and its unit.
macro_rules! metrics {
    ($( $(#[doc = $doc:expr])+ $metric:ident = $name:literal in $unit:literal; )+) => {
        /// A quantity by which a run is judged. The module defines each of them.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Metric { $( $(#[doc = $doc])+ $metric, )+ }

        impl Metric {
            /// Every metric, in the order of reports.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$metric),+];

            /// Name in scenarios and summaries.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$metric => $name,)+ }
            }

            /// Unit, as scenarios and reports spell it.
            #[must_use]
            pub const fn unit(self) -> &'static str {
                match self { $(Self::$metric => $unit,)+ }
            }
        }
    };
}

metrics! {
    /// Time into the band of 0.05 rad, for good.
    SettleTime = "settle_time_s" in "s";
    /// Time into the band of 5 % of the initial error, for good.
    SettleTime5Pct = "settle_time_5pct_s" in "s";
    /// Time into the band of 2 % of the initial error, for good.
    SettleTime2Pct = "settle_time_2pct_s" in "s";
    /// Time into the band of 1 % of the initial error, for good.
    SettleTime1Pct = "settle_time_1pct_s" in "s";
    /// Mean error of the last second.
    StaticError = "static_error_rad" in "rad";
    /// Peak to peak of the error over the last 10 s.
    Hunting = "hunting_rad" in "rad";
    /// Largest error beyond the reference.
    Overshoot = "overshoot_rad" in "rad";
    /// Distance between the load's two passages through the middle of the reference.
    LostMotion = "lost_motion_rad" in "rad";
    /// Integral of the squared torque.
    Effort = "effort_nm2s" in "N^2 m^2 s";
    /// Sum of the absolute changes of torque.
    TorqueTotalVariation = "torque_total_variation_nm" in "N m";
    /// The drive's last estimate of the half gap.
    DeadZoneEstimate = "dead_zone_estimate_rad" in "rad";
    /// That estimate less the true half gap.
    DeadZoneError = "dead_zone_error_rad" in "rad";
    /// Time of the estimate of the half gap into the band of 0.02 rad, for good.
    DeadZoneSettleTime = "dead_zone_settle_time_s" in "s";
    /// Mean error of the estimate of the half gap over the last 5 s.
    DeadZoneBias = "dead_zone_bias_rad" in "rad";
    /// Largest error of the estimate of the half gap since its first sample within the band.
    DeadZoneLargestError = "dead_zone_largest_error_rad" in "rad";
    /// Root mean square of the error of the disturbing torque.
    DisturbingTorqueRmsError = "disturbing_torque_rms_error_nm" in "N m";
    /// Mean error of the disturbing torque.
    DisturbingTorqueBias = "disturbing_torque_bias_nm" in "N m";
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
        if let Self::Value(value) = self { Some(value) } else { None }
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

/// All metrics of one run. Serialised as a map from name to number or null.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    pub(super) values: [Measured; Metric::ALL.len()],
    pub(super) finite: bool,
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
        serializer.collect_map(self.iter().map(|(metric, measured)| (metric.name(), measured)))
    }
}
