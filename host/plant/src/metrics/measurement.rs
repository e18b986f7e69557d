//! Metrics computed sample by sample; memory is one window of errors and one of estimates, whatever the length of the run.

use std::collections::VecDeque;

use super::estimates::{BIAS_WINDOW_S, Estimates, EstimatorScore};
use super::settling::Settling;
use super::{Measured, Metric, Metrics};

/// The band of `settle_time_s`. The paper doesn't say what it calls the end of the transient; with this band
/// its 13 s come out.
const SETTLED_RAD: f64 = 0.05;
/// The bands of `settle_time_5pct_s` and its like, as shares of the initial error.
const SETTLED_SHARES: [f64; 3] = [0.05, 0.02, 0.01];
const STATIC_WINDOW_S: f64 = 1.0;
const HUNTING_WINDOW_S: f64 = 10.0;

/// What one control step contributes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time of the run.
    pub time_s: f64,
    /// Position asked for at that time.
    pub reference_rad: f64,
    /// True position of the load at that time.
    pub load_position_rad: f64,
    /// Torque held from that time on for one period.
    pub torque_nm: f64,
    /// What the drive estimated at that time, if it told.
    pub estimates: Option<Estimates>,
    /// True j0 at that time.
    pub dead_zone_rad: f64,
    /// True disturbing torque at that time.
    pub disturbing_torque_nm: f64,
}

/// Takes the samples of one run and gives its metrics.
#[derive(Debug, Clone)]
pub struct Measurement {
    period_s: f64,
    finite: bool,
    initial_error_rad: Option<f64>,
    settling: Settling,
    settling_shares: [Settling; 3],
    /// The errors of the longest window, oldest first.
    recent_rad: VecDeque<f64>,
    overshoot_rad: f64,
    reversal: Reversal,
    effort_nm2s: f64,
    variation_nm: f64,
    last_torque_nm: Option<f64>,
    estimators: EstimatorScore,
}

/// Where the load was when the reference last passed its middle in either direction.
#[derive(Debug, Clone)]
struct Reversal {
    middle_rad: f64,
    /// How far the reference was above its middle, and where the load was.
    previous: Option<(f64, f64)>,
    upwards_rad: Option<f64>,
    downwards_rad: Option<f64>,
}

impl Reversal {
    const fn new(middle_rad: f64) -> Self {
        Self { middle_rad, previous: None, upwards_rad: None, downwards_rad: None }
    }

    fn push(&mut self, reference_rad: f64, load_position_rad: f64) {
        let above_rad = reference_rad - self.middle_rad;
        if let Some((before_rad, load_before_rad)) = self.previous {
            // The load at the passage itself: between two samples it moves evenly enough.
            let share = before_rad / (before_rad - above_rad);
            let there_rad = load_before_rad + share * (load_position_rad - load_before_rad);
            if before_rad < 0.0 && above_rad >= 0.0 {
                self.upwards_rad = Some(there_rad);
            } else if before_rad > 0.0 && above_rad <= 0.0 {
                self.downwards_rad = Some(there_rad);
            }
        }
        self.previous = Some((above_rad, load_position_rad));
    }

    fn measured(&self) -> Measured {
        match (self.upwards_rad, self.downwards_rad) {
            (Some(upwards_rad), Some(downwards_rad)) => Measured::finite((upwards_rad - downwards_rad).abs()),
            _ => Measured::NoReversal,
        }
    }
}

impl Measurement {
    /// `period_s` is the time between two samples, above 0.
    #[must_use]
    pub fn new(period_s: f64) -> Self {
        Self {
            period_s,
            finite: true,
            initial_error_rad: None,
            settling: Settling::new(SETTLED_RAD),
            settling_shares: [const { Settling::new(f64::NAN) }; 3],
            recent_rad: VecDeque::new(),
            overshoot_rad: 0.0,
            reversal: Reversal::new(f64::NAN),
            effort_nm2s: 0.0,
            variation_nm: 0.0,
            last_torque_nm: None,
            estimators: EstimatorScore::new(window(BIAS_WINDOW_S, period_s)),
        }
    }

    /// The same for a reference that goes back and forth through its middle; `None` for any other.
    #[must_use]
    pub fn with_middle_of_reference(self, middle_rad: Option<f64>) -> Self {
        Self { reversal: Reversal::new(middle_rad.unwrap_or(f64::NAN)), ..self }
    }

    /// The plant could not be followed to the end, though every sample up to then was finite: the run has no figures.
    pub fn diverged(&mut self) {
        self.finite = false;
    }

