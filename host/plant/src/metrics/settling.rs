//! The settling time into a band.

use super::metric::Measured;

/// The time since which an error has stayed inside a band.
#[derive(Debug, Clone)]
pub(super) struct Settling {
    /// Half width of the band around zero, edges included.
    pub(super) band_rad: f64,
    inside_since_s: Option<f64>,
}

impl Settling {
    pub(super) const fn new(band_rad: f64) -> Self {
        Self { band_rad, inside_since_s: None }
    }

    pub(super) fn push(&mut self, time_s: f64, error_rad: f64) {
        // NaN is inside no band.
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
