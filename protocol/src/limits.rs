//! The numbers of the contract that do not depend on a message: version, delimiter and sizes of a frame.

/// Version of the wire contract, carried by `Hello` and `Identity`.
///
/// The wire version is independent of the release version of the crates. A change of the bytes or of the meaning of an
/// existing message increments it. Two sides of different versions identify each other by `Hello` and `Identity`, which keep their
/// layout, and report the mismatch.
pub const PROTOCOL_VERSION: u8 = 1;

/// Additions to [`PROTOCOL_VERSION`]: kinds of message, values of lists, flags, and fields after the last one. Two sides whose
/// minor versions differ understand each other, as each ignores what it doesn't know.
pub const MINOR_VERSION: u8 = 0;

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

/// Most parameters of a drive; larger indices in `DescribeChoice` stand for the lists below.
pub const MAX_PARAMETERS: usize = 240;

/// `DescribeChoice` with this parameter names a fault code of the drive.
pub const FAULT_NAMES: u8 = 255;
/// `DescribeChoice` with this parameter names an outcome of the drive.
pub const OUTCOME_NAMES: u8 = 254;
/// `DescribeChoice` with this parameter names a state of the drive.
pub const STATE_NAMES: u8 = 253;
/// `DescribeChoice` with this parameter names a torque flag of the drive, by its mask.
pub const FLAG_NAMES: u8 = 252;
/// `DescribeChoice` with this parameter names a kind of message that the drive takes or sends.
pub const KIND_NAMES: u8 = 251;

/// Most values of one `Telemetry`: what the longest body holds besides kind and sequence.
pub const MAX_TELEMETRY_VALUES: usize = (MAX_BODY - 1 - size_of::<u16>()) / size_of::<f32>();
