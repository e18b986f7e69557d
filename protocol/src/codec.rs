//! The decoder as a tokio-util codec.

use core::marker::PhantomData;
use std::io;

use bytes::{Buf, BytesMut};

use crate::decoder::{Counters, Decoder};
use crate::frame::FrameError;
use crate::limits::MAX_FRAME;
use crate::message::{Message, Numbered};

/// Decodes messages of type `In` and encodes messages of type `Out`.
///
/// A bad frame is an item of the stream and does not end it, because noise on a line is normal.
#[derive(Clone, Debug)]
pub struct Codec<In, Out> {
    decoder: Decoder,
    messages: PhantomData<fn(Out) -> In>,
}

impl<In, Out> Default for Codec<In, Out> {
    fn default() -> Self {
        Self { decoder: Decoder::new(), messages: PhantomData }
    }
}

impl<In, Out> Codec<In, Out> {
    /// Counters since the codec was created.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        self.decoder.counters()
    }
}

impl<In: Message, Out> tokio_util::codec::Decoder for Codec<In, Out> {
    type Item = Result<Numbered<In>, FrameError>;
    type Error = io::Error;

    fn decode(&mut self, src: &mut BytesMut) -> io::Result<Option<Self::Item>> {
        let mut input = &src[..];
        let item = self.decoder.next(&mut input);
        let used = src.len() - input.len();
        src.advance(used);
        Ok(item)
    }

    fn decode_eof(&mut self, src: &mut BytesMut) -> io::Result<Option<Self::Item>> {
        match self.decode(src)? {
            Some(item) => Ok(Some(item)),
            None => Ok(self.decoder.finish().err().map(Err)),
        }
    }
}

impl<In, Out: Message> tokio_util::codec::Encoder<Numbered<Out>> for Codec<In, Out> {
    type Error = io::Error;

    fn encode(&mut self, Numbered { number, message }: Numbered<Out>, dst: &mut BytesMut) -> io::Result<()> {
        dst.extend_from_slice(message.write_numbered(number, &mut [0; MAX_FRAME]));
        Ok(())
    }
}
