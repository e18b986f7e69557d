//! Finished steps on their way from the loop's thread to the caller's, without a lock.

use std::sync::atomic::{AtomicBool, Ordering};

use rtrb::{Consumer, Producer, RingBuffer};

use crate::run::RunError;
use crate::run::control_loop::Sink;
use crate::run::step_sink::Step;

/// Steps that may wait to be recorded: 16 s at 1 kHz, and no disk is silent for longer.
const ROOM: usize = 1 << 14;

/// The loop's end of the ring.
pub(in crate::run) struct Ring<'a> {
    steps: Producer<Step>,
    stop: &'a AtomicBool,
}

impl<'a> Ring<'a> {
    /// A ring and its other end. `stop` asks the loop to end.
    pub(in crate::run) fn new(stop: &'a AtomicBool) -> (Self, Consumer<Step>) {
        let (steps, taken) = RingBuffer::new(ROOM);
        (Self { steps, stop }, taken)
    }
}

impl Sink for Ring<'_> {
    fn take(&mut self, step: Step) -> Result<(), RunError> {
        self.steps.push(step).map_err(|_| RunError::RecordBehind { steps: ROOM })
    }

    fn stop_asked(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Hands everything that has arrived to another sink. If that fails or is asked to stop, so is the loop.
///
/// # Errors
/// What the other sink said.
pub(in crate::run) fn drain(
    steps: &mut Consumer<Step>,
    to: &mut impl Sink,
    stop: &AtomicBool,
) -> Result<(), RunError> {
    let result = std::iter::from_fn(|| steps.pop().ok()).try_for_each(|step| to.take(step));
    if result.is_err() || to.stop_asked() {
        stop.store(true, Ordering::Relaxed);
    }
    result
}
