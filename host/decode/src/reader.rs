//! Readers of byte streams and of captures.

use crate::capture::Splitter;
use crate::capture::reader::Packet;
use lashloop_protocol::frame;
use lashloop_protocol::{Decoder, FrameError};

use super::entry::{DecodedMessage, Entry, Location};
use super::message::AnyMessage;
use super::subscription::Subscription;

/// Splits a byte stream into frames; the stream may mix both directions.
#[derive(Debug, Default)]
pub struct StreamReader {
    splitter: Splitter,
    pub decoder: Decoder,
    subscription: Subscription,
    /// Bytes received so far.
    offset: u64,
    /// Start of a frame that an earlier piece began.
    began: Option<u64>,
}

impl StreamReader {
    /// Passes every frame that `bytes` completes to `take`.
    pub fn push(&mut self, bytes: &[u8], mut take: impl FnMut(Entry)) {
        let Self { splitter, decoder, subscription, offset, began } = self;
        splitter.push(bytes, |piece| {
            let start = began.take().unwrap_or(*offset);
            *offset += piece.len() as u64;
            match decode(decoder, subscription, piece) {
                Some(message) => {
                    take(Entry {
                        location: Location::Stream { offset: start },
                        bytes: piece.to_vec(),
                        message,
                    });
                }
                None if piece.last() != Some(&frame::DELIMITER) => *began = Some(start),
                None => {}
            }
        });
    }

    /// Ends the stream. A partial frame at its end is a bad one.
    pub fn finish(&mut self, take: impl FnOnce(Entry)) {
        let start = self.began.take().unwrap_or(self.offset);
        let mut bytes = Vec::new();
        self.splitter.finish(|piece| bytes = piece.to_vec());
        let decoded = decode(&mut self.decoder, &mut self.subscription, &bytes);
        if let Some(message) = decoded.or_else(|| self.decoder.finish().err().map(Err)) {
            take(Entry { location: Location::Stream { offset: start }, bytes, message });
        }
    }
}

/// Decodes the packets of a capture, each on its own.
#[derive(Debug, Default)]
pub struct PacketReader {
    pub decoder: Decoder,
    subscription: Subscription,
    began_ns: Option<u64>,
}

impl PacketReader {
    /// Passes every frame of the packet to `take`; captures of ours have one per packet. A delimiter alone isn't a frame.
    pub fn push(&mut self, packet: &Packet, mut take: impl FnMut(Entry)) {
        let began_ns = *self.began_ns.get_or_insert(packet.time_ns);
        let location = Location::Packet {
            number: packet.number,
            time_ns: packet.time_ns.saturating_sub(began_ns),
            direction: packet.direction,
        };
        for piece in packet.bytes.split_inclusive(|&byte| byte == frame::DELIMITER) {
            let decoded = decode(&mut self.decoder, &mut self.subscription, piece);
            if let Some(message) = decoded.or_else(|| self.decoder.finish().err().map(Err)) {
                take(Entry { location, bytes: piece.to_vec(), message });
            }
        }
    }
}

/// `None` for a piece that completes no frame.
fn decode(
    decoder: &mut Decoder,
    subscription: &mut Subscription,
    piece: &[u8],
) -> Option<Result<DecodedMessage, FrameError>> {
    let message = decoder.next::<AnyMessage>(&mut &piece[..])?;
    Some(message.map(|it| DecodedMessage::new(&it, subscription.follow(&it.message))))
}
