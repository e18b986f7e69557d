//! Since when something has stayed inside a band.

use super::Measured;

/// The end of a transient, seen so far.
#[derive(Debug, Clone)]
pub(super) struct Settling {
    /// Half the band around zero, edges inside.
    pub(super) band_rad: f64,
    inside_since_s: Option<f64>,
}

impl Settling {
    pub(super) const fn new(band_rad: f64) -> Self {
        Self { band_rad, inside_since_s: None }
    }

    pub(super) fn push(&mut self, time_s: f64, error_rad: f64) {
        // An error that is NaN is inside nothing.
        if error_rad.abs() <= self.band_rad {
            self.inside_since_s.get_or_insert(time_s);
        } else {
            self.inside_since_s = None;
        }
    }

    pub(super) fn is_inside(&self) -> bool {
        self.inside_since_s.is_some()
    }

    pub(super) fn measured(&self) -> Measured {
        self.inside_since_s.map_or(Measured::Never, Measured::finite)
    }
}
