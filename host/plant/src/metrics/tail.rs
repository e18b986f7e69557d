//! Figures over the last samples of a run.

use std::collections::VecDeque;

use super::channel::Channel;
use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// What is computed from the values of the window.
#[derive(Debug, Clone, Copy)]
pub(super) enum Figure {
    Mean,
    /// Within the second half of the run only: the first is the transient.
    PeakToPeak,
}

/// A figure over the last samples. A shorter run has none: a mean over fewer samples would report a transient as a static
/// error.
#[derive(Debug)]
pub(super) struct Tail {
    channel: Channel,
    figure: Figure,
    /// Length of the window in samples.
    window: usize,
    /// Number of samples, with or without a value.
    samples: usize,
    /// Values in the window, oldest first, each with the number of its sample.
    recent: VecDeque<(usize, f64)>,
    /// Latched, because comparisons drop NaN.
    finite: bool,
}

impl Tail {
    /// `window` is counted in samples.
    pub(super) fn new(channel: Channel, figure: Figure, window: usize) -> Self {
        // Ten seconds of the shortest control period fit, so that no step of a run allocates.
        let recent = VecDeque::with_capacity(window.min(1 << 17));
        Self { channel, figure, window, samples: 0, recent, finite: true }
    }
}

impl Meter for Tail {
    fn push(&mut self, sample: &Sample<'_>) {
        self.samples += 1;
        let (samples, window) = (self.samples, self.window);
        while self.recent.pop_front_if(|(sample, _)| *sample + window <= samples).is_some() {}
        if let Some(value) = self.channel.of(sample) {
            self.finite &= value.is_finite();
            self.recent.push_back((samples, value));
        }
    }

    fn measured(&self) -> Measured {
        if !self.finite {
            return Measured::NotFinite;
        }
        if self.samples < self.window {
            return Measured::RunTooShort;
        }
        if self.recent.is_empty() {
            return Measured::NoTelemetry;
        }
        let values = |first| self.recent.iter().filter(move |(at, _)| *at > first).map(|(_, value)| *value);
        Measured::finite(match self.figure {
            Figure::Mean => values(0).sum::<f64>() / self.recent.len() as f64,
            Figure::PeakToPeak => {
                let (low, high) = values(self.samples / 2)
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                        (value.min(low), value.max(high))
                    });
                high - low
            }
        })
    }
}
