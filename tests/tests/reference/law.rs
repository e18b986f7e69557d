//! Any of the laws with its state, in either precision.

use lashloop_firmware::control::backlash_inverse::BacklashInverse;
use lashloop_firmware::control::cascade_signals::CascadeSignals;
use lashloop_firmware::control::merzouki::Merzouki;
use lashloop_firmware::control::pd::Pd;
use lashloop_firmware::control::{ControlOutput, Measurement, Real};

#[derive(Debug, Clone)]
pub(crate) enum Law<F: Real> {
    Pd(Pd<F>),
    Merzouki(Merzouki<F>),
    BacklashInverse(BacklashInverse<F>),
}

impl<F: Real> Law<F> {
    pub(crate) fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<CascadeSignals<F>, F> {
        match self {
            Self::Pd(law) => law.step(measurement),
            Self::Merzouki(law) => law.step(measurement),
            Self::BacklashInverse(law) => law.step(measurement),
        }
    }
}
