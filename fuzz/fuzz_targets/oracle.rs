//! What the specification makes of a stream, frame by frame, without an allocation.
//!
//! The property tests of the protocol compare with a reference that is simpler and slower; this one is for millions of streams.

use std::fmt::Debug;

use lashloop_protocol::frame::FrameError;
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{Counters, Decoder, MAX_FRAME, Message, Numbered, crc};

/// Decodes `stream` in pieces of `piece_len` bytes and compares each item, the counters and the end with the specification.
///
/// # Panics
/// If they differ.
pub fn check<M: Message + Debug>(stream: &[u8], piece_len: usize) {
    let mut expected = Expected { rest: stream, counters: Counters::default() };
    let mut decoder = Decoder::new();
    for mut piece in stream.chunks(piece_len.max(1)) {
        while let Some(found) = decoder.next::<M>(&mut piece) {
            let expected = expected.next_item::<M>().expect("no item more than the stream has");
            assert!(same(&found, &expected), "found {found:?}, expected {expected:?}");
        }
        assert!(piece.is_empty(), "the decoder consumes all input");
    }
    assert!(expected.next_item::<M>().is_none(), "no item less than the stream has");
    assert_eq!(*decoder.counters(), expected.counters);
    let end = match expected.rest.len() {
        0 => Ok(()),
        bytes => Err(FrameError::Truncated { bytes }),
    };
    assert_eq!(decoder.finish(), end);
}

struct Expected<'stream> {
    rest: &'stream [u8],
    counters: Counters,
}

impl Expected<'_> {
    /// The next item of the stream; `None` where only the beginning of a frame is left.
    fn next_item<M: Message>(&mut self) -> Option<Result<Numbered<M>, FrameError>> {
        loop {
            let end = self.rest.iter().position(|&byte| byte == 0)?;
            let (stuffed, rest) = (&self.rest[..end], &self.rest[end + 1..]);
            self.rest = rest;
            if !stuffed.is_empty() {
                let item = open(stuffed);
                let counters = &mut self.counters;
                match &item {
                    Ok(_) => counters.messages += 1,
                    Err(FrameError::Oversized { .. }) => counters.oversized += 1,
                    Err(FrameError::Crc { .. }) => counters.crc_errors += 1,
                    Err(FrameError::Body(BodyError::UnknownKind { .. })) => counters.unknown += 1,
                    Err(FrameError::Body(_)) => counters.refused += 1,
                    Err(_) => counters.malformed += 1,
                }
                // A message that this version doesn't know isn't garbage.
                if !matches!(item, Ok(_) | Err(FrameError::Body(BodyError::UnknownKind { .. }))) {
                    counters.discarded_bytes += stuffed.len() as u32 + 1;
                }
                return Some(item);
            }
        }
    }
}

/// The message between two delimiters. COBS as originally described: a code byte `n` stands for the `n - 1` bytes after it and a
/// zero; the last zero is not part of the data.
fn open<M: Message>(stuffed: &[u8]) -> Result<Numbered<M>, FrameError> {
    let bytes = stuffed.len();
    if bytes >= MAX_FRAME {
        return Err(FrameError::Oversized { bytes: bytes + 1 });
    }
    let mut data = [0; MAX_FRAME];
    let (mut len, mut rest) = (0, stuffed);
    while let Some((&code, after)) = rest.split_first() {
        let (block, after) =
            after.split_at_checked(usize::from(code) - 1).ok_or(FrameError::Stuffing { bytes })?;
        data[len..][..block.len()].copy_from_slice(block);
        len += block.len() + usize::from(!after.is_empty());
        rest = after;
    }
    if len < 5 {
        return Err(FrameError::TooShort { bytes });
    }
    let (body, found) = data[..len].split_last_chunk().expect("four bytes");
    let (expected, found) = (crc::checksum(body), u32::from_le_bytes(*found));
    if expected == found { Ok(M::decode_body(body)?) } else { Err(FrameError::Crc { expected, found }) }
}

/// Equal in every bit, NaN included, for which `==` of the messages fails.
fn same<M: Message>(
    found: &Result<Numbered<M>, FrameError>,
    expected: &Result<Numbered<M>, FrameError>,
) -> bool {
    let frame = |it: &Numbered<M>| it.message.numbered_frame(it.number);
    match (found, expected) {
        (Ok(found), Ok(expected)) => frame(found)[..] == frame(expected)[..],
        (Err(found), Err(expected)) => found == expected,
        _ => false,
    }
}
