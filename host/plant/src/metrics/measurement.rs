//! Metrics computed sample by sample. Memory is bounded by one window of errors and one of estimates.

use std::collections::VecDeque;

use super::estimator_score::{BIAS_WINDOW_S, EstimatorScore};
use super::lost_motion::Reversal;
use super::metric::{Measured, Metric, Metrics};
use super::sample::Sample;
use super::settling::Settling;

/// The band of `settle_time_s`. The paper doesn't define the end of the transient; this band reproduces its 13 s.
const SETTLED_RAD: f64 = 0.05;
/// The bands of `settle_time_5pct_s` and its like, as fractions of the initial error.
const SETTLED_FRACTIONS: [f64; 3] = [0.05, 0.02, 0.01];
const STATIC_WINDOW_S: f64 = 1.0;
const HUNTING_WINDOW_S: f64 = 10.0;

/// Computes the metrics of one run from its samples.
#[derive(Debug, Clone)]
pub struct Measurement {
    period_s: f64,
    finite: bool,
    initial_error_rad: Option<f64>,
    settling: Settling,
    settling_relative: [Settling; 3],
    /// The errors of the longest window, oldest first.
    recent_rad: VecDeque<f64>,
    overshoot_rad: f64,
    reversal: Reversal,
    effort_nm2s: f64,
    variation_nm: f64,
    last_torque_nm: Option<f64>,
    estimators: EstimatorScore,
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
            settling_relative: [const { Settling::new(f64::NAN) }; 3],
            recent_rad: VecDeque::new(),
            overshoot_rad: 0.0,
            reversal: Reversal::new(f64::NAN),
            effort_nm2s: 0.0,
            variation_nm: 0.0,
            last_torque_nm: None,
            estimators: EstimatorScore::new(window(BIAS_WINDOW_S, period_s)),
        }
    }

    /// Sets the middle of a reference that reverses; `None` for any other reference.
    #[must_use]
    pub fn with_middle_of_reference(self, middle_rad: Option<f64>) -> Self {
        Self { reversal: Reversal::new(middle_rad.unwrap_or(f64::NAN)), ..self }
    }

    /// Marks a run whose plant could not be integrated to the end, though every sample was finite: no metric has a value.
    pub fn diverged(&mut self) {
        self.finite = false;
    }

    /// Adds the next sample, in the order of time, one per period.
    pub fn push(&mut self, sample: &Sample) {
        let &Sample { time_s, reference_rad, load_position_rad, torque_nm, .. } = sample;
        let error_rad = load_position_rad - reference_rad;
        self.finite &= error_rad.is_finite() && torque_nm.is_finite() && time_s.is_finite();
        if !self.finite {
            return;
        }
        let initial_rad = *self.initial_error_rad.get_or_insert(error_rad);
        self.settling.push(time_s, error_rad);
        for (settling, fraction) in self.settling_relative.iter_mut().zip(SETTLED_FRACTIONS) {
            settling.band_rad = fraction * initial_rad.abs();
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
        // Without a sample no metric has a value, not even the effort.
        let Some(initial_rad) = self.initial_error_rad else {
            return Measured::RunTooShort;
        };
        let settled_to_fraction = |index: usize| match initial_rad {
            0.0 => Measured::NoInitialError,
            _ => self.settling_relative[index].measured(),
        };
        match metric {
            Metric::SettleTime => self.settling.measured(),
            Metric::SettleTime5Pct => settled_to_fraction(0),
            Metric::SettleTime2Pct => settled_to_fraction(1),
            Metric::SettleTime1Pct => settled_to_fraction(2),
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

    /// A metric over the errors of the last `window_s`. A shorter run has none: a mean over fewer samples would report a
    /// transient as a static error.
    fn over_last(&self, window_s: f64, figure: fn(&mut dyn Iterator<Item = f64>) -> f64) -> Measured {
        match self.recent_rad.len().checked_sub(window(window_s, self.period_s)) {
            Some(earlier) => Measured::finite(figure(&mut self.recent_rad.range(earlier..).copied())),
            None => Measured::RunTooShort,
        }
    }
}

/// Number of samples in a window, at least 1. We count samples because comparing times is inexact.
fn window(window_s: f64, period_s: f64) -> usize {
    ((window_s / period_s).round() as usize).max(1)
}

fn mean(errors_rad: &mut dyn Iterator<Item = f64>) -> f64 {
    let (count, sum) = errors_rad.fold((0.0, 0.0), |(count, sum), error_rad| (count + 1.0, sum + error_rad));
    sum / count
}

/// Needs finite numbers: `f64::min` and `f64::max` would drop a NaN.
fn peak_to_peak(errors_rad: &mut dyn Iterator<Item = f64>) -> f64 {
    let (low, high) = errors_rad.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), error_rad| {
        (error_rad.min(low), error_rad.max(high))
    });
    high - low
}

#[cfg(test)]
mod tests;
