//! Frames as a reader sees them: where they were, who sent them, what they say, and what was wrong with the others.
//!
//! | module | does |
//! |---|---|
//! | [`message`] | a message of either direction, for streams in which both are mixed |
//! | [`value`] | the fields of a message with their values and units, from its layout |
//! | [`table`], [`json`] | an entry as a line for people, or for programs |
//!
//! The judge of a frame is [`lashloop_protocol::Decoder`], the one of the bench and of the drive.

pub mod json;
pub mod message;
pub mod table;
pub mod value;

use lashloop_protocol::frame;
use lashloop_protocol::layout::{Direction, MessageLayout};
use lashloop_protocol::{Counters, Decoder, FrameError, Message};

use lashloop_bench::capture::Splitter;
use lashloop_bench::capture::reader::Packet;
use message::AnyMessage;
use value::{Field, fields};

/// Where a frame was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Offset of its first byte in the stream.
    Offset(u64),
    /// In a capture.
    Packet {
        /// Number of the packet, from 1.
        number: u64,
        /// Time since the first packet.
        time_ns: u64,
        /// Who sent it, if the capture says so.
        direction: Option<Direction>,
    },
}

/// A message that was found whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// What kind it is.
    pub layout: &'static MessageLayout,
    /// What it says, in the order of its bytes.
    pub fields: Vec<Field>,
}

/// One frame, good or bad.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Where it was.
    pub place: Place,
    /// Its bytes, as far as they were kept: of a line without delimiters the last few thousand.
    pub bytes: Vec<u8>,
    /// What it says, or why it says nothing.
    pub outcome: Result<Found, FrameError>,
}

impl Entry {
    /// Who sent it: by its kind, or for a bad frame by the capture.
    #[must_use]
    pub fn direction(&self) -> Option<Direction> {
        match (&self.outcome, self.place) {
            (Ok(found), _) => Some(found.layout.direction),
            (Err(_), Place::Packet { direction, .. }) => direction,
            (Err(_), Place::Offset(_)) => None,
        }
    }
}

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
                Some(outcome) => take(Entry { place: Place::Offset(start), bytes: piece.to_vec(), outcome }),
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
        if let Some(outcome) = judged.or_else(|| self.decoder.finish().err().map(Err)) {
            take(Entry { place: Place::Offset(start), bytes, outcome });
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
        let place = Place::Packet {
            number: packet.number,
            time_ns: packet.time_ns.saturating_sub(began_ns),
            direction: packet.direction,
        };
        for piece in packet.bytes.split_inclusive(|&byte| byte == frame::DELIMITER) {
            let judged = judge(&mut self.decoder, piece);
            if let Some(outcome) = judged.or_else(|| self.decoder.finish().err().map(Err)) {
                take(Entry { place, bytes: piece.to_vec(), outcome });
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
fn judge(decoder: &mut Decoder, piece: &[u8]) -> Option<Result<Found, FrameError>> {
    let message = decoder.next::<AnyMessage>(&mut &piece[..])?;
    Some(message.map(|message| Found { layout: message.layout(), fields: fields(&message) }))
}
