//! The contract of a metric's computation, and what it is built from.

use std::fmt;

use super::channel::Channel;
use super::measured::Measured;
use super::sample::Sample;
use super::signal_table::SignalTable;

/// Computes one quantity, sample by sample. Memory doesn't grow with the run.
pub(super) trait Meter: fmt::Debug + Send {
    /// Takes the next sample, in the order of time, one per period.
    fn push(&mut self, sample: &Sample<'_>);

    /// The quantity of the samples so far, of which there is at least one.
    fn measured(&self) -> Measured;
}

/// A meter, or why the run can't have one.
pub(super) type NewMeter = Result<Box<dyn Meter>, Measured>;

/// What a meter is built from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Setup<'a> {
    /// Time between two samples, above 0.
    pub(super) period_s: f64,
    pub(super) signals: &'a SignalTable,
    /// The middle of a reference that reverses.
    pub(super) middle_rad: Option<f64>,
    /// The reference's value at the last sample, if it is at rest there.
    pub(super) final_rad: Option<f64>,
}

impl Setup<'_> {
    /// Number of samples in a window, at least 1. We count samples because comparing times is inexact.
    pub(super) fn samples(&self, window_s: f64) -> usize {
        ((window_s / self.period_s).round() as usize).max(1)
    }

    /// As [`Channel::needed`].
    pub(super) fn needed(&self, name: &'static str) -> Result<Channel, Measured> {
        Channel::needed(self.signals, name)
    }

    /// As [`Channel::estimate_error`].
    pub(super) fn estimate_error(
        &self,
        estimate: &'static str,
        truth: &'static str,
    ) -> Result<Channel, Measured> {
        Channel::estimate_error(self.signals, estimate, truth)
    }
}
