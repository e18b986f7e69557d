//! The codecs, each by the fastest method of its crates, into a preallocated buffer.

pub mod floor;
mod framing;
pub mod mavlink;
pub mod ours;
pub mod postcard;
pub mod protobuf;

use crc::{CRC_32_ISCSI, Crc, Table};

/// CRC of the other codecs: the same as ours, in the fastest variant of the `crc` crate.
pub static CRC_32: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISCSI);

/// A codec of one kind of message. Inlined into the measuring loop where that is faster.
pub trait Codec<V>: Default {
    /// Whether the codec detects a damaged frame.
    const CHECKED: bool = true;

    /// Encodes a value and passes the frame to `send`.
    fn encode(&mut self, value: &V, send: impl FnOnce(&[u8]));

    /// Decodes a whole and correct frame.
    fn decode(&mut self, frame: &[u8]) -> V;
}
