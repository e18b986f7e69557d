//! The latest messages of a run as `run.mcap` has them, a bounded number of bytes of them: for clients that take single
//! steps, not buckets.

use std::collections::VecDeque;
use std::sync::Arc;

/// Bytes that are kept: the whole of a run of 25 s at 1 kHz with the usual signals.
const KEPT_BYTES: usize = 16 << 20;
/// What a message takes besides its data.
const OVERHEAD_BYTES: usize = 64;

/// A message of a topic.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Message {
    /// Number of the topic.
    pub(super) topic: usize,
    /// Time of its values, in ns since 1970.
    pub(super) log_time_ns: u64,
    pub(super) data: Arc<[u8]>,
}

impl Message {
    fn bytes(&self) -> usize {
        OVERHEAD_BYTES + self.data.len()
    }
}

/// Readers have a place each and take what is new since then, as with a [`History`](super::envelope::History).
#[derive(Debug)]
pub(super) struct Messages {
    limit_bytes: usize,
    bytes: usize,
    /// Number of the first message that is kept.
    first: u64,
    kept: VecDeque<Message>,
}

impl Default for Messages {
    fn default() -> Self {
        Self::new(KEPT_BYTES)
    }
}

impl Messages {
    fn new(limit_bytes: usize) -> Self {
        Self { limit_bytes, bytes: 0, first: 0, kept: VecDeque::new() }
    }

    /// Takes all messages of `new`, and drops the oldest beyond the limit.
    pub(super) fn append(&mut self, new: &mut Vec<Message>) {
        self.bytes += new.iter().map(Message::bytes).sum::<usize>();
        self.kept.extend(new.drain(..));
        while self.bytes > self.limit_bytes
            && let Some(oldest) = self.kept.pop_front()
        {
            self.bytes -= oldest.bytes();
            self.first += 1;
        }
    }

    /// At most `limit` messages from number `place` on, and the place behind them.
    pub(super) fn read(&self, place: u64, limit: usize) -> (Vec<Message>, u64) {
        let first = place.max(self.first);
        let start = usize::try_from(first - self.first).unwrap_or(usize::MAX);
        let read: Vec<_> = self.kept.iter().skip(start).take(limit).cloned().collect();
        let next = first + read.len() as u64;
        (read, next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn messages(times: std::ops::Range<u64>) -> Vec<Message> {
        times.map(|log_time_ns| Message { topic: 0, log_time_ns, data: Arc::from([0; 36]) }).collect()
    }

    #[test]
    fn the_oldest_messages_give_way_and_a_slow_reader_skips_them() {
        let mut kept = Messages::new(1_000);
        kept.append(&mut messages(0..25));
        let (read, next) = kept.read(0, 4);
        assert_eq!(read.iter().map(|it| it.log_time_ns).collect::<Vec<_>>(), [15, 16, 17, 18]);
        assert_eq!(next, 19);
        let (rest, end) = kept.read(next, 100);
        assert_eq!((rest.len(), end), (6, 25));
        assert_eq!(kept.read(end, 100), (Vec::new(), 25));
        for _ in 0..1_000 {
            kept.append(&mut messages(0..100));
            assert!(kept.bytes <= 1_000 && kept.kept.len() <= 10);
        }
    }
}
