//! The numbers of the contract that do not depend on a message: version, delimiter and sizes of a frame.

/// Version of the wire contract, carried by [`Hello`](struct@crate::message::Hello) and
/// [`Identity`](struct@crate::message::Identity).
///
/// The wire version is independent of the release version of the crates. A change of the bytes or of the meaning of an
/// existing message increments the version. A new kind of message that an old peer may ignore does not.
///
/// `Hello`, `Identity` and `Reset` keep their layout in every version, and [`State`](crate::enums::State) its five
/// values. Two sides of different versions can therefore always identify each other and report the mismatch.
pub const PROTOCOL_VERSION: u8 = 1;

/// The byte that ends every frame and occurs nowhere else.
pub const DELIMITER: u8 = 0;

/// Length of the CRC, in bytes.
pub const CRC_LEN: usize = 4;

/// Bytes of a frame beyond its body: COBS code, CRC, delimiter.
pub const OVERHEAD: usize = 1 + CRC_LEN + 1;

/// Longest frame, in bytes, COBS code and delimiter included.
///
/// One USB full-speed packet holds it, and COBS needs no second code byte.
pub const MAX_FRAME: usize = 64;

/// Longest body, in bytes: kind and fields.
pub const MAX_BODY: usize = MAX_FRAME - OVERHEAD;
