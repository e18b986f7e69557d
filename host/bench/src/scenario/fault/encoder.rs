//! Faults of the encoders.

use lashloop_protocol::EncoderCounts;
use serde::Serialize;

use crate::scenario::declare::{integer, number};
use crate::scenario::range::positive;
use crate::settings;

settings! {
    /// The side of the gears that an encoder measures.
    pub enum Side {
        /// The motor.
        "motor" => Motor,
        /// The load.
        "load" => Load,
    }
}

/// Largest offset. More than half the counter's range would wrap around to a smaller offset.
const MOST: i32 = EncoderCounts::MAX.get();

settings! {
    /// Faults of one encoder.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    #[serde(tag = "kind")]
    pub enum EncoderFault {
        /// The reading keeps the count at which the fault began.
        "encoder-stuck" => Stuck {},
        /// The reading is zero.
        "encoder-dead" => Dead {},
        /// The reading is offset at once.
        "encoder-jump" => Jump {
            /// Offset.
            counts: i32 = integer(-MOST..=MOST),
        },
        /// The reading drifts linearly to an offset and keeps it.
        "encoder-offset" => Offset {
            /// Offset.
            counts: i32 = integer(-MOST..=MOST),
            /// Time of the drift.
            over_s: f64 = number(positive(1e5)),
        },
        /// The encoder misses a fraction of each movement, in either direction. Lost counts stay lost after the fault.
        "encoder-lost-counts" => LostCounts {
            /// Fraction of counts lost.
            share: f64 = number(positive(1.0)),
        },
        /// The reading has additional noise, uniform in whole counts.
        "encoder-noise" => Noise {
            /// Amplitude in both directions.
            counts: u32 = integer(1..=1_000_000),
        },
        /// The encoder counts backwards from where the fault began.
        "encoder-reversed" => Reversed {},
    }
}
