//! From a stream of bytes to messages, in pieces of any size, with anything in between.
//!
//! The decoder keeps at most one frame. Bytes that belong to no frame are counted and dropped; whatever they were,
//! the frame after the next delimiter is read correctly again. There is one decoder for both ends of the line.

use crate::cobs;
use crate::frame::{self, FrameError, MAX_FRAME};
use crate::message::Message;

/// What a decoder has seen. All counts stay at their largest value instead of wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Good messages.
    pub messages: u32,
    /// Bytes thrown away with bad frames, their delimiters included.
    pub discarded_bytes: u32,
    /// Frames longer than a frame can be.
    pub oversized: u32,
    /// Frames with broken stuffing or too short for a CRC.
    pub malformed: u32,
    /// Frames whose CRC was wrong.
    pub crc_errors: u32,
    /// Whole frames that were no message of this direction and version.
    pub refused: u32,
}

impl Counters {
    /// Frames that arrived damaged, in whatever way.
    #[must_use]
    pub const fn damaged(&self) -> u32 {
        self.oversized.saturating_add(self.malformed).saturating_add(self.crc_errors)
    }

    fn count(&mut self, error: &FrameError, bytes: usize) {
        let class = match error {
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
    /// Bytes since the last delimiter; beyond `partial`'s length they are only counted.
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
    pub const fn new() -> Self {
        Self {
            partial: [0; MAX_FRAME - 1],
            pending: 0,
            counters: Counters {
                messages: 0,
                discarded_bytes: 0,
                oversized: 0,
                malformed: 0,
                crc_errors: 0,
                refused: 0,
            },
        }
    }

    /// The next message or bad frame in `input`, which is advanced past it; `None` once `input` is used up.
    ///
    /// Delimiters without anything between them are not frames: they are how a sender clears the line.
    ///
    /// # Errors
    /// The inner result says what was wrong with a frame; the decoder has already gone past it.
    #[cfg_attr(feature = "fast-path", inline(always))]
    pub fn next<M: Message>(&mut self, input: &mut &[u8]) -> Option<Result<M, FrameError>> {
        #[cfg(feature = "fast-path")]
        if self.pending == 0
            && let Some((message, rest)) = M::split_off_periodic(input)
        {
            *input = rest;
            self.counters.messages = self.counters.messages.saturating_add(1);
            return Some(Ok(message));
        }
        self.next_of_any_kind(input).transpose()
    }

    #[cfg_attr(feature = "fast-path", inline(never))]
    fn next_of_any_kind<M: Message>(&mut self, input: &mut &[u8]) -> Result<Option<M>, FrameError> {
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
    /// [`FrameError::Truncated`] if it ends inside a frame; between frames is where a stream may end.
    pub fn finish(&mut self) -> Result<(), FrameError> {
        let bytes = core::mem::take(&mut self.pending);
        if bytes == 0 {
            return Ok(());
        }
        let error = FrameError::Truncated { bytes };
        self.counters.count(&error, bytes);
        Err(error)
    }

    /// Forgets the frame it is in, which will not go on: the line was opened anew. Nothing is counted.
    pub fn forget_partial(&mut self) {
        self.pending = 0;
    }

    /// What has been seen so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    fn append(&mut self, piece: &[u8]) {
        if let Some(room) = self.partial.get_mut(self.pending..self.pending + piece.len()) {
            room.copy_from_slice(piece);
        }
        self.pending = self.pending.saturating_add(piece.len());
    }

    fn close<M: Message>(&mut self) -> Result<M, FrameError> {
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
