//! Readers of byte streams and of captures.

use lashloop_bench::capture::Splitter;
use lashloop_bench::capture::reader::Packet;
use lashloop_protocol::frame;
use lashloop_protocol::{Counters, Decoder, FrameError, Message};

use super::entry::{DecodedMessage, Entry, Location};
use super::message::AnyMessage;
use super::value::fields;

/// Reads a stream of bytes in which both directions may be mixed, frame by frame.
#[derive(Debug, Default)]
pub struct StreamReader {
    splitter: Splitter,
    decoder: Decoder,
    /// Bytes in all pieces so far.
    offset: u64,
    /// Start of the frame that is going on, if a piece of it has passed already.
    began: Option<u64>,
}

impl StreamReader {
    /// Gives every frame that `bytes` completes to `take`.
    pub fn push(&mut self, bytes: &[u8], mut take: impl FnMut(Entry)) {
        let Self { splitter, decoder, offset, began } = self;
        splitter.push(bytes, |piece| {
            let start = began.take().unwrap_or(*offset);
            *offset += piece.len() as u64;
            match judge(decoder, piece) {
                Some(message) => {
                    take(Entry { location: Location::Offset(start), bytes: piece.to_vec(), message })
                }
                None if piece.last() != Some(&frame::DELIMITER) => *began = Some(start),
                None => {}
            }
        });
    }

    /// Ends the stream: half a frame at its end is a bad one.
    pub fn finish(&mut self, take: impl FnOnce(Entry)) {
        let start = self.began.take().unwrap_or(self.offset);
        let mut bytes = Vec::new();
        self.splitter.finish(|piece| bytes = piece.to_vec());
        let judged = judge(&mut self.decoder, &bytes);
        if let Some(message) = judged.or_else(|| self.decoder.finish().err().map(Err)) {
            take(Entry { location: Location::Offset(start), bytes, message });
        }
    }

    /// What has been seen so far.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        self.decoder.counters()
    }
}

/// Reads the packets of a capture; each stands for itself.
#[derive(Debug, Default)]
pub struct PacketReader {
    decoder: Decoder,
    began_ns: Option<u64>,
}

impl PacketReader {
    /// Gives every frame of the packet to `take`: one, in a capture of ours. A delimiter alone is no frame.
    pub fn push(&mut self, packet: &Packet, mut take: impl FnMut(Entry)) {
        let began_ns = *self.began_ns.get_or_insert(packet.time_ns);
        let location = Location::Packet {
            number: packet.number,
            time_ns: packet.time_ns.saturating_sub(began_ns),
            direction: packet.direction,
        };
        for piece in packet.bytes.split_inclusive(|&byte| byte == frame::DELIMITER) {
            let judged = judge(&mut self.decoder, piece);
            if let Some(message) = judged.or_else(|| self.decoder.finish().err().map(Err)) {
                take(Entry { location, bytes: piece.to_vec(), message });
            }
        }
    }

    /// What has been seen so far.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        self.decoder.counters()
    }
}

/// `None` for a piece that ends no frame.
fn judge(decoder: &mut Decoder, piece: &[u8]) -> Option<Result<DecodedMessage, FrameError>> {
    let message = decoder.next::<AnyMessage>(&mut &piece[..])?;
    Some(message.map(|message| DecodedMessage { layout: message.layout(), fields: fields(&message) }))
}
