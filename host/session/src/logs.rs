//! Log texts of the drive, kept without allocating during a run.

use std::collections::VecDeque;
use std::fmt;
use std::time::Instant;

use lashloop_protocol::message::Log;

use crate::text::printable;

/// Texts kept: the latest ones, because a drive may log without end.
const CAPACITY: usize = 100;

/// The latest log texts of the drive and notes of the bench.
pub struct Logs {
    entries: VecDeque<LogEntry>,
    /// Texts so far, dropped ones included.
    count: u64,
    /// Those of them that [`Self::next_new`] has passed on.
    passed_on: u64,
}

/// A text of the drive, or about it.
#[derive(Debug, Clone, PartialEq)]
pub enum LogEntry {
    /// A message of the drive.
    Received {
        /// The message.
        log: Log,
        /// When the drive formed it, in the link's time; `None` without a device time in it.
        formed_at: Option<Instant>,
    },
    /// A remark of the bench.
    Note(String),
}

impl Default for Logs {
    fn default() -> Self {
        Self { entries: VecDeque::with_capacity(CAPACITY), count: 0, passed_on: 0 }
    }
}

impl Logs {
    /// Keeps a log message of the drive.
    pub fn receive(&mut self, log: Log, formed_at: Option<Instant>) {
        self.push(LogEntry::Received { log, formed_at });
    }

    /// Keeps a remark of the bench about the drive.
    pub fn note(&mut self, text: String) {
        self.push(LogEntry::Note(text));
    }

    fn push(&mut self, entry: LogEntry) {
        if self.entries.len() == CAPACITY {
            self.entries.pop_front();
        }
        self.entries.push_back(entry);
        self.count += 1;
    }

    /// Removes and returns all texts.
    pub fn take(&mut self) -> Vec<String> {
        self.passed_on = self.count;
        self.entries.drain(..).map(|entry| entry.to_string()).collect()
    }

    /// The next text that this has not returned yet.
    pub fn next_new(&mut self) -> Option<LogEntry> {
        // A drive that logs without end has dropped some.
        let first = self.count - self.entries.len() as u64;
        let next = self.passed_on.max(first);
        let entry = self.entries.get(usize::try_from(next - first).ok()?)?.clone();
        self.passed_on = next + 1;
        Some(entry)
    }
}

impl fmt::Display for LogEntry {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Received { log, .. } => write!(out, "{}: {}", log.level, printable(log.text.as_str())),
            Self::Note(text) => out.write_str(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_texts_are_kept() {
        let mut logs = Logs::default();
        (0..CAPACITY + 2).for_each(|i| logs.note(i.to_string()));
        let all = logs.take();
        assert_eq!((all.len(), all[0].as_str()), (CAPACITY, "2"));
        assert!(logs.take().is_empty());
    }

    #[test]
    fn each_text_is_passed_on_once() {
        let mut logs = Logs::default();
        let mut new = |texts: std::ops::Range<usize>| {
            texts.for_each(|text| logs.note(text.to_string()));
            std::iter::from_fn(|| logs.next_new()).map(|entry| entry.to_string()).collect::<Vec<_>>()
        };
        assert_eq!(new(0..2), ["0", "1"]);
        assert!(new(0..0).is_empty());
        assert_eq!(new(2..3), ["2"]);
        let latest = new(0..CAPACITY + 5);
        assert_eq!((latest.len(), latest[0].as_str()), (CAPACITY, "5"));
        logs.note("taken".to_owned());
        assert_eq!(logs.take().len(), CAPACITY);
        assert_eq!(logs.next_new(), None);
    }
}
