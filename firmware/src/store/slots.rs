//! The store: which record counts, which slot comes next, and the steps from a request to a valid record.

use super::memory::{BLANK, LINE_WORDS, Line, Memory, SECTOR_LINES, SECTOR_SLOTS, SECTORS, SLOT_LINES};
use super::record::{LINE_PAIRS, Record, chain};

const SLOTS: usize = SECTORS * SECTOR_SLOTS;

/// Why nothing was stored. The record before still counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// A line doesn't read as it was programmed.
    Refused = 1,
    /// No slot is blank until the next power-up, which erases a sector.
    Full = 2,
}

/// What a step has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Nothing: no record is being written.
    Idle,
    /// It has written a line, and more remain.
    Writing,
    /// The record is written, or can't be.
    Done(Result<(), StoreError>),
}

/// Records in two sectors of flash.
pub struct Store {
    memory: &'static dyn Memory,
    /// The valid record with the highest sequence number.
    newest: Option<Record>,
    writing: Option<Writing>,
}

struct Writing {
    record: Record,
    /// Lines with pairs that are written.
    written: usize,
    /// Over all lines so far.
    check: u32,
}

impl Store {
    /// Finds the record that counts, and erases the sector without it, unless that is blank. To be called at power-up, before a
    /// watchdog runs.
    #[must_use]
    pub fn open(memory: &'static dyn Memory) -> Self {
        let mut newest: Option<Record> = None;
        // From the last slot on: a sector was filled from the first one, so few records have to be checked.
        for slot in (0..SLOTS).rev() {
            let line = memory.read(slot * SLOT_LINES);
            if let Some((record, check)) = line.and_then(|line| Record::read(slot, &line))
                && newest.is_none_or(|newest| newest.sequence < record.sequence)
                && is_valid(memory, &record, check)
            {
                newest = Some(record);
            }
        }
        let other = newest.map_or(1, |newest| 1 - newest.slot / SECTOR_SLOTS);
        if !memory.is_blank(other * SECTOR_LINES, SECTOR_LINES) {
            memory.erase(other);
        }
        Self { memory, newest, writing: None }
    }

    /// Whether there is a record, with pairs.
    #[must_use]
    pub fn holds_values(&self) -> bool {
        self.newest.is_some_and(|newest| newest.count > 0)
    }

    /// The word of this key. `place` is its likely place in the record.
    #[must_use]
    pub fn word(&self, key: u32, place: usize) -> Option<u32> {
        let newest = self.newest?;
        let places = (place..newest.count).chain(0..place.min(newest.count));
        places.filter_map(|place| self.pair(&newest, place)).find(|[it, _]| *it == key).map(|[_, word]| word)
    }

    fn pair(&self, record: &Record, place: usize) -> Option<[u32; 2]> {
        let line = self.memory.read(record.line(1 + place / LINE_PAIRS))?;
        line.as_chunks().0.get(place % LINE_PAIRS).copied()
    }

    /// Begins a record of this many pairs, which [`Self::step`] writes. A record without pairs forgets those before.
    ///
    /// # Errors
    /// [`StoreError::Full`].
    pub fn begin(&mut self, count: usize) -> Result<(), StoreError> {
        let (last, sequence) = self.newest.map_or((SLOTS - 1, 0), |newest| (newest.slot, newest.sequence));
        let mut slots = (1..=SLOTS).map(|after| (last + after) % SLOTS);
        let slot = slots.find(|slot| self.memory.is_blank(slot * SLOT_LINES, SLOT_LINES));
        let record =
            Record { slot: slot.ok_or(StoreError::Full)?, sequence: sequence.wrapping_add(1), count };
        self.writing = Some(Writing { record, written: 0, check: record.check() });
        Ok(())
    }

    /// Whether a record is being written.
    #[must_use]
    pub fn is_writing(&self) -> bool {
        self.writing.is_some()
    }

    /// Writes one line of the record that is being written. `pair` has its pairs by their places, and has to have the same ones in
    /// each step.
    pub fn step(&mut self, pair: impl Fn(usize) -> [u32; 2]) -> Progress {
        let Some(Writing { record, written, check }) = &mut self.writing else { return Progress::Idle };
        let is_last = *written == record.body_lines();
        let (line, at) = if is_last {
            (record.first_line(*check), 0)
        } else {
            let mut line = BLANK;
            let places = *written * LINE_PAIRS..record.count;
            for (words, place) in line.as_chunks_mut::<{ LINE_WORDS / LINE_PAIRS }>().0.iter_mut().zip(places)
            {
                *words = pair(place);
            }
            (line, 1 + *written)
        };
        let at = record.line(at);
        self.memory.program(at, &line);
        let is_good = self.memory.read(at) == Some(line);
        if is_good && !is_last {
            (*written, *check) = (*written + 1, chain(*check, &line));
            return Progress::Writing;
        }
        if is_good {
            self.newest = Some(*record);
        }
        self.writing = None;
        Progress::Done(if is_good { Ok(()) } else { Err(StoreError::Refused) })
    }
}

fn is_valid(memory: &dyn Memory, record: &Record, check: u32) -> bool {
    let mut lines = (1..=record.body_lines()).map(|at| memory.read(record.line(at)));
    let found: Option<u32> =
        lines.try_fold(record.check(), |check, line: Option<Line>| Some(chain(check, &line?)));
    found == Some(check)
}
