//! What holds for every message and for every stream, tried on arbitrary ones.

mod bodies;
mod identity;
mod reference;
mod stream;

use proptest::test_runner::{Config, RngSeed};

/// The same cases in every run; `cargo xtask fuzz` is the one that looks for new ones.
fn cases(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(0x1a54_100b), failure_persistence: None, ..Config::default() }
}
