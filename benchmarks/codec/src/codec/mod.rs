//! The sides: each with the fastest way its crates offer, into a buffer that is there already.

pub mod floor;
pub mod mavlink;
pub mod ours;
pub mod postcard;
pub mod protobuf;

use crc::{CRC_32_ISCSI, Crc, Table};

/// The CRC the other sides are given: the fastest of the crate, and the same as ours.
pub static CRC_32: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISCSI);

/// A way from a value to the bytes on the line and back. Inlined into the loop that takes the time where
/// that makes a side faster.
pub trait Codec<V>: Default {
    /// Whether a damaged frame would be found.
    const CHECKED: bool = true;

    /// Gives the bytes to `send`.
    fn encode(&mut self, value: &V, send: impl FnOnce(&[u8]));

    /// Reads a frame that is good and whole.
    fn decode(&mut self, frame: &[u8]) -> V;
}
