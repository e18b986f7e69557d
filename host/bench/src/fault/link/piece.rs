//! A frame on its way.

use std::ops::Deref;

use lashloop_protocol::MAX_FRAME;
use lashloop_protocol::frame::DELIMITER;

/// A frame with its delimiter, or up to [`MAX_FRAME`] bytes of a stream without delimiters.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    bytes: [u8; MAX_FRAME],
    len: usize,
}

impl Deref for Piece {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.len]
    }
}

impl Piece {
    pub(super) const EMPTY: Self = Self { bytes: [0; MAX_FRAME], len: 0 };

    pub(super) fn push(&mut self, byte: u8) {
        self.bytes[self.len] = byte;
        self.len += 1;
    }

    pub(super) fn remove(&mut self, at: usize) {
        self.bytes.copy_within(at + 1..self.len, at);
        self.len -= 1;
    }

    pub(super) fn flip_bit(&mut self, bit: usize) {
        self.bytes[bit / 8] ^= 1 << (bit % 8);
    }

    pub(super) fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes[..self.len]
    }

    pub(super) fn is_whole(&self) -> bool {
        self.len == MAX_FRAME || self.last() == Some(&DELIMITER)
    }
}
