//! Settling: the time from which on a quantity stays within a band around zero.

use super::channel::Channel;
use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// Half width of a band around zero, edges included.
#[derive(Debug, Clone, Copy)]
pub(super) enum Band {
    /// In the quantity's unit.
    Absolute(f64),
    /// As a fraction of the first value's amount.
    OfFirst(f64),
}

/// Time from the first sample to the first value after the last one outside the band.
#[derive(Debug)]
pub(super) struct Settling {
    channel: Channel,
    band: Band,
    start_s: Option<f64>,
    /// Half width, known from the first value on.
    half_width: Option<f64>,
    inside_since_s: Option<f64>,
    /// Latched, because comparisons drop NaN.
    finite: bool,
}

impl Settling {
    pub(super) const fn new(channel: Channel, band: Band) -> Self {
        Self { channel, band, start_s: None, half_width: None, inside_since_s: None, finite: true }
    }
}

impl Meter for Settling {
    fn push(&mut self, sample: &Sample<'_>) {
        self.start_s.get_or_insert(sample.time_s);
        let Some(value) = self.channel.of(sample) else { return };
        self.finite &= value.is_finite();
        let half_width = *self.half_width.get_or_insert(match self.band {
            Band::Absolute(half_width) => half_width,
            Band::OfFirst(fraction) => fraction * value.abs(),
        });
        // NaN is inside no band.
        if value.abs() <= half_width {
            self.inside_since_s.get_or_insert(sample.time_s);
        } else {
            self.inside_since_s = None;
        }
    }

    fn measured(&self) -> Measured {
        let (Some(start_s), Some(half_width)) = (self.start_s, self.half_width) else {
            return Measured::NoTelemetry;
        };
        if !self.finite {
            return Measured::NotFinite;
        }
        if half_width == 0.0 {
            return Measured::NoInitialError;
        }
        self.inside_since_s.map_or(Measured::Never, |since_s| Measured::finite(since_s - start_s))
    }
}

/// Largest amount of a quantity since its first value within a band, settled or not.
#[derive(Debug)]
pub(super) struct LargestOnceInside {
    channel: Channel,
    half_width: f64,
    any: bool,
    largest: Option<f64>,
    finite: bool,
}

impl LargestOnceInside {
    pub(super) const fn new(channel: Channel, half_width: f64) -> Self {
        Self { channel, half_width, any: false, largest: None, finite: true }
    }
}

impl Meter for LargestOnceInside {
    fn push(&mut self, sample: &Sample<'_>) {
        let Some(value) = self.channel.of(sample) else { return };
        self.any = true;
        self.finite &= value.is_finite();
        if self.largest.is_some() || value.abs() <= self.half_width {
            self.largest = Some(self.largest.unwrap_or(0.0).max(value.abs()));
        }
    }

    fn measured(&self) -> Measured {
        match self.largest {
            _ if !self.any => Measured::NoTelemetry,
            _ if !self.finite => Measured::NotFinite,
            None => Measured::Never,
            Some(largest) => Measured::finite(largest),
        }
    }
}
