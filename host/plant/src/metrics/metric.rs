//! The metrics: each with its name, its unit, its definition, its trend and its meter.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::after_move::SettlingAfterMove;
use super::channel::Channel;
use super::coverage::Beyond;
use super::lost_motion::Reversal;
use super::measured::Measured;
use super::meter::{Meter, NewMeter, Setup};
use super::overshoot::Overshoot;
use super::rise_time::RiseTime;
use super::settling::{Band, LargestOnceInside, Settling};
use super::signal_table::{DRIVE_PREFIX, SignalTable};
use super::statistic::{Statistic, StatisticMeter};
use super::tail::{Figure, Tail};
use super::torque::{Effort, TotalVariation};
use super::trend::Trend;
use super::velocity_error::SteadyVelocityError;
use crate::Signal;

/// Band of `settle_time_s`, in rad. The paper doesn't define the end of the transient; this band reproduces its 13 s.
pub const SETTLED_RAD: f64 = 0.05;
/// Band of `dead_zone_settle_time_s`: an eighth of the paper's half gap, above the error that motor friction and lag leave
/// in a good estimate.
const ESTIMATE_SETTLED_RAD: f64 = 0.02;
/// The drive's estimate of half the gap, and its truth.
const DEAD_ZONE: (&str, &str) = ("drive.dead_zone_estimate_rad", "dead_zone_rad");
/// The drive's standard deviation of that estimate.
const DEAD_ZONE_DEVIATION: &str = "drive.dead_zone_deviation_rad";
/// The drive's estimate of the disturbing torque w = C - K z, and its truth.
const DISTURBING_TORQUE: (&str, &str) = ("drive.disturbing_torque_estimate_nm", "disturbing_torque_nm");

