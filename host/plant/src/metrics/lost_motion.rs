//! Lost motion under a reference that reverses.

use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// The load's positions at the reference's last passages through its middle.
#[derive(Debug)]
pub(super) struct Reversal {
    /// The middle of a reference that reverses.
    middle_rad: Option<f64>,
    /// Distance of the reference above its middle, and position of the load, at the previous sample.
    previous: Option<(f64, f64)>,
    upwards_rad: Option<f64>,
    downwards_rad: Option<f64>,
}

impl Reversal {
    pub(super) const fn new(middle_rad: Option<f64>) -> Self {
        Self { middle_rad, previous: None, upwards_rad: None, downwards_rad: None }
    }
}

impl Meter for Reversal {
    fn push(&mut self, sample: &Sample<'_>) {
        let Some(middle_rad) = self.middle_rad else { return };
        let load_position_rad = sample.load_position_rad;
        let above_rad = sample.reference_rad - middle_rad;
        if let Some((before_rad, load_before_rad)) = self.previous {
            // The load at the passage, by linear interpolation between the two samples.
            let fraction = before_rad / (before_rad - above_rad);
            let load_rad = load_before_rad + fraction * (load_position_rad - load_before_rad);
            if before_rad < 0.0 && above_rad >= 0.0 {
                self.upwards_rad = Some(load_rad);
            } else if before_rad > 0.0 && above_rad <= 0.0 {
                self.downwards_rad = Some(load_rad);
            }
        }
        self.previous = Some((above_rad, load_position_rad));
    }

    fn measured(&self) -> Measured {
        match (self.upwards_rad, self.downwards_rad) {
            (Some(upwards_rad), Some(downwards_rad)) => Measured::finite((upwards_rad - downwards_rad).abs()),
            _ => Measured::NoReversal,
        }
    }
}