    /// Takes the next sample; samples come in the order of time, one per period.
    pub fn push(&mut self, sample: &Sample) {
        let &Sample { time_s, reference_rad, load_position_rad, torque_nm, .. } = sample;
        let error_rad = load_position_rad - reference_rad;
        self.finite &= error_rad.is_finite() && torque_nm.is_finite() && time_s.is_finite();
        if !self.finite {
            return;
        }
        let initial_rad = *self.initial_error_rad.get_or_insert(error_rad);
        self.settling.push(time_s, error_rad);
        for (settling, share) in self.settling_shares.iter_mut().zip(SETTLED_SHARES) {
            settling.band_rad = share * initial_rad.abs();
            settling.push(time_s, error_rad);
        }
        self.reversal.push(reference_rad, load_position_rad);
        self.overshoot_rad = self.overshoot_rad.max(-error_rad * initial_rad.signum());
        self.effort_nm2s += torque_nm * torque_nm * self.period_s;
        self.variation_nm += self.last_torque_nm.map_or(0.0, |last_nm| (torque_nm - last_nm).abs());
        self.last_torque_nm = Some(torque_nm);
        self.estimators.push(sample);
        if self.recent_rad.len() == window(HUNTING_WINDOW_S, self.period_s) {
            self.recent_rad.pop_front();
        }
        self.recent_rad.push_back(error_rad);
    }

    /// The metrics of the samples so far.
    #[must_use]
    pub fn metrics(&self) -> Metrics {
        Metrics { values: Metric::ALL.map(|metric| self.measure(metric)), finite: self.finite }
    }

    fn measure(&self, metric: Metric) -> Measured {
        if !self.finite {
            return Measured::NotFinite;
        }
        // Without any sample nothing was measured, not even an effort of 0.
        let Some(initial_rad) = self.initial_error_rad else {
            return Measured::RunTooShort;
        };
        let settled_to_share = |index: usize| match initial_rad {
            0.0 => Measured::NoInitialError,
            _ => self.settling_shares[index].measured(),
        };
        match metric {
            Metric::SettleTime => self.settling.measured(),
            Metric::SettleTime5Pct => settled_to_share(0),
            Metric::SettleTime2Pct => settled_to_share(1),
            Metric::SettleTime1Pct => settled_to_share(2),
            Metric::Overshoot if initial_rad == 0.0 => Measured::NoInitialError,
            Metric::Overshoot => Measured::finite(self.overshoot_rad),
            Metric::StaticError => self.over_last(STATIC_WINDOW_S, mean),
            Metric::Hunting => self.over_last(HUNTING_WINDOW_S, peak_to_peak),
            Metric::LostMotion => self.reversal.measured(),
            Metric::Effort => Measured::finite(self.effort_nm2s),
            Metric::TorqueTotalVariation => Measured::finite(self.variation_nm),
            Metric::DeadZoneEstimate => self.estimators.dead_zone(),
            Metric::DeadZoneError => self.estimators.dead_zone_error(),
            Metric::DeadZoneSettleTime => self.estimators.dead_zone_settle_time(),
            Metric::DeadZoneBias => self.estimators.dead_zone_bias(),
            Metric::DeadZoneLargestError => self.estimators.dead_zone_largest_error(),
            Metric::DisturbingTorqueRmsError => self.estimators.disturbing_torque_rms_error(),
            Metric::DisturbingTorqueBias => self.estimators.disturbing_torque_bias(),
        }
    }

    /// A figure of the errors of the last `window_s`. A run shorter than that has none: a mean over what there
    /// is would call a transient a static error.
    fn over_last(&self, window_s: f64, figure: fn(&mut dyn Iterator<Item = f64>) -> f64) -> Measured {
        match self.recent_rad.len().checked_sub(window(window_s, self.period_s)) {
            Some(earlier) => Measured::finite(figure(&mut self.recent_rad.range(earlier..).copied())),
            None => Measured::RunTooShort,
        }
    }
}

/// Samples in a window, counted rather than compared by time, which is inexact; at least 1.
fn window(window_s: f64, period_s: f64) -> usize {
    ((window_s / period_s).round() as usize).max(1)
}

fn mean(errors_rad: &mut dyn Iterator<Item = f64>) -> f64 {
    let (count, sum) = errors_rad.fold((0.0, 0.0), |(count, sum), error_rad| (count + 1.0, sum + error_rad));
    sum / count
}

/// Of finite numbers: `f64::min` and `f64::max` would drop a NaN.
fn peak_to_peak(errors_rad: &mut dyn Iterator<Item = f64>) -> f64 {
    let (low, high) = errors_rad.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), error_rad| {
        (error_rad.min(low), error_rad.max(high))
    });
    high - low
}

#[cfg(test)]
mod tests;
