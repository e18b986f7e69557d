//! What the loop's thread asks of the system.

use std::time::Duration;

/// What the loop's thread asks of the system.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RealTime {
    /// How long before a step the thread stops sleeping and polls the clock.
    pub spin: Duration,
    /// Priority under SCHED_FIFO, 1 to 99; `None` for the normal scheduler.
    pub fifo_priority: Option<u8>,
    /// Keeps the memory of the process from being paged out.
    pub lock_memory: bool,
    /// The core that the thread is pinned to; `None` for any.
    pub core: Option<usize>,
}
