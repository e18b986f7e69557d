//! The contract between the Lashloop bench and a drive: messages, and their bytes on the line.
//!
//! The host simulates the mechanics and sends the readings of two encoders; the drive runs its control law and answers with a
//! torque. Nothing else passes between them. An independent implementation of either side has to match this crate only.
//!
//! # A frame
//!
//! ```text
//! offset  0      1      2        3 ..       n-5 .. n-2      n-1
//!         code   kind   number   fields     CRC-32/ISCSI    0x00
//!         └ COBS └─────────── stuffed, so never 0x00 ─────┘ └ delimiter
//! ```
//!
//! - All numbers are little endian. A request carries a number, and its answer repeats it; samples, torques and what a drive sends
//!   unasked have none ([`layout::has_number`]).
//! - A receiver ignores what follows the fields that it knows: a newer peer may have added some. In
//!   [`Telemetry`](message::Telemetry) the last field repeats instead. A list of values is open: see [`enums`].
//! - The CRC covers kind, number and fields before stuffing.
//! - COBS removes every zero from the frame, so a zero always ends a frame. A receiver that lost synchronisation resumes
//!   after the next zero.
//! - No frame is longer than [`MAX_FRAME`] bytes.
//!
//! # Modules, in the order of the bytes
//!
//! | module | holds |
//! |---|---|
//! | [`limits`] | version, delimiter, sizes of a frame |
//! | [`layout`] | description of messages and fields as data: name, type, offset, length, unit |
//! | [`wire`] | how one field and one body are written and read, and the check of a body |
//! | [`enums`], [`counts`], [`text`], [`telemetry_values`] | types of fields |
//! | [`parameter_names`] | names of parameters with a meaning in every drive |
//! | [`message`] | the messages: fields, sender, and when each is sent |
//! | [`field_value`] | value of any field, read by its layout |
//! | [`crc`] | the check value of a body |
//! | [`cobs`] | stuffing: a frame without zeros |
//! | [`frame`] | a body to a frame and back: CRC, COBS and delimiter together |
//! | [`decoder`] | a stream of bytes to messages; resynchronises after noise |
//! | [`sequence`] | sequence numbers of samples across their wraparound |
//! | `fast_path` (feature `fast-path`) | the same frames for samples and torques, faster on a PC |
//! | `codec` (feature `tokio-codec`) | the decoder as a tokio-util codec |
//! | [`hex`] | bytes as hexadecimal digits |
//!
//! `no_std`, no allocation, no unsafe code.

#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

#[cfg(any(test, feature = "tokio-codec"))]
extern crate std;

#[macro_use]
mod macros;

pub mod cobs;
#[cfg(feature = "tokio-codec")]
pub mod codec;
pub mod counts;
pub mod crc;
pub mod decoder;
pub mod enums;
#[cfg(feature = "fast-path")]
mod fast_path;
pub mod field_value;
pub mod frame;
pub mod hex;
pub mod layout;
pub mod limits;
pub mod message;
pub mod parameter_names;
pub mod sequence;
pub mod telemetry_values;
pub mod text;
pub mod wire;

pub use counts::EncoderCounts;
pub use decoder::{Counters, Decoder};
pub use frame::{Frame, FrameError};
pub use limits::{MAX_BODY, MAX_FRAME, MINOR_VERSION, PROTOCOL_VERSION};
pub use message::{DriveMessage, HostMessage, Message, Numbered};
pub use telemetry_values::TelemetryValues;
