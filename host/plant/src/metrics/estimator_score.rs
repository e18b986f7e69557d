//! Scores of the drive's estimates against the truth, sample by sample.

use std::collections::VecDeque;

use super::metric::Measured;
use super::sample::Sample;
use super::settling::Settling;

/// The band of `dead_zone_settle_time_s`: an eighth of the paper's half gap, above the error that motor friction and lag
/// leave in a good estimate.
const SETTLED_RAD: f64 = 0.02;
/// The window of `dead_zone_bias_rad`.
pub(super) const BIAS_WINDOW_S: f64 = 5.0;

/// The scores of the estimates so far.
#[derive(Debug, Clone)]
pub(super) struct EstimatorScore {
    /// Number of samples, with or without an estimate.
    samples: usize,
    bias_window: usize,
    dead_zone_rad: f64,
    dead_zone_error_rad: f64,
    /// Latched, because comparisons drop NaN.
    dead_zone_is_finite: bool,
    settling: Settling,
    largest_error_rad: Option<f64>,
    /// Errors in the window, oldest first, each with the number of its sample.
    recent_rad: VecDeque<(usize, f64)>,
    estimates: f64,
    sum_nm: f64,
    sum_of_squares_nm2: f64,
}

impl EstimatorScore {
    /// `bias_window` is counted in samples.
    pub(super) fn new(bias_window: usize) -> Self {
        Self {
            samples: 0,
            bias_window,
            dead_zone_rad: f64::NAN,
            dead_zone_error_rad: f64::NAN,
            dead_zone_is_finite: true,
            settling: Settling::new(SETTLED_RAD),
            largest_error_rad: None,
            recent_rad: VecDeque::new(),
            estimates: 0.0,
            sum_nm: 0.0,
            sum_of_squares_nm2: 0.0,
        }
    }

    pub(super) fn push(&mut self, sample: &Sample) {
        if let Some(estimates) = sample.estimates {
            self.estimates += 1.0;
            self.dead_zone_rad = estimates.dead_zone_rad;
            self.push_dead_zone(sample.time_s, estimates.dead_zone_rad - sample.dead_zone_rad);
            let error_nm = estimates.disturbing_torque_nm - sample.disturbing_torque_nm;
            self.sum_nm += error_nm;
            self.sum_of_squares_nm2 += error_nm * error_nm;
        }
        self.samples += 1;
        let window = self.bias_window;
        let samples = self.samples;
        while self.recent_rad.pop_front_if(|(sample, _)| *sample + window < samples).is_some() {}
    }

    fn push_dead_zone(&mut self, time_s: f64, error_rad: f64) {
        self.dead_zone_error_rad = error_rad;
        self.dead_zone_is_finite &= error_rad.is_finite();
        self.settling.push(time_s, error_rad);
        self.largest_error_rad = match self.largest_error_rad {
            None if !self.settling.is_inside() => None,
            largest_rad => Some(largest_rad.unwrap_or(0.0).max(error_rad.abs())),
        };
        self.recent_rad.push_back((self.samples, error_rad));
    }

    pub(super) fn dead_zone(&self) -> Measured {
        self.if_estimated(|| Measured::finite(self.dead_zone_rad))
    }

    pub(super) fn dead_zone_error(&self) -> Measured {
        self.if_estimated(|| Measured::finite(self.dead_zone_error_rad))
    }

    pub(super) fn dead_zone_settle_time(&self) -> Measured {
        self.if_dead_zone_is_finite(|| self.settling.measured())
    }

    pub(super) fn dead_zone_largest_error(&self) -> Measured {
        self.if_dead_zone_is_finite(|| self.largest_error_rad.map_or(Measured::Never, Measured::finite))
    }

    pub(super) fn dead_zone_bias(&self) -> Measured {
        self.if_dead_zone_is_finite(|| {
            if self.samples < self.bias_window {
                return Measured::RunTooShort;
            }
            if self.recent_rad.is_empty() {
                return Measured::NoEstimate;
            }
            let sum_rad: f64 = self.recent_rad.iter().map(|(_, error_rad)| error_rad).sum();
            Measured::finite(sum_rad / self.recent_rad.len() as f64)
        })
    }

    pub(super) fn disturbing_torque_rms_error(&self) -> Measured {
        self.if_estimated(|| Measured::finite((self.sum_of_squares_nm2 / self.estimates).sqrt()))
    }

    pub(super) fn disturbing_torque_bias(&self) -> Measured {
        self.if_estimated(|| Measured::finite(self.sum_nm / self.estimates))
    }

    fn if_estimated(&self, measure: impl FnOnce() -> Measured) -> Measured {
        if self.estimates > 0.0 { measure() } else { Measured::NoEstimate }
    }

    fn if_dead_zone_is_finite(&self, measure: impl FnOnce() -> Measured) -> Measured {
        self.if_estimated(|| if self.dead_zone_is_finite { measure() } else { Measured::NotFinite })
    }
}

#[cfg(test)]
mod tests;
