//! An incremental encoder: n = floor(theta counts / 2 pi), without wraparound; the wire sets the width of a reading.
//!
//! A disk off its axis shows theta + e sin(theta) instead of theta. Noise stands for jitter of the edges: before the count
//! is taken, the position is displaced uniformly within +-`noise_counts`.

use core::f64::consts::TAU;

use crate::ParameterError;
use crate::error::within;
use crate::random::{Pcg64Mcg, SeedableRng, uniform};

/// Smallest number of counts per revolution, after quadrature: one line.
pub const MIN_COUNTS_PER_REV: u32 = 4;
/// Largest number of counts per revolution, after quadrature: the count of the wire and of the drive has 24 bits.
pub const MAX_COUNTS_PER_REV: u32 = 1 << 24;
/// Largest amplitude of the noise in counts.
pub const MAX_NOISE_COUNTS: f64 = 1000.0;
/// Largest eccentricity in rad; the shown angle still rises with the true one.
pub const MAX_ECCENTRICITY_RAD: f64 = 0.5;

/// An encoder and the state of its noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoder {
    counts_per_rad: f64,
    eccentricity_rad: f64,
    noise_counts: f64,
    noise: Pcg64Mcg,
}

impl Encoder {
    /// An encoder of `counts_per_revolution` counts, after quadrature, whose edges jitter uniformly within
    /// +-`noise_counts`; `seed` starts the noise.
    ///
    /// # Errors
    /// Names the parameter outside its range: [`MIN_COUNTS_PER_REV`] to [`MAX_COUNTS_PER_REV`], 0 to
    /// [`MAX_NOISE_COUNTS`].
    pub fn new(counts_per_revolution: u32, noise_counts: f64, seed: u64) -> Result<Self, ParameterError> {
        let counts = f64::from(counts_per_revolution);
        let [low, high] = [MIN_COUNTS_PER_REV, MAX_COUNTS_PER_REV].map(f64::from);
        within("counts_per_revolution", counts, low, high)?;
        within("noise_counts", noise_counts, 0.0, MAX_NOISE_COUNTS)?;
        let noise = Pcg64Mcg::seed_from_u64(seed);
        Ok(Self { counts_per_rad: counts / TAU, eccentricity_rad: 0.0, noise_counts, noise })
    }

    /// The same encoder on a disk off its axis: it shows theta + `eccentricity_rad` sin(theta).
    ///
    /// # Errors
    /// The eccentricity is outside 0 to [`MAX_ECCENTRICITY_RAD`].
    pub fn with_eccentricity(self, eccentricity_rad: f64) -> Result<Self, ParameterError> {
        within("eccentricity_rad", eccentricity_rad, 0.0, MAX_ECCENTRICITY_RAD)?;
        Ok(Self { eccentricity_rad, ..self })
    }

    /// The same encoder after `readings` readings: its noise continues from there.
    #[must_use]
    pub fn after(mut self, readings: u64) -> Self {
        if self.noise_counts > 0.0 {
            self.noise.advance(readings.into());
        }
        self
    }

    /// The count at a position in rad. NaN reads as zero, an infinite position as the end of the range of `i64`; with
    /// eccentricity it reads as zero.
    pub fn read(&mut self, position_rad: f64) -> i64 {
        let mut shown_rad = position_rad;
        if self.eccentricity_rad > 0.0 {
            shown_rad += self.eccentricity_rad * libm::sin(position_rad);
        }
        let mut counts = shown_rad * self.counts_per_rad;
        if self.noise_counts > 0.0 {
            counts += self.noise_counts * (2.0 * uniform(&mut self.noise) - 1.0);
        }
        libm::floor(counts) as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn count_is_the_floor_on_both_sides_of_zero() {
        let mut encoder = Encoder::new(1000, 0.0, 1).expect("valid");
        let one = TAU / 1000.0;
        assert_eq!([-1.5, -0.5, 0.5, 1.5].map(|n| encoder.read(n * one)), [-2, -1, 0, 1]);
    }

    #[test]
    fn a_disk_off_its_axis_errs_once_per_turn_and_closes() {
        let one = TAU / 1000.0;
        let mut round = Encoder::new(1000, 0.0, 1).expect("valid");
        let mut off_axis = round.clone().with_eccentricity(10.5 * one).expect("in range");
        let mut error =
            |turns: f64| off_axis.read(turns * TAU + 0.1 * one) - round.read(turns * TAU + 0.1 * one);
        assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0, -0.25].map(&mut error), [0, 10, 0, -11, 0, -11]);
    }

    #[test]
    fn noise_fills_its_band_uniformly_and_repeats_with_its_seed() {
        let readings = |seed| {
            let mut encoder = Encoder::new(1000, 3.0, seed).expect("valid");
            (0..60_000).map(|_| encoder.read(0.0)).collect::<Vec<_>>()
        };
        let have = readings(7);
        for n in -3..3 {
            let fraction = have.iter().filter(|&&count| count == n).count() as f64 / 60_000.0;
            assert!((fraction - 1.0 / 6.0).abs() < 0.01, "count {n}: have {fraction}, want 1/6 +- 0.01");
        }
        assert!(have.iter().all(|count| (-3..3).contains(count)));
        assert_eq!(have, readings(7));
        assert_ne!(have, readings(8));
    }

    #[test]
    fn resolution_and_noise_out_of_range_are_rejected() {
        let rejected = |counts, noise| Encoder::new(counts, noise, 1).expect_err("out of range");
        let want = "parameter counts_per_revolution of the simulated plant is 0, allowed is 4 to 16777216";
        assert_eq!(rejected(0, 0.0).to_string(), want);
        assert_eq!(rejected(MIN_COUNTS_PER_REV - 1, 0.0).name, "counts_per_revolution");
        assert_eq!(rejected(MAX_COUNTS_PER_REV + 1, 0.0).name, "counts_per_revolution");
        assert_eq!(rejected(1000, MAX_NOISE_COUNTS + 1.0).name, "noise_counts");
        let finest = Encoder::new(MAX_COUNTS_PER_REV, MAX_NOISE_COUNTS, 1).expect("at its limits");
        let off_axis = finest.with_eccentricity(1.01 * MAX_ECCENTRICITY_RAD);
        assert_eq!(off_axis.expect_err("out of range").name, "eccentricity_rad");
    }
}
