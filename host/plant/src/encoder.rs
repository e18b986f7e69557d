//! An incremental encoder: a position becomes a count.
//!
//! n = floor(theta counts / 2 pi), without wraparound; the width of a reading is the wire's.
//!
//! Noise stands for jitter of the edges: a displacement before the count is taken, uniform in +-`noise_counts`, from a
//! generator with the same sequence on every machine.

use core::f64::consts::TAU;

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Parameter of an encoder outside its allowed range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("encoder parameter {name} is {value}, allowed is {low} to {high}")]
pub struct EncoderError {
    /// Name of the parameter, with its unit.
    pub name: &'static str,
    /// The value given.
    pub value: f64,
    /// Smallest allowed value.
    pub low: f64,
    /// Largest allowed value.
    pub high: f64,
}

/// An encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    counts_per_rad: f64,
    noise_counts: f64,
}

/// What an encoder remembers: where its noise has got to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EncoderState {
    noise: Pcg64Mcg,
}

impl Encoder {
    /// An encoder of `counts_per_revolution` counts, after quadrature, whose edges jitter evenly within
    /// +-`noise_counts`.
    ///
    /// # Errors
    /// Names the parameter outside its range: 4 to 2^28 counts, 0 to 1000 counts of noise.
    pub fn new(counts_per_revolution: u32, noise_counts: f64) -> Result<Self, EncoderError> {
        let counts = f64::from(counts_per_revolution);
        within("counts_per_revolution", counts, 4.0, f64::from(1 << 28))?;
        within("noise_counts", noise_counts, 0.0, 1000.0)?;
        Ok(Self { counts_per_rad: counts / TAU, noise_counts })
    }

    /// The noise generator, PCG XSL 128/64 (MCG), started from a seed.
    pub fn initial_state(&self, seed: u64) -> EncoderState {
        EncoderState { noise: Pcg64Mcg::seed_from_u64(seed) }
    }

    /// The count at a position in rad. A position that is no number reads as nought, an
    /// infinite one as the end of the range of `i64`.
    pub fn step(&self, state: &mut EncoderState, position_rad: f64) -> i64 {
        let mut counts = position_rad * self.counts_per_rad;
        if self.noise_counts > 0.0 {
            // The upper 53 bits of the draw, evenly in [-1, 1).
            let draw = (state.noise.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 52) as f64) - 1.0;
            counts += self.noise_counts * draw;
        }
        libm::floor(counts) as i64
    }
}

fn within(name: &'static str, value: f64, low: f64, high: f64) -> Result<(), EncoderError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(EncoderError { name, value, low, high }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(encoder: &Encoder, position_rad: f64) -> i64 {
        encoder.step(&mut encoder.initial_state(1), position_rad)
    }

    #[test]
    fn count_is_the_floor_on_both_sides_of_nought() {
        let encoder = Encoder::new(1000, 0.0).expect("valid");
        let one = TAU / 1000.0;
        assert_eq!([-1.5, -0.5, 0.5, 1.5].map(|n| counts(&encoder, n * one)), [-2, -1, 0, 1]);
    }

    #[test]
    fn noise_fills_its_band_evenly_and_repeats_with_its_seed() {
        let encoder = Encoder::new(1000, 3.0).expect("valid");
        let draw = |seed| {
            let mut state = encoder.initial_state(seed);
            (0..60_000).map(|_| encoder.step(&mut state, 0.0)).collect::<Vec<_>>()
        };
        let drawn = draw(7);
        for n in -3..3 {
            let share = drawn.iter().filter(|&&count| count == n).count() as f64 / 60_000.0;
            assert!((share - 1.0 / 6.0).abs() < 0.01, "count {n}: have {share}, want 1/6 +- 0.01");
        }
        assert!(drawn.iter().all(|count| (-3..3).contains(count)));
        assert_eq!(drawn, draw(7));
        assert_ne!(drawn, draw(8));
    }

    #[test]
    fn an_encoder_without_counts_is_refused_by_name() {
        let error = Encoder::new(0, 0.0).expect_err("no counts");
        assert_eq!(
            error.to_string(),
            "encoder parameter counts_per_revolution is 0, allowed is 4 to 268435456"
        );
    }
}
