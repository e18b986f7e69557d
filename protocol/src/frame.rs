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
        let mut plain = [0; 2 + 64];
        let body_end = 1 + P::LAYOUT.body_len;
        payload.put(&mut plain[1..body_end]);
        let checksum = crc::checksum(&plain[1..body_end]);
        let crc_end = body_end + crc::LEN;
        plain[body_end..crc_end].copy_from_slice(&checksum.to_le_bytes());
        let mut zeros = 0;
        let (words, _) = plain[2..].as_chunks();
        for (at, word) in words.iter().enumerate() {
            if 2 + 8 * at < crc_end {
                zeros |= u64::from(cobs::zeros_of(u64::from_le_bytes(*word))) << (2 + 8 * at);
            }
        }
        let mut frame = Self { bytes: [0; MAX_FRAME], len: crc_end + 1 };
        frame.bytes[1] = plain[1];
        let (to, rest) = frame.bytes[2..].as_chunks_mut();
        for (to, word) in to.iter_mut().zip(words) {
            *to = *word;
        }
        rest.copy_from_slice(&plain[58..64]);
        cobs::link(&mut frame.bytes, zeros, crc_end);
        frame
    }

    /// Adds all that is not the body: one piece of code for every kind of message, but on a PC one for each.
    #[cfg_attr(feature = "wide-crc-tables", inline(always))]
    fn close(&mut self, body_len: usize) {
        let body_end = 1 + body_len;
        let crc_end = body_end + crc::LEN;
        let checksum = crc::checksum(&self.bytes[1..body_end]);
        self.bytes[body_end..crc_end].copy_from_slice(&checksum.to_le_bytes());
        cobs::stuff(&mut self.bytes[..crc_end]);
    }
}

impl Deref for Frame {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.len]
    }
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

#[cfg(feature = "wide-crc-tables")]
#[inline(always)]
pub(crate) fn split_off<P: Payload>(input: &[u8]) -> Option<(P, &[u8])> {
    let (body_len, end) = (P::LAYOUT.body_len, P::LAYOUT.frame_len() - 1);
    let (frame, rest) = input.split_at_checked(end + 1)?;
    if frame[1] != P::LAYOUT.kind || cobs::find_zero(frame) != Some(end) {
        return None;
    }
    let links = cobs::links(frame)?;
    if links & 0b10 != 0 {
        return None;
    }
    // Body and CRC as they were, from the code byte on.
    let mut plain = [0; 2 + 64];
    plain[1] = P::LAYOUT.kind;
    let mut at = 2;
    while at < end {
        let to = if at + 8 <= end + 1 { at + 8 } else { end + 1 };
        let mut word = [0; 8];
        word[..to - at].copy_from_slice(&frame[at..to]);
        let word = u64::from_le_bytes(word) & cobs::KEPT[usize::from((links >> at) as u8)];
        plain[at..at + 8].copy_from_slice(&word.to_le_bytes());
        at += 8;
    }
    let body = &plain[1..1 + body_len];
    let found = plain[1 + body_len..].first_chunk()?;
    if crc::checksum(body) != u32::from_le_bytes(*found) {
        return None;
    }
    Some((P::get(body).ok()?, rest))
}
