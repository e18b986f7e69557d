//! Names and units of the metrics.

use std::fmt;

use serde::ser::{Serialize, Serializer};

/// A quantity by which a run is judged. The module defines each of them.
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
    /// Distance between the load's two passages through the middle of the reference.
    LostMotion,
    /// Integral of the squared torque.
    Effort,
    /// Sum of the absolute changes of torque.
    TorqueTotalVariation,
    /// The drive's last estimate of the half gap.
    DeadZoneEstimate,
    /// That estimate less the true half gap.
    DeadZoneError,
    /// Time of the estimate of the half gap into the band of 0.02 rad, for good.
    DeadZoneSettleTime,
    /// Mean error of the estimate of the half gap over the last 5 s.
    DeadZoneBias,
    /// Largest error of the estimate of the half gap since its first sample within the band.
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

    /// Name in scenarios and summaries.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.name_and_unit().0
    }

    /// Unit, as scenarios and reports spell it.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.name_and_unit().1
    }

    const fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::SettleTime => ("settle_time_s", "s"),
            Self::SettleTime5Pct => ("settle_time_5pct_s", "s"),
            Self::SettleTime2Pct => ("settle_time_2pct_s", "s"),
            Self::SettleTime1Pct => ("settle_time_1pct_s", "s"),
            Self::StaticError => ("static_error_rad", "rad"),
            Self::Hunting => ("hunting_rad", "rad"),
            Self::Overshoot => ("overshoot_rad", "rad"),
            Self::LostMotion => ("lost_motion_rad", "rad"),
            Self::Effort => ("effort_nm2s", "N^2 m^2 s"),
            Self::TorqueTotalVariation => ("torque_total_variation_nm", "N m"),
            Self::DeadZoneEstimate => ("dead_zone_estimate_rad", "rad"),
            Self::DeadZoneError => ("dead_zone_error_rad", "rad"),
            Self::DeadZoneSettleTime => ("dead_zone_settle_time_s", "s"),
            Self::DeadZoneBias => ("dead_zone_bias_rad", "rad"),
            Self::DeadZoneLargestError => ("dead_zone_largest_error_rad", "rad"),
            Self::DisturbingTorqueRmsError => ("disturbing_torque_rms_error_nm", "N m"),
            Self::DisturbingTorqueBias => ("disturbing_torque_bias_nm", "N m"),
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
