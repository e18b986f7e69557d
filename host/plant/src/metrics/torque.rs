//! What the drive spends: effort, and total variation of the torque.

use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// Integral of the squared torque, which is held over each period.
#[derive(Debug)]
pub(super) struct Effort {
    period_s: f64,
    effort_nm2s: f64,
}

impl Effort {
    pub(super) const fn new(period_s: f64) -> Self {
        Self { period_s, effort_nm2s: 0.0 }
    }
}

impl Meter for Effort {
    fn push(&mut self, sample: &Sample<'_>) {
        self.effort_nm2s += sample.torque_nm * sample.torque_nm * self.period_s;
    }

    fn measured(&self) -> Measured {
        Measured::finite(self.effort_nm2s)
    }
}

/// Sum of the absolute changes of torque.
#[derive(Debug, Default)]
pub(super) struct TotalVariation {
    last_nm: Option<f64>,
    variation_nm: f64,
}

impl Meter for TotalVariation {
    fn push(&mut self, sample: &Sample<'_>) {
        self.variation_nm += self.last_nm.map_or(0.0, |last_nm| (sample.torque_nm - last_nm).abs());
        self.last_nm = Some(sample.torque_nm);
    }

    fn measured(&self) -> Measured {
        Measured::finite(self.variation_nm)
    }
}
