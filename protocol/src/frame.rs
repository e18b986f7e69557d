//! A body to a frame and back: CRC, COBS and delimiter together, and the errors of a single frame.

use core::ops::Deref;

pub use crate::limits::{DELIMITER, MAX_BODY, MAX_FRAME, OVERHEAD};
use crate::wire::{BodyError, Payload};
use crate::{cobs, crc};

/// The bytes of one frame, delimiter included.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    bytes: [u8; MAX_FRAME],
    len: usize,
}

impl Frame {
    /// The frame of a message, with the number 0 if its kind has one.
    #[inline]
    #[must_use]
    pub fn of<P: Payload>(payload: &P) -> Self {
        Self::written_by(|buffer| write(payload, 0, buffer))
    }

    /// The frame around a body, which need not be one that this version knows.
    ///
    /// # Panics
    /// The body has more than [`MAX_BODY`] bytes.
    #[must_use]
    pub fn around(body: &[u8]) -> Self {
        Self::written_by(|buffer| {
            buffer[1..=body.len()].copy_from_slice(body);
            close(buffer, body.len());
            &buffer[..body.len() + OVERHEAD]
        })
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

/// Writes the frame of a message to the beginning of `buffer` and returns that part. `buffer` need not be cleared.
#[inline]
pub fn write<'buffer, P: Payload>(
    payload: &P,
    number: u8,
    buffer: &'buffer mut [u8; MAX_FRAME],
) -> &'buffer [u8] {
    let body_len = payload.body_len();
    payload.put(number, &mut buffer[1..=body_len]);
    close(buffer, body_len);
    &buffer[..body_len + OVERHEAD]
}

/// Adds CRC, stuffing and delimiter to the body in `buffer[1..]`. Not generic, so that the image holds the code once.
fn close(buffer: &mut [u8; MAX_FRAME], body_len: usize) {
    let body_end = 1 + body_len;
    let crc_end = body_end + crc::LEN;
    let checksum = crc::checksum(&buffer[1..body_end]);
    buffer[body_end..crc_end].copy_from_slice(&checksum.to_le_bytes());
    cobs::stuff(&mut buffer[..crc_end]);
    buffer[crc_end] = DELIMITER;
}

/// The bytes between two delimiters aren't a message. The receiver discards them whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// No delimiter within the longest frame.
    #[error("{bytes} bytes without a delimiter, a frame has at most {MAX_FRAME}")]
    Oversized {
        /// Length received, in bytes.
        bytes: usize,
    },
    /// The COBS chain does not end at the end of the frame.
    #[error("a frame of {bytes} bytes is not valid COBS")]
    Stuffing {
        /// Length received, in bytes.
        bytes: usize,
    },
    /// Too short to hold a kind and a CRC.
    #[error("a frame of {bytes} bytes is too short for a kind and a CRC")]
    TooShort {
        /// Length received, in bytes.
        bytes: usize,
    },
    /// The CRC over the body differs from the CRC in the frame.
    #[error("CRC {found:#010x} in the frame, {expected:#010x} over its body")]
    Crc {
        /// CRC over the received body.
        expected: u32,
        /// CRC in the frame.
        found: u32,
    },
    /// The frame is whole, but of an unknown kind or no message of this direction.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The stream ended inside a frame.
    #[error("the stream ended {bytes} bytes into a frame")]
    Truncated {
        /// Bytes of the frame received before the end.
        bytes: usize,
    },
}

/// Unstuffs the bytes between two delimiters in place, checks the CRC and returns the body.
///
/// # Errors
/// [`FrameError::Stuffing`], [`FrameError::TooShort`] and [`FrameError::Crc`].
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
