//! What a run publishes and readers take: bounded, and the newest wins.
//!
//! The run writes into one history; a reader has a place in it and takes what is new. There is no queue per reader, so a
//! slow reader costs nothing, and a late one begins with the history. No lock is held for longer than it takes to copy one
//! chunk, and the run never waits for it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::watch;

use super::envelope::{Chunk, History};
use super::foxglove::Introduction;
use super::messages::{Message, Messages};

/// Buckets of one message.
const CHUNK: usize = 256;

/// The present state of a run for its readers.
#[derive(Debug)]
pub(super) struct Feed {
    state: Mutex<State>,
    changed: watch::Sender<()>,
    readers: watch::Sender<usize>,
    /// Whether there ever was a reader.
    visited: AtomicBool,
    stop: AtomicBool,
    /// Messages that readers have taken.
    taken: AtomicU64,
}

#[derive(Debug, Default)]
pub(super) struct State {
    /// What the run is; absent before its start.
    pub(super) description: Option<Arc<str>>,
    pub(super) histories: Vec<History>,
    /// What the run is, as a client of Foxglove takes it; absent before its start.
    pub(super) introduction: Option<Arc<Introduction>>,
    pub(super) messages: Messages,
    status: Option<Arc<str>>,
    /// Number of the status.
    statuses: u64,
    end: Option<Arc<str>>,
}

impl State {
    pub(super) fn set_status(&mut self, status: Arc<str>) {
        self.status = Some(status);
        self.statuses += 1;
    }
}

/// Place of a reader.
#[derive(Debug, Default)]
pub(super) struct Cursor {
    is_described: bool,
    places: Vec<u64>,
    statuses: u64,
}

/// One message to a reader.
#[derive(Debug, PartialEq)]
pub(super) enum Item {
    /// A text of JSON.
    Text(Arc<str>),
    /// New buckets of the history of this number.
    Samples(u32, Chunk),
    /// The last text.
    End(Arc<str>),
}

impl Feed {
    pub(super) fn new() -> Self {
        Self {
            state: Mutex::default(),
            changed: watch::Sender::new(()),
            readers: watch::Sender::new(0),
            visited: AtomicBool::new(false),
            stop: AtomicBool::new(false),
            taken: AtomicU64::new(0),
        }
    }

