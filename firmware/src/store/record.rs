//! The lines of a record: pairs of key and word, and a first line that makes them valid.

use lashloop_protocol::crc;

use super::memory::{LINE_WORDS, Line, SLOT_LINES};

/// Pairs of a line; none lies across two.
pub(super) const LINE_PAIRS: usize = LINE_WORDS / 2;
/// Most pairs of a record.
pub const PAIRS_MAX: usize = (SLOT_LINES - 1) * LINE_PAIRS;
/// First word of a record of this layout.
const MAGIC: u32 = 0x5053_4c31;

/// What the first line of a record says, apart from the check value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Record {
    /// Which slot it is in.
    pub(super) slot: usize,
    /// Higher for a later record.
    pub(super) sequence: u32,
    /// Number of its pairs.
    pub(super) count: usize,
}

impl Record {
    /// The first line.
    pub(super) fn first_line(&self, check: u32) -> Line {
        let rest = u32::MAX;
        [MAGIC, self.sequence, self.count as u32, check, rest, rest, rest, rest]
    }

    /// A record and its check value from a first line.
    pub(super) fn read(slot: usize, line: &Line) -> Option<(Self, u32)> {
        let [magic, sequence, count, check, ..] = *line;
        let count = count as usize;
        (magic == MAGIC && count <= PAIRS_MAX).then_some((Self { slot, sequence, count }, check))
    }

    /// Number of a line of the record, the first one being 0.
    pub(super) fn line(&self, at: usize) -> usize {
        self.slot * SLOT_LINES + at
    }

    /// Lines with pairs.
    pub(super) fn body_lines(&self) -> usize {
        self.count.div_ceil(LINE_PAIRS)
    }

    /// The check value before the first line with pairs. It covers the first line too.
    pub(super) fn check(&self) -> u32 {
        chain(0, &self.first_line(0))
    }
}

/// The check value after a further line: CRC-32C over the value before and the line.
pub(super) fn chain(check: u32, line: &Line) -> u32 {
    let mut bytes = [0; 4 * (LINE_WORDS + 1)];
    let words = core::iter::once(&check).chain(line);
    for (bytes, word) in bytes.chunks_exact_mut(4).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    crc::checksum(&bytes)
}
