//! The committed seeds of the fuzzers.

use crate::seeds::seeds;

#[test]
fn the_committed_seeds_match_the_examples() {
    let stale: Vec<_> = seeds().into_iter().filter(|seed| !seed.is_committed()).collect();
    assert!(stale.is_empty(), "stale: {stale:?}; write them by `cargo run -p tests --example fuzz_seeds`");
}
