//! The interface to the messages of one direction, for decoder and senders.

use crate::frame::Frame;
use crate::layout::MessageLayout;
use crate::limits::MAX_FRAME;
use crate::wire::BodyError;

/// A message, and the number of the request that it is or answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbered<M> {
    /// 1 to 255 as the host chose it, 0 for none; 0 in every kind without a number.
    pub number: u8,
    /// The message.
    pub message: M,
}

impl<M> Numbered<M> {
    /// Another message with the same number.
    #[inline]
    pub fn map<N>(self, f: impl FnOnce(M) -> N) -> Numbered<N> {
        Numbered { number: self.number, message: f(self.message) }
    }
}

/// All messages of one direction.
pub trait Message: Sized {
    /// The layouts of all kinds, in the order of their kind byte.
    const LAYOUTS: &'static [MessageLayout];

    /// Decodes a body whose CRC is correct.
    ///
    /// # Errors
    /// The body isn't a message of this direction.
    fn decode_body(body: &[u8]) -> Result<Numbered<Self>, BodyError>;

    /// Splits `input` after its first frame, if that frame is whole, correct and of the kind sent in every control period.
    /// `None` for any other input, which the caller decodes on the general path.
    #[cfg(feature = "fast-path")]
    #[inline(always)]
    fn split_off_periodic(_input: &[u8]) -> Option<(Self, &[u8])> {
        None
    }

    /// The layout of this message.
    fn layout(&self) -> &'static MessageLayout;

    /// Writes the whole frame to the beginning of `buffer` and returns that part, ready to send. A kind without a number ignores
    /// `number`.
    ///
    /// `buffer` need not be cleared; the bytes after the frame are undefined.
    fn write_numbered<'buffer>(&self, number: u8, buffer: &'buffer mut [u8; MAX_FRAME]) -> &'buffer [u8];

    /// Writes the frame with the number 0, as [`Message::write_numbered`].
    #[inline(always)]
    fn write_frame<'buffer>(&self, buffer: &'buffer mut [u8; MAX_FRAME]) -> &'buffer [u8] {
        self.write_numbered(0, buffer)
    }

    /// The whole frame as a value, with the number 0. [`Message::write_frame`] saves a copy if the frame is sent at once.
    #[inline(always)]
    fn frame(&self) -> Frame {
        self.numbered_frame(0)
    }

    /// The whole frame as a value.
    #[inline(always)]
    fn numbered_frame(&self, number: u8) -> Frame {
        Frame::written_by(|buffer| self.write_numbered(number, buffer))
    }
}