/// Each metric once: its definition, its name in scenarios and summaries, its unit, how its value can change before the end of
/// a run, and its meter.
macro_rules! metrics {
    ($( $(#[doc = $doc:literal])+ $metric:ident = $name:literal in $unit:literal trend $trend:ident by $new:expr; )+) => {
        /// A quantity by which a run is judged, with the error e = load position - reference.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub enum Metric { $( $(#[doc = $doc])+ #[serde(rename = $name)] $metric, )+ }

        impl Metric {
            /// Every metric, in the order of reports.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$metric),+];

            /// The metric of this name.
            #[must_use]
            pub fn named(name: &str) -> Option<Self> {
                match name { $($name => Some(Self::$metric),)+ _ => None }
            }

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

            /// Definition, as `docs/metrics.md` lists it.
            #[must_use]
            pub const fn meaning(self) -> &'static str {
                match self { $(Self::$metric => concat!($($doc),+).trim_ascii_start(),)+ }
            }

            /// How its value can change while the run continues.
            #[must_use]
            pub const fn trend(self) -> Trend {
                match self { $(Self::$metric => Trend::$trend,)+ }
            }

            pub(super) fn meter(self, setup: &Setup<'_>) -> NewMeter {
                match self { $(Self::$metric => { let new: fn(&Setup<'_>) -> NewMeter = $new; new(setup) })+ }
            }
        }
    };
}

metrics! {
    /// First sample time after the last sample with abs(e) > 0.05 rad.
    SettleTime = "settle_time_s" in "s" trend Settling by |_| error_settles(Band::Absolute(SETTLED_RAD));
    /// The same with a band of 5 % of the first abs(e).
    SettleTime5Pct = "settle_time_5pct_s" in "s" trend Settling by |_| error_settles(Band::OfFirst(0.05));
    /// The same with a band of 2 % of the first abs(e).
    SettleTime2Pct = "settle_time_2pct_s" in "s" trend Settling by |_| error_settles(Band::OfFirst(0.02));
    /// The same with a band of 1 % of the first abs(e).
    SettleTime1Pct = "settle_time_1pct_s" in "s" trend Settling by |_| error_settles(Band::OfFirst(0.01));
    /// Time from the last change of the reference to the first sample after the last one with abs(e) > 2 % of the
    /// reference's last move; the move is peak to peak.
    SettleAfterMove = "settle_after_move_s" in "s" trend Any by |_| boxed(SettlingAfterMove::default());
    /// The longest of such times after all moves of the reference, each up to the next.
    SettleAfterEveryMove = "settle_after_every_move_s" in "s" trend Any by |_| boxed(SettlingAfterMove::of_every_move());
    /// Time from the load's first sample at 10 % of its way to its first at 90 %; the way leads from the load's first
    /// position to the reference's last value.
    RiseTime = "rise_time_s" in "s" trend Fixed by |setup| boxed(RiseTime::new(setup.final_rad));
    /// Mean of e over the last second.
    StaticError = "static_error_rad" in "rad" trend Any by |setup| tail(setup, Channel::Error, Figure::Mean, 1.0);
    /// Peak to peak of e over the last 10 s, of a run of less than 20 s over its second half.
    Hunting = "hunting_rad" in "rad" trend Any by |setup| tail(setup, Channel::Error, Figure::PeakToPeak, 10.0);
    /// Largest abs(e) on the far side of the reference, seen from the first e; 0 if none.
    Overshoot = "overshoot_rad" in "rad" trend Rising by |_| boxed(Overshoot::default());
    /// Root of the mean of e^2.
    RmsTrackingError = "rms_tracking_error_rad" in "rad" trend Any by |_| statistic(Channel::Error, Statistic::Rms);
    /// Largest abs(e).
    PeakTrackingError = "peak_tracking_error_rad" in "rad" trend Rising by |_| statistic(Channel::Error, Statistic::Peak);
    /// Mean lag over the last 0.2 s of the reference's last stretch of constant velocity; the lag is -e in the direction
    /// of motion.
    SteadyVelocityError = "steady_velocity_error_rad" in "rad" trend Any by |setup| {
        boxed(SteadyVelocityError::new(setup.period_s, setup.samples(0.2)))
    };
    /// Distance between the load's positions at the reference's last upward and last downward passage through its middle.
    LostMotion = "lost_motion_rad" in "rad" trend Any by |setup| boxed(Reversal::new(setup.middle_rad));
    /// Integral of the squared torque, which is held over each period.
    Effort = "effort_nm2s" in "N^2 m^2 s" trend Rising by |setup| boxed(Effort::new(setup.period_s));
    /// Sum of abs(U_k - U_(k-1)) of the torque U.
    TorqueTotalVariation = "torque_total_variation_nm" in "N m" trend Rising by |_| boxed(TotalVariation::default());
    /// Root of the mean of the squared torque.
    RmsTorque = "rms_torque_nm" in "N m" trend Any by |_| statistic(Channel::Torque, Statistic::Rms);
    /// Largest amount of the torque.
    PeakTorque = "peak_torque_nm" in "N m" trend Rising by |_| statistic(Channel::Torque, Statistic::Peak);
    /// The drive's last estimate of j0, half the gap.
    DeadZoneEstimate = "dead_zone_estimate_rad" in "rad" trend Any by |setup| {
        dead_zone(setup)?;
        statistic(setup.needed(DEAD_ZONE.0)?, Statistic::Final)
    };
    /// The last estimate of j0 minus the true j0 of its sample.
    DeadZoneError = "dead_zone_error_rad" in "rad" trend Any by |setup| statistic(dead_zone(setup)?, Statistic::Final);
    /// The drive's last standard deviation of its estimate of j0.
    DeadZoneDeviation = "dead_zone_deviation_rad" in "rad" trend Any by |setup| {
        statistic(setup.needed(DEAD_ZONE_DEVIATION)?, Statistic::Final)
    };
    /// Fraction of the estimates of j0 that are off by more than two of the deviations stated with them.
    DeadZoneBeyondTwo = "dead_zone_beyond_two_deviations" in "" trend Any by |setup| beyond(setup, 2.0);
    /// Fraction of the estimates of j0 that are off by more than four of the deviations stated with them.
    DeadZoneBeyondFour = "dead_zone_beyond_four_deviations" in "" trend Any by |setup| beyond(setup, 4.0);
    /// Time of the first estimate after the last one more than 0.02 rad from the true j0.
    DeadZoneSettleTime = "dead_zone_settle_time_s" in "s" trend Settling by |setup| {
        boxed(Settling::new(dead_zone(setup)?, Band::Absolute(ESTIMATE_SETTLED_RAD)))
    };
    /// Mean of estimate minus true j0 over the last 5 s.
    DeadZoneBias = "dead_zone_bias_rad" in "rad" trend Any by |setup| tail(setup, dead_zone(setup)?, Figure::Mean, 5.0);
    /// Largest abs(estimate - j0) since the first estimate within 0.02 rad, settled or not.
    DeadZoneLargestError = "dead_zone_largest_error_rad" in "rad" trend Rising by |setup| {
        boxed(LargestOnceInside::new(dead_zone(setup)?, ESTIMATE_SETTLED_RAD))
    };
    /// Root of the mean square of estimate minus true w, the disturbing torque w = C - K z.
    DisturbingTorqueRmsError = "disturbing_torque_rms_error_nm" in "N m" trend Any by |setup| {
        statistic(disturbing_torque(setup)?, Statistic::Rms)
    };
    /// Mean of estimate minus true w.
    DisturbingTorqueBias = "disturbing_torque_bias_nm" in "N m" trend Any by |setup| {
        statistic(disturbing_torque(setup)?, Statistic::Mean)
    };
}

/// Every signal that some metric needs, for a check before the signals of a run are known.
pub(super) fn needed_signals() -> SignalTable {
    let bare = |name: &'static str| name.strip_prefix(DRIVE_PREFIX).unwrap_or(name);
    let scored = [(DEAD_ZONE, "rad"), (DISTURBING_TORQUE, "N m")];
    let estimates = scored.map(|((estimate, _), unit)| (estimate, unit)).into_iter();
    let drive = estimates.chain([(DEAD_ZONE_DEVIATION, "rad")]);
    SignalTable {
        plant: scored.map(|((_, truth), unit)| Signal::new(truth, unit)).to_vec(),
        drive: drive.map(|(name, unit)| Signal::new(bare(name), unit)).collect(),
    }
}

fn boxed(meter: impl Meter + 'static) -> NewMeter {
    Ok(Box::new(meter))
}

fn error_settles(band: Band) -> NewMeter {
    boxed(Settling::new(Channel::Error, band))
}

fn statistic(channel: Channel, statistic: Statistic) -> NewMeter {
    boxed(StatisticMeter::new(channel, statistic))
}

fn tail(setup: &Setup<'_>, channel: Channel, figure: Figure, window_s: f64) -> NewMeter {
    boxed(Tail::new(channel, figure, setup.samples(window_s)))
}

fn dead_zone(setup: &Setup<'_>) -> Result<Channel, Measured> {
    setup.estimate_error(DEAD_ZONE.0, DEAD_ZONE.1)
}

fn beyond(setup: &Setup<'_>, deviations: f64) -> NewMeter {
    boxed(Beyond::new(dead_zone(setup)?, setup.needed(DEAD_ZONE_DEVIATION)?, deviations))
}

fn disturbing_torque(setup: &Setup<'_>) -> Result<Channel, Measured> {
    setup.estimate_error(DISTURBING_TORQUE.0, DISTURBING_TORQUE.1)
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests;
