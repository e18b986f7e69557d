//! A second decoder, written from the specification: the whole stream at once, step by step. Property tests and the fuzzer
//! compare the decoder of the crate with it.

use std::fmt::Debug;

use lashloop_protocol::frame::FrameError;
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{Counters, Decoder, MAX_FRAME, Message, Numbered};

/// Contents of a stream.
struct Contents<M> {
    items: Vec<Result<Numbered<M>, FrameError>>,
    /// Bytes in good frames, those of unknown kinds included.
    good: usize,
    /// Bytes in bad frames.
    bad: usize,
    /// Delimiters with nothing before them.
    idle: usize,
    /// Bytes after the last delimiter.
    unfinished: usize,
}

/// Decodes `stream` in pieces of the given lengths, repeated in turn, and compares items and counters with the specification.
/// Returns the items.
///
/// # Panics
/// If they differ.
pub fn check<M: Message + Debug>(
    stream: &[u8],
    piece_lens: &[usize],
) -> Vec<Result<Numbered<M>, FrameError>> {
    let expected = contents::<M>(stream);
    let mut decoder = Decoder::new();
    let mut found = Vec::new();
    let mut rest = stream;
    for &len in piece_lens.iter().chain([&stream.len()]).cycle() {
        if rest.is_empty() {
            break;
        }
        let (mut piece, later) = rest.split_at(len.clamp(1, rest.len()));
        while let Some(item) = decoder.next::<M>(&mut piece) {
            found.push(item);
        }
        assert!(piece.is_empty(), "the decoder consumes all input");
        rest = later;
    }

    assert_eq!(found.len(), expected.items.len(), "found {found:?}, expected {:?}", expected.items);
    for (found, expected) in found.iter().zip(&expected.items) {
        assert!(same(found, expected), "found {found:?}, expected {expected:?}");
    }
    assert_eq!(*decoder.counters(), count(&expected));
    assert_eq!(expected.good + expected.bad + expected.idle + expected.unfinished, stream.len());
    let end = match expected.unfinished {
        0 => Ok(()),
        bytes => Err(FrameError::Truncated { bytes }),
    };
    assert_eq!(decoder.finish(), end);
    let discarded = decoder.counters().discarded_bytes as usize;
    assert_eq!(
        expected.good + discarded + expected.idle,
        stream.len(),
        "the counters add up to the length of the stream"
    );
    found
}

/// Equal in every bit, NaN included, for which `==` of the messages fails.
fn same<M: Message>(
    found: &Result<Numbered<M>, FrameError>,
    expected: &Result<Numbered<M>, FrameError>,
) -> bool {
    match (found, expected) {
        (Ok(found), Ok(expected)) => {
            let [found, expected] = [found, expected].map(|item| item.message.numbered_frame(item.number));
            found[..] == expected[..]
        }
        (Err(found), Err(expected)) => found == expected,
        _ => false,
    }
}

fn count<M>(contents: &Contents<M>) -> Counters {
    let count = |wanted: fn(&FrameError) -> bool| {
        contents.items.iter().filter(|item| matches!(item, Err(error) if wanted(error))).count() as u32
    };
    Counters {
        messages: contents.items.iter().filter(|item| item.is_ok()).count() as u32,
        discarded_bytes: contents.bad as u32,
        oversized: count(|error| matches!(error, FrameError::Oversized { .. })),
        malformed: count(|error| matches!(error, FrameError::Stuffing { .. } | FrameError::TooShort { .. })),
        crc_errors: count(|error| matches!(error, FrameError::Crc { .. })),
        refused: count(|error| matches!(error, FrameError::Body(_)) && !is_unknown(error)),
        unknown: count(is_unknown),
    }
}

fn is_unknown(error: &FrameError) -> bool {
    matches!(error, FrameError::Body(BodyError::UnknownKind { .. }))
}

fn contents<M: Message>(stream: &[u8]) -> Contents<M> {
    let mut contents = Contents { items: Vec::new(), good: 0, bad: 0, idle: 0, unfinished: 0 };
    for piece in stream.split_inclusive(|&byte| byte == 0) {
        let Some(stuffed) = piece.strip_suffix(&[0]) else {
            contents.unfinished = piece.len();
            continue;
        };
        if stuffed.is_empty() {
            contents.idle += 1;
            continue;
        }
        let item = open(stuffed).and_then(|body| Ok(M::decode_body(&body)?));
        *(if item.as_ref().err().is_none_or(is_unknown) { &mut contents.good } else { &mut contents.bad }) +=
            piece.len();
        contents.items.push(item);
    }
    contents
}

/// The body between two delimiters.
fn open(stuffed: &[u8]) -> Result<Vec<u8>, FrameError> {
    let bytes = stuffed.len();
    if bytes + 1 > MAX_FRAME {
        return Err(FrameError::Oversized { bytes: bytes + 1 });
    }
    let mut body = unstuff(stuffed).ok_or(FrameError::Stuffing { bytes })?;
    if body.len() < 5 {
        return Err(FrameError::TooShort { bytes });
    }
    let crc = body.split_off(body.len() - 4);
    let (expected, found) = (crc_32c(&body), u32::from_le_bytes([crc[0], crc[1], crc[2], crc[3]]));
    if expected == found { Ok(body) } else { Err(FrameError::Crc { expected, found }) }
}

/// COBS as originally described: a code byte `n` stands for the `n - 1` bytes after it and a zero. The last zero is not part
/// of the data.
fn unstuff(mut stuffed: &[u8]) -> Option<Vec<u8>> {
    let mut data = Vec::new();
    while let Some((&code, rest)) = stuffed.split_first() {
        let (block, after) = rest.split_at_checked(usize::from(code) - 1)?;
        data.extend_from_slice(block);
        data.extend((!after.is_empty()).then_some(0));
        stuffed = after;
    }
    Some(data)
}

/// Bit by bit, from the polynomial.
fn crc_32c(bytes: &[u8]) -> u32 {
    let remainder = bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0x82f6_3b78 } else { 0 })
    });
    !remainder
}
