//! Random numbers with the same sequence on every machine.
//!
//! The generator is PCG XSL 128/64 (MCG), seeded with 64 bits. Noise of encoders and random faults draw from it, each
//! from a stream of its own, so that a run repeats.

use rand_pcg::rand_core::Rng;

pub use rand_pcg::Pcg64Mcg;
pub use rand_pcg::rand_core::SeedableRng;

/// A number uniform in [0, 1): the upper 53 bits of the next draw.
pub fn uniform(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pins generator and conversion: other numbers would change every run with noise or random faults.
    #[test]
    fn draws_of_a_seed_are_pinned() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let drawn = [(); 3].map(|()| uniform(&mut random).to_bits());
        assert_eq!(drawn, [4605891841464458724, 4594123942923965852, 4602146701336917210]);
    }
}
