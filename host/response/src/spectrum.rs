//! The tones of a segment: the discrete Fourier transform of its windows, averaged.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use crate::plan::Segment;

/// Transforms windows of one length.
pub(crate) struct Spectrum {
    transform: Arc<dyn Fft<f64>>,
}

impl Spectrum {
    pub(crate) fn of_windows(window: usize) -> Self {
        Self { transform: FftPlanner::new().plan_fft_forward(window) }
    }

    /// The amplitudes of the tones of a segment, averaged over its windows. A tone is a mean over whole cycles, so a constant
    /// and every other tone leave it alone. A drift is a ramp to it, and is taken away first: by the mean slope since the window
    /// before those that count, which has the same tones.
    pub(crate) fn tones(&self, values: &[f64], segment: &Segment) -> Vec<Complex<f64>> {
        let Segment { first, window, windows, .. } = *segment;
        let sum = |from: usize| values[from..from + window].iter().sum::<f64>();
        let last = first + (windows - 1) * window;
        let slope = (sum(last) - sum(first - window)) / (windows * window * window) as f64;
        let mut mean = vec![Complex::new(0.0, 0.0); window];
        for (step, mean) in mean.iter_mut().enumerate() {
            let values = (0..windows).map(|at| values[first + at * window + step]);
            mean.re = values.sum::<f64>() / windows as f64 - slope * step as f64;
        }
        self.transform.process(&mut mean);
        let scale = 2.0 / window as f64;
        segment.tones.iter().map(|(_, cycles)| mean[*cycles] * scale).collect()
    }
}
