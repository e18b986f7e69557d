//! Faults of the encoders.

use lashloop_protocol::EncoderCounts;
use serde::Serialize;

use super::kinds::fault_kinds;
use crate::scenario::keys::{fraction, integer, number};
use crate::scenario::range::positive;
use crate::scenario::reader::Section;

/// The side of the gears that an encoder measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The motor.
    Motor,
    /// The load.
    Load,
}

impl Side {
    /// Reads the key `side`.
    pub(super) fn read(section: &mut Section<'_>) -> Self {
        let choices = [("motor", Self::Motor), ("load", Self::Load)];
        section.doc("The encoder's side of the gears.").choice("side", None, &choices).unwrap_or(Self::Motor)
    }
}

/// An offset in counts. More than half the counter's range would wrap around to a smaller offset.
fn offset_counts(section: &mut Section<'_>, key: &'static str) -> i32 {
    let most = EncoderCounts::MAX.get();
    section.integer(key, None, -most..=most)
}

fault_kinds! {
    /// Faults of one encoder.
    pub enum EncoderFault {
        /// The reading keeps the count at which the fault began.
        "encoder-stuck" => Stuck {}
        /// The reading is zero.
        "encoder-dead" => Dead {}
        /// The reading is offset at once.
        "encoder-jump" => Jump {
            /// Offset.
            counts: i32 = offset_counts,
        }
        /// The reading drifts linearly to an offset and keeps it.
        "encoder-offset" => Offset {
            /// Offset.
            counts: i32 = offset_counts,
            /// Time of the drift.
            over_s: f64 = number(positive(1e5)),
        }
        /// The encoder misses a fraction of each movement, in either direction. Lost counts stay lost after the fault.
        "encoder-lost-counts" => LostCounts {
            /// Fraction of counts lost.
            share: f64 = fraction,
        }
        /// The reading has additional noise, uniform in whole counts.
        "encoder-noise" => Noise {
            /// Amplitude, either way.
            counts: u32 = integer(1..=1_000_000),
        }
        /// The encoder counts backwards from where the fault began.
        "encoder-reversed" => Reversed {}
    }
}
