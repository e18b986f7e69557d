//! How often an estimate lies within the standard deviation that it states.

use super::channel::Channel;
use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// Fraction of the estimates whose error exceeds a number of their own standard deviations.
#[derive(Debug)]
pub(super) struct Beyond {
    error: Channel,
    deviation: Channel,
    deviations: f64,
    beyond: u32,
    estimates: u32,
    /// Latched, because comparisons drop NaN.
    finite: bool,
}

impl Beyond {
    pub(super) const fn new(error: Channel, deviation: Channel, deviations: f64) -> Self {
        Self { error, deviation, deviations, beyond: 0, estimates: 0, finite: true }
    }
}

impl Meter for Beyond {
    fn push(&mut self, sample: &Sample<'_>) {
        let (Some(error), Some(deviation)) = (self.error.of(sample), self.deviation.of(sample)) else {
            return;
        };
        self.finite &= error.is_finite() && deviation.is_finite();
        self.estimates += 1;
        self.beyond += u32::from(error.abs() > self.deviations * deviation);
    }

    fn measured(&self) -> Measured {
        match self.estimates {
            0 => Measured::NoTelemetry,
            _ if !self.finite => Measured::NotFinite,
            estimates => Measured::finite(f64::from(self.beyond) / f64::from(estimates)),
        }
    }
}
