//! Random streams of faults.

use lashloop_plant::random::{Pcg64Mcg, SeedableRng, uniform};

use crate::scenario::Scenario;

/// The stream of a fault by its index in the scenario; `direction` tells the two directions of a link apart. No stream is
/// that of another fault or of the encoders' noise.
pub(super) fn stream(scenario: &Scenario, fault: usize, direction: u64) -> Pcg64Mcg {
    const STREAM: u64 = 0xd1b5_4a32_d192_ed03;
    Pcg64Mcg::seed_from_u64(scenario.run.seed ^ STREAM.wrapping_mul(2 * fault as u64 + direction + 1))
}

/// Uniform over the whole numbers below `end`, which is far below 2^32.
pub(super) fn uniform_below(random: &mut Pcg64Mcg, end: usize) -> usize {
    (uniform(random) * end as f64) as usize
}
