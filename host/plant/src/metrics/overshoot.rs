//! Overshoot of the load beyond the reference.

use super::channel::Channel;
use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// Largest amount of the error on the far side of the reference, seen from the first error.
#[derive(Debug, Default)]
pub(super) struct Overshoot {
    first_rad: Option<f64>,
    largest_rad: f64,
}

impl Meter for Overshoot {
    fn push(&mut self, sample: &Sample<'_>) {
        if let Some(error_rad) = Channel::Error.of(sample) {
            let first_rad = *self.first_rad.get_or_insert(error_rad);
            self.largest_rad = self.largest_rad.max(-error_rad * first_rad.signum());
        }
    }

    fn measured(&self) -> Measured {
        match self.first_rad {
            Some(first_rad) if first_rad != 0.0 => Measured::finite(self.largest_rad),
            _ => Measured::NoInitialError,
        }
    }
}
