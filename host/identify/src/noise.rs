//! What a residual is worth.

/// Standard deviation of the quantisation in counts, 1 / sqrt(12).
pub(crate) const QUANTISATION: f64 = 0.288_675;
/// What a residual is worth, from the residuals themselves: as long as the model is far from the record, the prior keeps
/// the fit from explaining all of it by what the record barely shows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    /// Standard deviation of each encoder, in counts.
    pub(crate) counts: [f64; 2],
}

/// Standard deviations within which nine tenths of normal residuals are.
pub(crate) const NINE_TENTHS: f64 = 1.645;
/// Standard deviations beyond which a residual counts less.
const OUTLIER: f64 = 4.0;

impl Noise {
    /// Square of a residual in units of the noise, of Huber's kind: linear for outliers.
    pub(crate) fn squared(&self, encoder: usize, residual: f64) -> f64 {
        let size = residual.abs() / self.counts[encoder];
        if size <= OUTLIER { size * size } else { OUTLIER * (2.0 * size - OUTLIER) }
    }

    pub(crate) fn weight(&self, encoder: usize, residual: f64) -> f64 {
        (OUTLIER * self.counts[encoder] / residual.abs()).min(1.0)
    }
}
