//! Faults of the link: of the frames on it, and of the connection.

use serde::Serialize;

use super::kinds::fault_kinds;
use crate::scenario::keys::{fraction, integer_or, number, number_or};
use crate::scenario::reader::Section;

/// Directions of the link that a fault strikes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// From the bench to the drive.
    ToDrive,
    /// From the drive to the bench.
    ToBench,
    /// Both directions, each with a random stream of its own.
    Both,
}

impl Way {
    /// Reads the key `way`.
    pub(super) fn read(section: &mut Section<'_>) -> Self {
        let choices = [("both", Self::Both), ("to-drive", Self::ToDrive), ("to-bench", Self::ToBench)];
        section.doc("Direction of the frames.").choice("way", Self::Both, &choices).unwrap_or(Self::Both)
    }
}

fault_kinds! {
    /// Faults of frames. `share` is the fraction of frames hit.
    pub enum FrameFault {
        /// A frame loses one byte.
        "link-byte-loss" => ByteLoss {
            /// Fraction of frames hit.
            share: f64 = fraction,
        }
        /// One bit of a frame is flipped.
        "link-bit-flip" => BitFlip {
            /// Fraction of frames hit.
            share: f64 = fraction,
        }
        /// A burst of consecutive bytes of a frame is replaced by random ones.
        "link-burst" => Burst {
            /// Fraction of frames hit.
            share: f64 = fraction,
            /// Bytes of the burst. A shorter frame is replaced whole.
            bytes: u32 = integer_or(8, 1..=64),
        }
        /// A frame arrives twice.
        "link-duplicate" => Duplicate {
            /// Fraction of frames hit.
            share: f64 = fraction,
        }
        /// A frame arrives after its successor.
        "link-reorder" => Reorder {
            /// Fraction of frames hit.
            share: f64 = fraction,
        }
        /// Every frame arrives later by delay and jitter, in the link's time. Frames keep their order.
        "link-delay" => Delay {
            /// Constant part of the delay.
            delay_ms: f64 = number(0.0..=1e4),
            /// Upper end of a uniform random part.
            jitter_ms: f64 = number_or(0.0, 0.0..=1e4),
        }
        /// Frames are held back, and all arrive when the fault ends.
        "link-stall" => Stall {}
    }
}

fault_kinds! {
    /// Faults of the connection.
    pub enum LinkFault {
        /// The link is disconnected and comes back when the fault ends.
        "link-cut" => Cut lasts WallClock {}
    }
}
