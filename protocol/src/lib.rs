//! The contract between the Lashloop bench and a drive: what may be said on the line, and how it looks in bytes.
//!
//! The host simulates the mechanics and sends what the two encoders would read; the drive runs its controller and
//! answers with a torque. Nothing else passes between them, so this crate is all that a foreign implementation of
//! either side has to match.
//!
//! # A frame
//!
//! ```text
//! offset  0      1        2 ..            n-5 .. n-2       n-1
//!         code   kind     fields          CRC-32/ISCSI     0x00
//!         └ COBS └──────────── stuffed, so never 0x00 ───┘ └ delimiter
//! ```
//!
//! - All numbers are little endian; every kind of message has one fixed length ([`message`] lists them,
//!   [`layout::MessageLayout`] describes each as data).
//! - The CRC ([`crc`]) covers kind and fields as they are before stuffing.
//! - COBS ([`cobs`]) removes every zero from the frame, so a zero always ends one: a receiver that lost its place
//!   waits for the next zero and is in step again ([`decoder`]).
//! - No frame is longer than [`MAX_FRAME`] bytes. That keeps a USB full-speed packet whole and the COBS code byte
//!   the only overhead.
//!
//! # Layers, in the order of the bytes
//!
//! | module | does |
//! |---|---|
//! | [`message`], [`vocabulary`], [`counts`], [`sequence`], [`text`] | values: what is said |
//! | [`wire`], [`layout`] | bytes: where each field lies and how it is checked |
//! | [`crc`], [`cobs`], [`frame`] | a body becomes a frame |
//! | [`decoder`] | a stream becomes messages again, whatever lies between them |
//! | `quick` (feature `fast-path`) | the same bytes for samples and torques, faster on a PC |
//! | `codec` (feature `tokio-codec`) | the same decoder as a tokio-util codec |
//!
//! `no_std`, no allocation, no unsafe code.

#![no_std]
#![forbid(unsafe_code)]

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
pub mod frame;
pub mod layout;
pub mod message;
pub mod sequence;
pub mod text;
pub mod wire;

pub use counts::EncoderCounts;
pub use decoder::{Counters, Decoder};
pub use frame::{Frame, FrameError, MAX_BODY, MAX_FRAME};
pub use message::{DriveMessage, HostMessage, Message};

/// Version of the wire contract, carried by [`message::Hello`] and [`message::Identity`].
///
/// It is apart from the release version of the crates. It changes whenever the bytes or the meaning of an existing
/// message change; a new kind of message that an old peer may ignore does not change it. `Hello`, `Identity` and
/// `Reset` keep their layout in every version, and [`enums::State`] its five values, so that two versions can always
/// tell each other who they are and refuse each other by name.
pub const PROTOCOL_VERSION: u8 = 1;
