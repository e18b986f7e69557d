//! What the loop does about a load that swings through its target and comes out on the other side.
//!
//! Stiction that breaks loose, or a load on a spring, can carry the load through the band of arrival again and again. Each
//! time that it comes out beyond the error of release on the other side is a crossing. One crossing is an overshoot, and changes
//! nothing. After the second, hold and release are wider by a factor: friction then holds the load where it stands. Each further
//! one makes the loop slower. A new reference makes everything as it was. Until the second crossing both factors are 1.

use crate::law::{Measurement, Real};

/// Arrival and release after the second crossing, relative to those before it.
const HUNTING_BANDS: f64 = 4.0;
/// Speed of the loop after a further crossing relative to the one before it, and the least of all.
const CALMING: f64 = 0.7;
const CALMEST: f64 = 0.2;

/// The crossings of the present reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HuntingState<F> {
    reference_rad: F,
    /// Sign of the last error beyond release; 0 before one.
    side: F,
    overshot: bool,
    /// Factor on the errors of arrival and of release.
    pub(super) widening: F,
    /// Factor on curve and gain of the velocity loop; its square is that on the integral gain.
    pub(super) calm: F,
}

impl<F: Real> HuntingState<F> {
    /// No crossing of this reference.
    pub(super) fn at(reference_rad: F) -> Self {
        Self { reference_rad, side: F::ZERO, overshot: false, widening: F::ONE, calm: F::ONE }
    }

    /// Counts the crossing that this sample's error may be. `release_rad` is the error of release before a crossing.
    #[inline(always)]
    pub(super) fn step(&mut self, m: &Measurement<F>, error_rad: F, release_rad: F) {
        if m.reference_position_rad != self.reference_rad {
            *self = Self::at(m.reference_position_rad);
        }
        let side = error_rad.sign();
        if side == self.side || error_rad.abs() <= self.widening * release_rad {
            return;
        }
        if self.overshot {
            if self.widening != F::ONE {
                self.calm = (F::from_f64(CALMING) * self.calm).clamp(F::from_f64(CALMEST), F::ONE);
            }
            self.widening = F::from_f64(HUNTING_BANDS);
        }
        self.overshot = self.side != F::ZERO;
        self.side = side;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RELEASE_RAD: f64 = 0.004;

    /// Widening and calm after these errors in mrad at one reference.
    fn after(state: &mut HuntingState<f64>, reference_rad: f64, errors_mrad: &[f64]) -> (f64, f64) {
        for error_mrad in errors_mrad {
            let m = Measurement { reference_position_rad: reference_rad, ..Measurement::default() };
            state.step(&m, 1e-3 * error_mrad, RELEASE_RAD);
        }
        (state.widening, state.calm)
    }

    #[test]
    fn a_good_landing_changes_nothing() {
        let mut state = HuntingState::at(0.0);
        assert_eq!(after(&mut state, 0.0, &[1570.0, 50.0, 3.0, -3.9, 3.9, 0.0]), (1.0, 1.0));
        assert_eq!(after(&mut state, 0.0, &[20.0, 3.0, 20.0]), (1.0, 1.0), "out on the side where it was");
    }

    #[test]
    fn the_second_crossing_widens_the_hold_and_further_ones_calm_the_loop() {
        let mut state = HuntingState::at(0.0);
        assert_eq!(after(&mut state, 0.0, &[1570.0, -4.1, -9.0, 3.9]), (1.0, 1.0), "an overshoot");
        assert_eq!(after(&mut state, 0.0, &[4.1, 9.0]), (4.0, 1.0));
        assert_eq!(after(&mut state, 0.0, &[-15.9]), (4.0, 1.0), "within the release that is now wider");
        assert_eq!(after(&mut state, 0.0, &[-16.1]), (4.0, 0.7));
        let (_, calm) = after(&mut state, 0.0, &[50.0, -50.0, 50.0, -50.0, 50.0, -50.0]);
        assert_eq!(calm, 0.2);
    }

    #[test]
    fn a_new_reference_starts_anew_and_is_not_a_crossing() {
        let mut state = HuntingState::at(0.0);
        after(&mut state, 0.0, &[1570.0, -20.0, 20.0, -20.0]);
        assert_eq!(after(&mut state, 1.0, &[-980.0, -2.0]), (1.0, 1.0));
        assert_eq!(after(&mut state, 0.0, &[1000.0, 2.0]), (1.0, 1.0));
    }
}
