//! Faults of the link: of the frames on it, and of the connection.

use serde::Serialize;

use crate::scenario::declare::{integer, number};
use crate::scenario::range::positive;
use crate::settings;

settings! {
    /// Directions of the link that a fault strikes.
    pub enum Way {
        /// Both directions, each with a random stream of its own.
        "both" => Both,
        /// From the bench to the drive.
        "to-drive" => ToDrive,
        /// From the drive to the bench.
        "to-bench" => ToBench,
    }
}

settings! {
    /// Faults of frames. `share` is the fraction of frames hit.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    #[serde(tag = "kind")]
    pub enum FrameFault {
        /// A frame loses one byte.
        "link-byte-loss" => ByteLoss {
            /// Fraction of frames hit.
            share: f64 = number(positive(1.0)),
        },
        /// One bit of a frame is flipped.
        "link-bit-flip" => BitFlip {
            /// Fraction of frames hit.
            share: f64 = number(positive(1.0)),
        },
        /// A burst of consecutive bytes of a frame is replaced by random ones.
        "link-burst" => Burst {
            /// Fraction of frames hit.
            share: f64 = number(positive(1.0)),
            /// Bytes of the burst. A shorter frame is replaced whole.
            bytes: u32 = integer(1..=64).or(8),
        },
        /// A frame arrives twice.
        "link-duplicate" => Duplicate {
            /// Fraction of frames hit.
            share: f64 = number(positive(1.0)),
        },
        /// A frame arrives after its successor.
        "link-reorder" => Reorder {
            /// Fraction of frames hit.
            share: f64 = number(positive(1.0)),
        },
        /// Every frame arrives later by delay and jitter, in the link's time. Frames keep their order.
        "link-delay" => Delay {
            /// Constant part of the delay.
            delay_ms: f64 = number(0.0..=1e4),
            /// Upper end of a uniform random part.
            jitter_ms: f64 = number(0.0..=1e4).or(0.0),
        },
        /// Frames are held back, and all arrive when the fault ends.
        "link-stall" => Stall {},
    }
}

settings! {
    /// Faults of the connection.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    #[serde(tag = "kind")]
    pub enum LinkFault {
        /// The link is disconnected and comes back when the fault ends.
        "link-cut" => Cut {},
    }
}
