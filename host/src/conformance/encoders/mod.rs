//! The two encoders: wraparound, speed limits, gaps.

pub(super) mod encoder;
mod gaps;
mod positions;
pub(super) mod setup;
mod speeds;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;

use encoder::Encoder;

use super::answers::sample;
use super::check::Check;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = speeds::checks();
    checks.extend(positions::checks());
    checks.extend(gaps::checks());
    checks
}

/// A sample with one encoder at `counts` and the other at zero.
pub(super) fn placed(encoder: Encoder, sequence: u16, counts: i64) -> EncoderSample {
    let mut sample = sample(sequence);
    *(encoder.counts_mut)(&mut sample) = EncoderCounts::wrapping(counts);
    sample
}