    /// Changes the state and wakes the readers.
    pub(super) fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.lock());
        self.changed.send_replace(());
    }

    /// As [`change`](Self::change), unless a reader copies a chunk at this moment. Returns whether it was done.
    pub(super) fn try_change(&self, change: impl FnOnce(&mut State)) -> bool {
        let Ok(mut state) = self.state.try_lock() else { return false };
        change(&mut state);
        drop(state);
        self.changed.send_replace(());
        true
    }

    /// The run has ended.
    pub(super) fn end(&self, end: Arc<str>) {
        self.change(|state| state.end = Some(end));
    }

    /// The next message for a reader; `None` until something changes.
    pub(super) fn next(&self, cursor: &mut Cursor) -> Option<Item> {
        let state = self.lock();
        if !cursor.is_described {
            let Some(description) = &state.description else { return state.end.clone().map(Item::End) };
            cursor.is_described = true;
            cursor.places = vec![0; state.histories.len()];
            return Some(Item::Text(Arc::clone(description)));
        }
        for (number, (history, place)) in (0..).zip(state.histories.iter().zip(&mut cursor.places)) {
            if let Some(chunk) = history.read(*place, CHUNK) {
                *place = chunk.next;
                return Some(Item::Samples(number, chunk));
            }
        }
        if cursor.statuses < state.statuses {
            cursor.statuses = state.statuses;
            return state.status.clone().map(Item::Text);
        }
        state.end.clone().map(Item::End)
    }

    /// What the run is, as a client of Foxglove takes it; `None` before its start.
    pub(super) fn introduction(&self) -> Option<Arc<Introduction>> {
        self.lock().introduction.clone()
    }

    /// At most `limit` messages from `place` on, and the place behind them.
    pub(super) fn messages(&self, place: u64, limit: usize) -> (Vec<Message>, u64) {
        self.lock().messages.read(place, limit)
    }

    /// The last text, once the run has ended.
    pub(super) fn ended(&self) -> Option<Arc<str>> {
        self.lock().end.clone()
    }

    /// A reader has taken messages.
    pub(super) fn note_taken(&self) {
        self.taken.fetch_add(1, Ordering::Relaxed);
    }

    /// Changes whenever a reader takes messages.
    pub(super) fn taken(&self) -> u64 {
        self.taken.load(Ordering::Relaxed)
    }

    /// Changes from now on.
    pub(super) fn changes(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    /// Counts a reader until the value is dropped.
    pub(super) fn enter(self: &Arc<Self>) -> Reader {
        self.readers.send_modify(|readers| *readers += 1);
        self.visited.store(true, Ordering::Relaxed);
        Reader(Arc::clone(self))
    }

    /// The number of connected readers.
    pub(super) fn readers(&self) -> watch::Receiver<usize> {
        self.readers.subscribe()
    }

    pub(super) fn was_visited(&self) -> bool {
        self.visited.load(Ordering::Relaxed)
    }

    pub(super) fn request_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(super) fn stop_asked(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // A state is whole between two changes, so one of a panicked thread is usable.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A connected reader.
pub(super) struct Reader(Arc<Feed>);

impl Reader {
    pub(super) fn feed(&self) -> &Feed {
        &self.0
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.0.readers.send_modify(|readers| *readers -= 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feed() -> Feed {
        let feed = Feed::new();
        feed.change(|state| {
            state.description = Some("run".into());
            state.histories = vec![History::new(0, 1_000)];
        });
        feed
    }

    fn all(feed: &Feed, cursor: &mut Cursor) -> Vec<Item> {
        std::iter::from_fn(|| feed.next(cursor)).take_while(|item| !matches!(item, Item::End(_))).collect()
    }

    #[test]
    fn a_late_reader_gets_description_history_and_the_newest_status() {
        let feed = feed();
        for status in ["first", "second"] {
            feed.change(|state| {
                state.histories[0].append(&[0.0; 200]);
                state.set_status(status.into());
            });
        }
        let mut cursor = Cursor::default();
        let items = all(&feed, &mut cursor);
        assert_eq!(items[0], Item::Text("run".into()));
        let places: Vec<_> = items[1..3]
            .iter()
            .map(|item| match item {
                Item::Samples(0, chunk) => (chunk.first, chunk.next),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(places, [(0, 256), (256, 400)]);
        assert_eq!(items[3..], [Item::Text("second".into())]);
        assert_eq!(feed.next(&mut cursor), None);
    }

    #[test]
    fn readers_have_places_of_their_own() {
        let feed = feed();
        let (mut early, mut late) = (Cursor::default(), Cursor::default());
        assert_eq!(all(&feed, &mut early).len(), 1);
        feed.change(|state| state.histories[0].append(&[1.0]));
        assert_eq!(all(&feed, &mut early).len(), 1);
        assert_eq!(all(&feed, &mut late).len(), 2);
    }

    #[test]
    fn the_end_comes_after_all_samples() {
        let feed = feed();
        feed.change(|state| state.histories[0].append(&[1.0; 300]));
        feed.end("PASS".into());
        let mut cursor = Cursor::default();
        assert_eq!(all(&feed, &mut cursor).len(), 3);
        assert_eq!(feed.next(&mut cursor), Some(Item::End("PASS".into())));
        let unstarted = Feed::new();
        unstarted.end("no drive".into());
        assert_eq!(unstarted.next(&mut Cursor::default()), Some(Item::End("no drive".into())));
    }

    #[test]
    fn a_locked_state_does_not_hold_up_the_run() {
        let feed = feed();
        let copying = feed.lock();
        assert!(!feed.try_change(|_| panic!("the state is locked")));
        drop(copying);
        assert!(feed.try_change(|state| state.set_status("now".into())));
    }
}
