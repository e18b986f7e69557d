//! Numbers in [0, 1) by index: random streams, and the permutation of a Latin hypercube.
//!
//! A stream is a Pcg64 whose seed is SHA-256 of the campaign's seed and of the stream's name. Number i of a stream depends on
//! no other number, so a case can be drawn alone.

use lashloop_plant::random;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};
use sha2::{Digest as _, Sha256};

/// A random stream.
#[derive(Debug, Clone)]
pub struct Stream(Pcg64);

impl Stream {
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Self {
        let hash = Sha256::new().chain_update(seed.to_le_bytes()).chain_update(name).finalize();
        Self(Pcg64::from_seed(hash.into()))
    }

    /// Number `index` of the stream, uniform in [0, 1).
    #[must_use]
    pub fn at(&self, index: u64) -> f64 {
        let mut generator = self.0.clone();
        generator.advance(index.into());
        random::uniform(&mut generator)
    }

    /// The first 64 bits of the stream, as a key.
    #[must_use]
    pub fn key(&self) -> u64 {
        self.0.clone().next_u64()
    }
}

const ROUNDS: u32 = 6;

/// Position of `index` in a permutation of 0 to `count` - 1, without a table of all positions: a Feistel network over the
/// next power of four, walked until it returns into the range.
///
/// # Panics
/// Never: an index outside the range is reduced to it.
#[must_use]
pub fn permuted(key: u64, index: u64, count: u64) -> u64 {
    let count = count.max(1);
    let half = (u64::BITS - (count - 1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1 << half) - 1;
    let mut position = index % count;
    loop {
        let (mut left, mut right) = (position >> half, position & mask);
        for round in 0..ROUNDS {
            (left, right) = (right, left ^ (mixed(key ^ u64::from(round) << 56 ^ right) & mask));
        }
        position = left << half | right;
        if position < count {
            return position;
        }
    }
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014).
const fn mixed(mut bits: u64) -> u64 {
    bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_of_a_permutation_has_a_position_of_its_own() {
        for count in [1, 2, 3, 5, 64, 1000, 4097] {
            let mut positions: Vec<_> = (0..count).map(|index| permuted(7, index, count)).collect();
            assert!(count < 5 || positions != (0..count).collect::<Vec<_>>(), "{count} stay in order");
            positions.sort_unstable();
            assert_eq!(positions, (0..count).collect::<Vec<_>>());
        }
        assert_ne!(permuted(1, 5, 1000), permuted(2, 5, 1000), "the key counts");
    }

    #[test]
    fn permuted_neighbours_are_independent() {
        let count = 10_000_u32;
        let at = |index| permuted(3, index, count.into()) as f64 / f64::from(count) - 0.5;
        let sum: f64 = (0..9_999).map(|index| at(index) * at(index + 1)).sum();
        // The standard deviation of this correlation is 0.01.
        assert!(
            (12.0 * sum / f64::from(count)).abs() < 0.04,
            "correlation {}",
            12.0 * sum / f64::from(count)
        );
    }

    #[test]
    fn a_number_depends_on_seed_stream_and_index() {
        let number = |seed, name: &str, index| Stream::new(seed, name).at(index).to_bits();
        let one = number(1, "plant.dead_zone_rad", 7);
        assert_eq!(one, number(1, "plant.dead_zone_rad", 7));
        assert_ne!(one, number(2, "plant.dead_zone_rad", 7));
        assert_ne!(one, number(1, "plant.stiffness_nm_rad", 7));
        assert_ne!(one, number(1, "plant.dead_zone_rad", 8));
    }
}
