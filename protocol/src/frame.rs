//! A message as the bytes of one frame, and what can be wrong with a frame.

use core::ops::Deref;

use crate::wire::{BodyError, Payload};
use crate::{cobs, crc};

/// Bytes a frame needs beyond its body: COBS code, CRC, delimiter.
pub const OVERHEAD: usize = 1 + crc::LEN + 1;
/// Longest frame in bytes, everything included.
pub const MAX_FRAME: usize = 64;
/// Longest body in bytes: kind and fields.
pub const MAX_BODY: usize = MAX_FRAME - OVERHEAD;
/// The byte that ends every frame and occurs nowhere else.
pub const DELIMITER: u8 = 0;

/// The bytes of one frame, delimiter included. Dereferences to them.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    bytes: [u8; MAX_FRAME],
    len: usize,
}

impl Frame {
    /// The frame of a message.
    #[inline]
    #[must_use]
    pub fn of<P: Payload>(payload: &P) -> Self {
        Self::written_by(|room| write(payload, room))
    }

    #[inline(always)]
    pub(crate) fn written_by(write: impl FnOnce(&mut [u8; MAX_FRAME]) -> &[u8]) -> Self {
        let mut bytes = [0; MAX_FRAME];
        let len = write(&mut bytes).len();
        Self { bytes, len }
    }
}

impl Deref for Frame {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.len]
    }
}

/// Writes the frame of a message to the beginning of `room` and gives that part of it.
///
/// What `room` holds before doesn't matter.
#[inline]
pub fn write<'room, P: Payload>(payload: &P, room: &'room mut [u8; MAX_FRAME]) -> &'room [u8] {
    payload.put(&mut room[1..=P::LAYOUT.body_len]);
    close(room, P::LAYOUT.body_len);
    &room[..P::LAYOUT.frame_len()]
}

/// Adds all that is not the body: one piece of code for every kind of message.
fn close(room: &mut [u8; MAX_FRAME], body_len: usize) {
    let body_end = 1 + body_len;
    let crc_end = body_end + crc::LEN;
    let checksum = crc::checksum(&room[1..body_end]);
    room[body_end..crc_end].copy_from_slice(&checksum.to_le_bytes());
    cobs::stuff(&mut room[..crc_end]);
    room[crc_end] = DELIMITER;
}

/// Why the bytes between two delimiters are no message. Nothing of them has been used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// No delimiter within the longest frame.
    #[error("{bytes} bytes without a delimiter, a frame has at most {MAX_FRAME}")]
    Oversized {
        /// Bytes thrown away.
        bytes: usize,
    },
    /// The COBS chain does not end at the end of the frame.
    #[error("a frame of {bytes} bytes is not stuffed as COBS asks")]
    Stuffing {
        /// Bytes thrown away.
        bytes: usize,
    },
    /// Too short to hold a kind and a CRC.
    #[error("a frame of {bytes} bytes is too short for a kind and a CRC")]
    TooShort {
        /// Bytes thrown away.
        bytes: usize,
    },
    /// The CRC over the body is not the one in the frame.
    #[error("CRC {found:#010x} in the frame, {expected:#010x} over its body")]
    Crc {
        /// Over the body that arrived.
        expected: u32,
        /// In the frame.
        found: u32,
    },
    /// The frame arrived whole but is no message of this version and direction.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The stream ended inside a frame.
    #[error("the stream ended {bytes} bytes into a frame")]
    Truncated {
        /// Bytes of the frame that had arrived.
        bytes: usize,
    },
}

/// The body of a frame, given the bytes between two delimiters; they are unstuffed in place.
///
/// # Errors
/// Everything in [`FrameError`] that a single frame can show.
#[inline]
pub fn open(stuffed: &mut [u8]) -> Result<&[u8], FrameError> {
    let bytes = stuffed.len();
    let unstuffed = cobs::unstuff(stuffed).ok_or(FrameError::Stuffing { bytes })?;
    let (body, found) = match unstuffed.split_last_chunk::<{ crc::LEN }>() {
        Some((body, crc)) if !body.is_empty() => (body, u32::from_le_bytes(*crc)),
        _ => return Err(FrameError::TooShort { bytes }),
    };
    let expected = crc::checksum(body);
    if expected == found { Ok(body) } else { Err(FrameError::Crc { expected, found }) }
}
