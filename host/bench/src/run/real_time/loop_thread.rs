//! The loop's thread, and the lock-free ring that passes finished steps from it to the caller's thread.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use rtrb::{Consumer, Producer, RingBuffer};

use crate::run::error::RunError;
use crate::run::step_sink::{Item, StepSink};

/// Steps that may wait to be recorded: 16 s at 1 kHz, longer than a disk stalls.
const CAPACITY: usize = 1 << 14;

/// The loop's end of the ring.
pub(in crate::run) struct Ring<'a> {
    items: Producer<Item>,
    stop: &'a AtomicBool,
}

impl<'a> Ring<'a> {
    /// Both ends of a ring. `stop` ends the loop early.
    pub(in crate::run) fn new(stop: &'a AtomicBool) -> (Self, Consumer<Item>) {
        let (items, taken) = RingBuffer::new(CAPACITY);
        (Self { items, stop }, taken)
    }
}

impl StepSink for Ring<'_> {
    fn take(&mut self, item: Item) -> Result<(), RunError> {
        self.items.push(item).map_err(|_| RunError::RecordBehind { steps: CAPACITY })
    }

    fn stop_asked(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Passes all waiting steps to another sink. Stops the loop if the sink fails or is asked to stop.
///
/// # Errors
/// The sink failed.
pub(in crate::run) fn drain(
    items: &mut Consumer<Item>,
    to: &mut impl StepSink,
    stop: &AtomicBool,
) -> Result<(), RunError> {
    let result = std::iter::from_fn(|| items.pop().ok()).try_for_each(|item| to.take(item));
    if result.is_err() || to.stop_asked() {
        stop.store(true, Ordering::Relaxed);
    }
    result
}

/// Time between two calls that drain the finished steps.
const DRAIN_INTERVAL: Duration = Duration::from_millis(5);

/// Runs `work` on a thread of its own while `drain` is called on this one every few milliseconds, and once after the end.
///
/// # Errors
/// The system refused the thread.
pub(in crate::run) fn run_with_drain<T: Send>(
    work: impl FnOnce() -> T + Send,
    mut drain: impl FnMut(),
) -> Result<T, std::io::Error> {
    thread::scope(|scope| {
        let work = thread::Builder::new().name("loop".to_owned()).spawn_scoped(scope, work)?;
        tracing::debug!(thread = "loop", "started");
        while !work.is_finished() {
            drain();
            thread::sleep(DRAIN_INTERVAL);
        }
        let done = work.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        drain();
        Ok(done)
    })
}
