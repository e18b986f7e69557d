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
    /// and every other tone leave it alone. A drift is a ramp to it, and is taken away first: by the mean slope from a window to
    /// the next one, over at least two windows.
    pub(crate) fn tones(&self, values: &[f64], segment: &Segment) -> Vec<Complex<f64>> {
        let Segment { first, window, windows, .. } = *segment;
        let mut mean = vec![Complex::new(0.0, 0.0); window];
        for at in 0..windows {
            let from = first + at * window;
            for (mean, value) in mean.iter_mut().zip(&values[from..from + window]) {
                mean.re += value / windows as f64;
            }
        }
        if windows > 1 {
            let whole = &values[first..first + windows * window];
            let sum = |window_of: &[f64]| window_of.iter().sum::<f64>();
            let last = sum(&whole[(windows - 1) * window..]);
            let slope = (last - sum(&whole[..window])) / ((windows - 1) * window * window) as f64;
            for (step, mean) in mean.iter_mut().enumerate() {
                mean.re -= slope * step as f64;
            }
        }
        self.transform.process(&mut mean);
        let scale = 2.0 / window as f64;
        segment.tones.iter().map(|(_, cycles)| mean[*cycles] * scale).collect()
    }
}
