//! Properties of every message and of every stream.

mod bodies;
mod identity;
mod reference;
mod stream;

use proptest::test_runner::{Config, RngSeed};

/// The same cases in every run; `cargo xtask test fuzz` searches for new ones.
fn cases(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(0x1a54_100b), failure_persistence: None, ..Config::default() }
}
