//! Writes the seeds of the fuzzers: `cargo run -p tests --example fuzz_seeds`.

use std::io;

#[allow(dead_code, reason = "the test compares, the example writes")]
#[path = "../tests/robustness/seeds.rs"]
mod seeds;

fn main() -> io::Result<()> {
    seeds::seeds().iter().try_for_each(seeds::Seed::write)
}
