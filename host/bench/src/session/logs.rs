//! Log texts of the drive, kept without allocating during a run.

use std::collections::VecDeque;

use lashloop_protocol::message::Log;

use super::text::printable;

/// Texts kept: the latest ones, because a drive may log without end.
const CAPACITY: usize = 100;

/// The latest log texts of the drive and notes of the bench.
pub(crate) struct Logs {
    entries: VecDeque<Entry>,
    /// Texts so far, dropped ones included.
    count: u64,
}

enum Entry {
    /// Formatted on reading.
    Received(Log),
    Note(String),
}

impl Default for Logs {
    fn default() -> Self {
        Self { entries: VecDeque::with_capacity(CAPACITY), count: 0 }
    }
}

impl Logs {
    /// Keeps a log message of the drive.
    pub(crate) fn receive(&mut self, log: Log) {
        self.push(Entry::Received(log));
    }

    /// Keeps a remark of the bench about the drive.
    pub(crate) fn note(&mut self, text: String) {
        self.push(Entry::Note(text));
    }

    fn push(&mut self, entry: Entry) {
        if self.entries.len() == CAPACITY {
            self.entries.pop_front();
        }
        self.entries.push_back(entry);
        self.count += 1;
    }

    /// The position of the next text, for [`Self::since`].
    pub(crate) fn mark(&self) -> u64 {
        self.count
    }

    /// The texts after a mark that are still kept.
    pub(crate) fn since(&self, mark: u64) -> Vec<String> {
        let new = usize::try_from(self.count - mark).unwrap_or(CAPACITY);
        let old = self.entries.len().saturating_sub(new);
        self.entries.iter().skip(old).map(Entry::text).collect()
    }

    /// Removes and returns all texts.
    pub(crate) fn take(&mut self) -> Vec<String> {
        self.entries.drain(..).map(|entry| entry.text()).collect()
    }
}

impl Entry {
    fn text(&self) -> String {
        match self {
            Self::Received(log) => format!("{:?}: {}", log.level, printable(log.text.as_str())),
            Self::Note(text) => text.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_texts_are_kept_and_a_mark_stays_good() {
        let mut logs = Logs::default();
        (0..CAPACITY).for_each(|i| logs.note(i.to_string()));
        let mark = logs.mark();
        logs.note("one".to_owned());
        logs.note("two".to_owned());
        assert_eq!(logs.since(mark), ["one", "two"]);
        let all = logs.take();
        assert_eq!((all.len(), all[0].as_str()), (CAPACITY, "2"));
        assert!(logs.since(mark).is_empty());
    }
}
