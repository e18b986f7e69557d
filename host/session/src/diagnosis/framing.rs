//! Usual mistakes of a firmware in its framing, found in the first bytes outside good frames.

use std::fmt;

use lashloop_protocol::frame::{DELIMITER, MAX_BODY, MAX_FRAME, OVERHEAD};
use lashloop_protocol::{DriveMessage, Message, crc, frame};

/// Longest frame without its delimiter, in bytes.
const LONGEST: usize = MAX_FRAME - 1;
/// The shortest.
const SHORTEST: usize = OVERHEAD;

/// A usual mistake in the framing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FramingMistake {
    /// Frames are whole, and no delimiter ends them.
    NoDelimiter,
    /// Body and CRC are sent as they are.
    NoCobs,
    /// Other bytes stand between a delimiter and a frame.
    Padding {
        /// One of them.
        byte: u8,
    },
}

impl FramingMistake {
    /// The mistake that explains `bytes`, delimiters included. A line that loses bytes joins frames too, so nothing is said of
    /// bytes around a frame on a line that worked before.
    pub(super) fn of(bytes: &[u8], is_connected: bool) -> Option<Self> {
        let delimiters = bytes.iter().filter(|byte| **byte == DELIMITER).count();
        if delimiters == 0 {
            let longest = bytes.len().min(LONGEST);
            return (SHORTEST..=longest).any(|len| is_frame(&bytes[..len])).then_some(Self::NoDelimiter);
        }
        if (0..bytes.len()).any(|start| begins_with_a_body(&bytes[start..])) {
            return Some(Self::NoCobs);
        }
        let mut pieces = bytes.split(|byte| *byte == DELIMITER);
        pieces.find_map(padding).filter(|_| !is_connected).map(|byte| Self::Padding { byte })
    }
}

fn is_frame(stuffed: &[u8]) -> bool {
    let mut copy = [0; LONGEST];
    let Some(copy) = copy.get_mut(..stuffed.len()) else { return false };
    copy.copy_from_slice(stuffed);
    frame::open(copy).is_ok()
}

/// Whether a message of a drive and its CRC come first, without stuffing.
fn begins_with_a_body(bytes: &[u8]) -> bool {
    (1..=MAX_BODY.min(bytes.len())).any(|len| {
        let (body, after) = bytes.split_at(len);
        let has_crc = after.first_chunk().is_some_and(|found| crc::checksum(body).to_le_bytes() == *found);
        has_crc && DriveMessage::decode_body(body).is_ok()
    })
}

/// A byte beside the frame in a piece between two delimiters.
fn padding(piece: &[u8]) -> Option<u8> {
    for start in 0..piece.len() {
        let longest = (piece.len() - start).min(LONGEST);
        let len = (SHORTEST..=longest).find(|len| is_frame(&piece[start..start + len]));
        if let Some(len) = len {
            let before = start.checked_sub(1).map(|at| piece[at]);
            return before.or_else(|| piece.get(start + len).copied());
        }
    }
    None
}

impl fmt::Display for FramingMistake {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDelimiter => out.write_str(
                "whole frames arrive and none ends; the firmware must send a zero byte, the delimiter, after each frame",
            ),
            Self::NoCobs => out.write_str(
                "messages arrive without stuffing; the firmware must encode body and CRC with COBS before it sends them",
            ),
            Self::Padding { byte } => write!(
                out,
                "the byte {byte:#04x} stands beside a whole frame; between two frames the firmware may send zero bytes only: \
                 no padding and no text"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use lashloop_protocol::cobs;
    use lashloop_protocol::message::LawDescription;
    use lashloop_protocol::text::Text;

    use super::*;

    fn frame() -> Vec<u8> {
        DriveMessage::from(LawDescription { index: 0, name: Text::new("pd") }).numbered_frame(3).to_vec()
    }

    #[test]
    fn bytes_around_a_frame_are_padding() {
        let frame = frame();
        let behind = [&frame[..frame.len() - 1], &[0xaa, 0xaa, 0]].concat();
        for (bytes, byte) in [([&[0xff; 20], &frame[..]].concat(), 0xff), (behind, 0xaa)] {
            assert_eq!(FramingMistake::of(&bytes, false), Some(FramingMistake::Padding { byte }));
            assert_eq!(FramingMistake::of(&bytes, true), None, "the line may have joined two frames");
        }
        assert_eq!(FramingMistake::of(&frame[1..], false), None, "half a frame");
    }

    #[test]
    fn a_frame_without_a_delimiter_or_without_stuffing_is_recognised() {
        let frame = frame();
        let stuffed = &frame[..frame.len() - 1];
        let twice = [stuffed, stuffed].concat();
        assert_eq!(FramingMistake::of(&twice, true), Some(FramingMistake::NoDelimiter));
        let mut copy = stuffed.to_vec();
        let plain = [cobs::unstuff(&mut copy).expect("a frame"), &[0]].concat();
        assert_eq!(FramingMistake::of(&plain, true), Some(FramingMistake::NoCobs));
    }
}
