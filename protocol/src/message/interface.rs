//! The interface to the messages of one direction, for decoder and senders.

use crate::frame::Frame;
use crate::layout::MessageLayout;
use crate::limits::MAX_FRAME;
use crate::wire::BodyError;

/// All messages of one direction.
pub trait Message: Sized {
    /// The layouts of all kinds, in the order of their kind byte.
    const LAYOUTS: &'static [MessageLayout];

    /// Decodes a body whose CRC is correct.
    ///
    /// # Errors
    /// The body isn't a message of this direction.
    fn decode_body(body: &[u8]) -> Result<Self, BodyError>;

    /// Splits `input` after its first frame, if that frame is whole, correct and of the kind sent in every control period.
    /// `None` for any other input, which the caller decodes on the general path.
    #[cfg(feature = "fast-path")]
    #[inline(always)]
    fn split_off_periodic(_input: &[u8]) -> Option<(Self, &[u8])> {
        None
    }

    /// The layout of this message.
    fn layout(&self) -> &'static MessageLayout;

    /// Writes the whole frame to the beginning of `buffer` and returns that part, ready to send.
    ///
    /// `buffer` need not be cleared; the bytes after the frame are undefined.
    fn write_frame<'buffer>(&self, buffer: &'buffer mut [u8; MAX_FRAME]) -> &'buffer [u8];

    /// The whole frame as a value. [`Message::write_frame`] saves a copy if the frame is sent at once.
    #[inline(always)]
    fn frame(&self) -> Frame {
        Frame::written_by(|buffer| self.write_frame(buffer))
    }
}
