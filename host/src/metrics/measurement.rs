//! Metrics computed sample by sample; memory is one window of errors, whatever the length of the run.

use std::collections::VecDeque;

use super::{Measured, Metric, Metrics};

/// The band of `settle_time_s`. The paper doesn't say what it calls the end of the transient; with this band
/// its 13 s come out.
const SETTLED_RAD: f64 = 0.05;
/// The band of `settle_time_2pct_s`, as a share of the initial error.
const SETTLED_SHARE: f64 = 0.02;
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
    /// The drive's estimate of j0; NaN if it has none.
    pub dead_zone_estimate_rad: f64,
}

/// Takes the samples of one run and gives its metrics.
#[derive(Debug, Clone)]
pub struct Measurement {
    period_s: f64,
    finite: bool,
    initial_error_rad: Option<f64>,
    settling: Settling,
    settling_2pct: Settling,
    /// The errors of the longest window, oldest first.
    recent_rad: VecDeque<f64>,
    overshoot_rad: f64,
    effort_nm2s: f64,
    variation_nm: f64,
    last_torque_nm: Option<f64>,
    estimate_rad: f64,
}

/// Since when the error has stayed inside a band.
#[derive(Debug, Clone)]
struct Settling {
    band_rad: f64,
    inside_since_s: Option<f64>,
}

impl Settling {
    const fn new(band_rad: f64) -> Self {
        Self { band_rad, inside_since_s: None }
    }

    fn push(&mut self, time_s: f64, error_rad: f64) {
        // An error that is NaN is inside nothing.
        if error_rad.abs() <= self.band_rad {
            self.inside_since_s.get_or_insert(time_s);
        } else {
            self.inside_since_s = None;
        }
    }

    fn measured(&self) -> Measured {
        self.inside_since_s.map_or(Measured::Never, Measured::finite)
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
            settling_2pct: Settling::new(f64::NAN),
            recent_rad: VecDeque::new(),
            overshoot_rad: 0.0,
            effort_nm2s: 0.0,
            variation_nm: 0.0,
            last_torque_nm: None,
            estimate_rad: f64::NAN,
        }
    }

    /// Takes the next sample; samples come in the order of time, one per period.
    pub fn push(&mut self, sample: &Sample) {
        let &Sample { time_s, reference_rad, load_position_rad, torque_nm, dead_zone_estimate_rad } = sample;
        let error_rad = load_position_rad - reference_rad;
        self.finite &= error_rad.is_finite() && torque_nm.is_finite() && time_s.is_finite();
        self.estimate_rad = dead_zone_estimate_rad;
        if !self.finite {
            return;
        }
        let initial_rad = *self.initial_error_rad.get_or_insert(error_rad);
        self.settling.push(time_s, error_rad);
        self.settling_2pct.band_rad = SETTLED_SHARE * initial_rad.abs();
        self.settling_2pct.push(time_s, error_rad);
        self.overshoot_rad = self.overshoot_rad.max(-error_rad * initial_rad.signum());
        self.effort_nm2s += torque_nm * torque_nm * self.period_s;
        self.variation_nm += self.last_torque_nm.map_or(0.0, |last_nm| (torque_nm - last_nm).abs());
        self.last_torque_nm = Some(torque_nm);
        if self.recent_rad.len() == self.window(HUNTING_WINDOW_S) {
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
        match metric {
            Metric::SettleTime => self.settling.measured(),
            Metric::SettleTime2Pct | Metric::Overshoot if initial_rad == 0.0 => Measured::NoInitialError,
            Metric::SettleTime2Pct => self.settling_2pct.measured(),
            Metric::Overshoot => Measured::finite(self.overshoot_rad),
            Metric::StaticError => self.over_last(STATIC_WINDOW_S, mean),
            Metric::Hunting => self.over_last(HUNTING_WINDOW_S, peak_to_peak),
            Metric::Effort => Measured::finite(self.effort_nm2s),
            Metric::TorqueTotalVariation => Measured::finite(self.variation_nm),
            Metric::DeadZoneEstimate => Measured::finite(self.estimate_rad),
        }
    }

    /// A figure of the errors of the last `window_s`. A run shorter than that has none: a mean over what there
    /// is would call a transient a static error.
    fn over_last(&self, window_s: f64, figure: fn(&mut dyn Iterator<Item = f64>) -> f64) -> Measured {
        match self.recent_rad.len().checked_sub(self.window(window_s)) {
            Some(earlier) => Measured::finite(figure(&mut self.recent_rad.range(earlier..).copied())),
            None => Measured::RunTooShort,
        }
    }

    /// Samples in a window, counted rather than compared by time, which is inexact; at least 1.
    fn window(&self, window_s: f64) -> usize {
        ((window_s / self.period_s).round() as usize).max(1)
    }
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
