//! A stream of bytes, in pieces of any size, to messages.
//!
//! The decoder buffers at most one frame. It counts and discards bytes that belong to no frame, and decodes the frame after the
//! next delimiter correctly. Host and drive use the same decoder.

use crate::cobs;
use crate::frame::{self, FrameError};
use crate::limits::MAX_FRAME;
use crate::message::{Message, Numbered};
use crate::wire::BodyError;

/// Statistics of a decoder. All counts saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Messages decoded.
    pub messages: u32,
    /// Bytes of rejected frames, delimiters included.
    pub discarded_bytes: u32,
    /// Frames longer than [`MAX_FRAME`].
    pub oversized: u32,
    /// Frames with invalid stuffing, or too short for a CRC.
    pub malformed: u32,
    /// Frames with a wrong CRC.
    pub crc_errors: u32,
    /// Whole frames that aren't messages of this direction.
    pub refused: u32,
    /// Whole frames of a kind that a newer peer added.
    pub unknown: u32,
}

impl Counters {
    /// Damaged frames: oversized, malformed, or with a wrong CRC.
    #[must_use]
    pub const fn damaged(&self) -> u32 {
        self.oversized.saturating_add(self.malformed).saturating_add(self.crc_errors)
    }

    fn count(&mut self, error: &FrameError, bytes: usize) {
        let class = match error {
            FrameError::Body(BodyError::UnknownKind { .. }) => {
                self.unknown = self.unknown.saturating_add(1);
                return;
            }
            FrameError::Oversized { .. } => &mut self.oversized,
            FrameError::Stuffing { .. } | FrameError::TooShort { .. } | FrameError::Truncated { .. } => {
                &mut self.malformed
            }
            FrameError::Crc { .. } => &mut self.crc_errors,
            FrameError::Body(_) => &mut self.refused,
        };
        *class = class.saturating_add(1);
        self.discarded_bytes = self.discarded_bytes.saturating_add(u32::try_from(bytes).unwrap_or(u32::MAX));
    }
}

/// The incremental decoder.
#[derive(Clone, Debug)]
pub struct Decoder {
    partial: [u8; MAX_FRAME - 1],
    /// Bytes since the last delimiter; those beyond the length of `partial` are counted but not kept.
    pending: usize,
    counters: Counters,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder at the start of a frame.
    #[must_use]
    pub fn new() -> Self {
        Self { partial: [0; MAX_FRAME - 1], pending: 0, counters: Counters::default() }
    }

    /// The next message or bad frame in `input`, which advances past it; `None` at the end of `input`.
    ///
    /// Consecutive delimiters are not frames: a sender clears the line with them.
    ///
    /// # Errors
    /// The inner result holds the error of a bad frame. The decoder continues after that frame.
    #[cfg_attr(feature = "fast-path", inline(always))]
    pub fn next<M: Message>(&mut self, input: &mut &[u8]) -> Option<Result<Numbered<M>, FrameError>> {
        #[cfg(feature = "fast-path")]
        if self.pending == 0
            && let Some((message, rest)) = M::split_off_periodic(input)
        {
            *input = rest;
            self.counters.messages = self.counters.messages.saturating_add(1);
            return Some(Ok(Numbered { number: 0, message }));
        }
        self.next_of_any_kind(input).transpose()
    }

    #[cfg_attr(feature = "fast-path", inline(never))]
    fn next_of_any_kind<M: Message>(&mut self, input: &mut &[u8]) -> Result<Option<Numbered<M>>, FrameError> {
        while let Some(end) = cobs::find_zero(input) {
            let (piece, rest) = (&input[..end], &input[end + 1..]);
            *input = rest;
            self.append(piece);
            if self.pending > 0 {
                return self.close().map(Some);
            }
        }
        self.append(input);
        *input = &[];
        Ok(None)
    }

    /// Ends the stream.
    ///
    /// # Errors
    /// [`FrameError::Truncated`] if the stream ends inside a frame. A stream may end between frames.
    pub fn finish(&mut self) -> Result<(), FrameError> {
        let bytes = core::mem::take(&mut self.pending);
        if bytes == 0 {
            return Ok(());
        }
        let error = FrameError::Truncated { bytes };
        self.counters.count(&error, bytes);
        Err(error)
    }

    /// Discards a partial frame without counting it, after the line was reopened.
    pub fn forget_partial(&mut self) {
        self.pending = 0;
    }

    /// Statistics since the decoder was created.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    fn append(&mut self, piece: &[u8]) {
        if let Some(free) = self.partial.get_mut(self.pending..self.pending + piece.len()) {
            free.copy_from_slice(piece);
        }
        self.pending = self.pending.saturating_add(piece.len());
    }

    fn close<M: Message>(&mut self) -> Result<Numbered<M>, FrameError> {
        let bytes = core::mem::take(&mut self.pending);
        let result = match self.partial.get_mut(..bytes) {
            Some(stuffed) => frame::open(stuffed).and_then(|body| Ok(M::decode_body(body)?)),
            None => Err(FrameError::Oversized { bytes: bytes + 1 }),
        };
        match &result {
            Ok(_) => self.counters.messages = self.counters.messages.saturating_add(1),
            Err(error) => self.counters.count(error, bytes + 1),
        }
        result
    }
}
