//! Rise time of the load's response.

use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// Fractions of the way between which the rise is timed.
const FROM: f64 = 0.1;
const TO: f64 = 0.9;

/// Time from the load's first sample at 10 % of its way to its first at 90 %. The way leads from the load's first position
/// to the reference's last value.
#[derive(Debug)]
pub(super) struct RiseTime {
    /// The reference's last value, if it is at rest there.
    final_rad: Option<f64>,
    first_rad: Option<f64>,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

impl RiseTime {
    pub(super) const fn new(final_rad: Option<f64>) -> Self {
        Self { final_rad, first_rad: None, from_s: None, to_s: None }
    }
}

impl Meter for RiseTime {
    fn push(&mut self, sample: &Sample<'_>) {
        let first_rad = *self.first_rad.get_or_insert(sample.load_position_rad);
        let Some(final_rad) = self.final_rad else { return };
        // A way of length zero gives NaN, or infinities that `measured` omits.
        let covered = (sample.load_position_rad - first_rad) / (final_rad - first_rad);
        if covered >= FROM {
            self.from_s.get_or_insert(sample.time_s);
        }
        if covered >= TO {
            self.to_s.get_or_insert(sample.time_s);
        }
    }

    fn measured(&self) -> Measured {
        match (self.final_rad, self.from_s, self.to_s) {
            (None, ..) => Measured::NoEndOfMotion,
            (final_rad, ..) if final_rad == self.first_rad => Measured::NoInitialError,
            (_, Some(from_s), Some(to_s)) => Measured::finite(to_s - from_s),
            _ => Measured::Never,
        }
    }
}
