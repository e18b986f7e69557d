//! Steady velocity error: the position error while the reference moves at constant velocity.

use std::collections::VecDeque;

use super::channel::Channel;
use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// Rounding of a reference and of its time, in units of the last place.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Mean lag over the last samples of the reference's last stretch of constant velocity. A shorter stretch has none, because
/// its error would still be a transient.
#[derive(Debug)]
pub(super) struct SteadyVelocityError {
    period_s: f64,
    /// Length of the window in samples.
    window: usize,
    previous_rad: Option<f64>,
    /// Change of the reference at the previous sample.
    change_rad: f64,
    /// Lags of the present stretch, at most one window of them, oldest first.
    lags_rad: VecDeque<f64>,
    /// The mean of the last stretch that was long enough.
    last_rad: Option<f64>,
}

impl SteadyVelocityError {
    /// `window` is counted in samples.
    pub(super) fn new(period_s: f64, window: usize) -> Self {
        let lags_rad = VecDeque::with_capacity(window.min(1 << 17));
        Self { period_s, window, previous_rad: None, change_rad: 0.0, lags_rad, last_rad: None }
    }

    /// The mean lag of the present stretch, if it is long enough.
    fn present_rad(&self) -> Option<f64> {
        let full = self.lags_rad.len() == self.window;
        full.then(|| self.lags_rad.iter().sum::<f64>() / self.window as f64)
    }
}

impl Meter for SteadyVelocityError {
    fn push(&mut self, sample: &Sample<'_>) {
        let &Sample { time_s, reference_rad, .. } = sample;
        let Some(previous_rad) = self.previous_rad.replace(reference_rad) else { return };
        let change_rad = reference_rad - previous_rad;
        let before_rad = std::mem::replace(&mut self.change_rad, change_rad);
        let travelled_rad = change_rad * time_s / self.period_s;
        let rounding_rad = ROUNDING * (reference_rad.abs() + previous_rad.abs() + travelled_rad.abs());
        if change_rad == 0.0 || (change_rad - before_rad).abs() > rounding_rad {
            self.last_rad = self.present_rad().or(self.last_rad);
            self.lags_rad.clear();
            return;
        }
        if self.lags_rad.len() == self.window {
            self.lags_rad.pop_front();
        }
        if let Some(error_rad) = Channel::Error.of(sample) {
            self.lags_rad.push_back(-error_rad * change_rad.signum());
        }
    }

    fn measured(&self) -> Measured {
        self.present_rad().or(self.last_rad).map_or(Measured::NoSteadyVelocity, Measured::finite)
    }
}
