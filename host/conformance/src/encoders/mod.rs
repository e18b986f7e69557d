//! The two encoders: wraparound, speed limits, gaps.

pub(super) mod encoder;
mod gaps;
mod positions;
pub(super) mod setup;
mod speeds;

use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = speeds::checks();
    checks.extend(positions::checks());
    checks.extend(gaps::checks());
    checks
}
