//! The numbers of the contract that do not depend on a message: version, delimiter and sizes of a frame.

/// Version of the wire contract, carried by `Hello` and `Identity`.
///
/// The wire version is independent of the release version of the crates. A change of the bytes or of the meaning of an
/// existing message increments the version. A new kind of message that an old peer may ignore does not.
///
/// `Hello`, `Identity` and `Reset` keep their layout in every version, and `State` its five
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

/// Most laws of a drive: one bit each in the two bytes `laws` of a description.
pub const MAX_LAWS: usize = 16;

/// Most signals of a drive: one bit each in the four bytes `signals` of `Subscribe`.
pub const MAX_SIGNALS: usize = 32;

/// Most values of one `Telemetry`: what the longest body holds besides kind and sequence.
pub const MAX_TELEMETRY_VALUES: usize = (MAX_BODY - 1 - size_of::<u16>()) / size_of::<f32>();
