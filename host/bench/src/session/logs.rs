//! What the drive says in words, kept without taking memory while a run goes on.

use std::collections::VecDeque;

use lashloop_protocol::message::Log;

use super::printable;

/// Texts that are kept: the latest, because a drive that never stops talking must not fill the memory.
const KEPT: usize = 100;

/// The latest texts.
pub(crate) struct Logs {
    kept: VecDeque<Entry>,
    /// How many there have been, dropped ones included.
    count: u64,
}

enum Entry {
    /// Put into words when somebody wants to read it.
    Said(Log),
    Noted(String),
}

impl Default for Logs {
    fn default() -> Self {
        Self { kept: VecDeque::with_capacity(KEPT), count: 0 }
    }
}

impl Logs {
    /// Keeps what the drive said.
    pub(crate) fn say(&mut self, log: Log) {
        self.push(Entry::Said(log));
    }

    /// Keeps what the bench has to say about the drive.
    pub(crate) fn note(&mut self, text: String) {
        self.push(Entry::Noted(text));
    }

    fn push(&mut self, entry: Entry) {
        if self.kept.len() == KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back(entry);
        self.count += 1;
    }

    /// Where the next text will be, for [`Self::since`].
    pub(crate) fn mark(&self) -> u64 {
        self.count
    }

    /// The texts since a mark, as far as they are still kept.
    pub(crate) fn since(&self, mark: u64) -> Vec<String> {
        let new = usize::try_from(self.count - mark).unwrap_or(KEPT);
        let known = self.kept.len().saturating_sub(new);
        self.kept.iter().skip(known).map(Entry::text).collect()
    }

    /// Hands all texts over.
    pub(crate) fn take(&mut self) -> Vec<String> {
        self.kept.drain(..).map(|entry| entry.text()).collect()
    }
}

impl Entry {
    fn text(&self) -> String {
        match self {
            Self::Said(log) => format!("{:?}: {}", log.level, printable(log.text.as_str())),
            Self::Noted(text) => text.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_texts_are_kept_and_a_mark_stays_good() {
        let mut logs = Logs::default();
        (0..KEPT).for_each(|i| logs.note(i.to_string()));
        let mark = logs.mark();
        logs.note("one".to_owned());
        logs.note("two".to_owned());
        assert_eq!(logs.since(mark), ["one", "two"]);
        let all = logs.take();
        assert_eq!((all.len(), all[0].as_str()), (KEPT, "2"));
        assert!(logs.since(mark).is_empty());
    }
}
