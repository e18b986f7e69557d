//! The end of an approach: inside a band around its target the load is held by friction.
//!
//! An integral under stiction hunts, for any gains. No law of this crate corrects inside the band, and each releases the
//! larger part of its torque once on arrival.

use core::f32::consts::TAU;

use lashloop_firmware::law::{DriveParameters, Measurement};

/// Fraction of torque or integral that remains on arrival.
pub(crate) const REMAINING: f32 = 0.3;
/// Smallest band, and smallest distance of release, in counts of the load encoder.
const BAND_COUNTS: f32 = 0.55;
const RELEASE_COUNTS: f32 = 1.05;
/// Load error that ends the hold, in bands.
const RELEASE_BANDS: f32 = 2.0;

lashloop_firmware::parameters! {
    /// Where an approach ends.
    pub struct ArrivalBand {
        /// Load error of arrival.
        arrival_band_rad: F32 = 0.002 in 0.0..=1.0, "rad";
    }
}

/// Phase of a movement at one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    Approaching,
    /// The first sample inside the band.
    Arriving,
    Holding,
}

/// The band with its state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrival {
    band_rad: f32,
    release_rad: f32,
    holding: bool,
}

impl Arrival {
    pub(crate) fn new(band: ArrivalBand, drive: &DriveParameters) -> Self {
        let count_rad = TAU / drive.load_counts_per_rev as f32;
        let band_rad = band.arrival_band_rad;
        Self {
            // Half a count: the decoded position is the middle of a count.
            band_rad: (band_rad - 0.5 * count_rad).max(BAND_COUNTS * count_rad),
            release_rad: RELEASE_BANDS * band_rad.max(RELEASE_COUNTS * count_rad),
            holding: false,
        }
    }

    pub(crate) fn step(&mut self, m: &Measurement<f32>) -> Phase {
        let distance_rad = (m.load_position_rad - m.reference_position_rad).abs();
        let held = self.holding;
        let outside_rad = if held { self.release_rad } else { self.band_rad };
        self.holding = m.reference_velocity_rad_s == 0.0 && distance_rad <= outside_rad;
        match (held, self.holding) {
            (_, false) => Phase::Approaching,
            (false, true) => Phase::Arriving,
            (true, true) => Phase::Holding,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn load_is_held_from_the_band_to_twice_the_band() {
        let mut arrival = Arrival::new(ArrivalBand { arrival_band_rad: 0.002 }, &DriveParameters::default());
        let mut phase =
            |load_position_rad| arrival.step(&Measurement { load_position_rad, ..Measurement::default() });
        let have = [-0.0021, -0.0019, 0.0039, 0.0041, 0.0039].map(&mut phase);
        let [approaching, holding] = [Phase::Approaching, Phase::Holding];
        assert_eq!(have, [approaching, Phase::Arriving, holding, approaching, approaching]);
    }

    #[test]
    fn load_is_not_held_under_a_moving_reference() {
        let mut arrival = Arrival::new(ArrivalBand::default(), &DriveParameters::default());
        let moving = Measurement { reference_velocity_rad_s: 0.1, ..Measurement::default() };
        assert_eq!(arrival.step(&moving), Phase::Approaching);
    }
}
