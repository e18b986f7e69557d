//! What paces a run.

use std::time::Duration;

use crate::timing::ClockName;

/// What paces a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Clock {
    /// The plant waits for the drive and the drive for the plant.
    #[default]
    Lockstep,
    /// Lockstep for many runs: with a drive in this process no step is timed, because the readings of the clock would take a
    /// tenth of the run. Its outcome has no round trips and no wall-clock time.
    Untimed,
    /// The wall clock.
    RealTime(RealTime),
    /// Real time on the link's own virtual clock, which only a drive in this process has. What is late is late by what the link
    /// does, in every run the same: for tests of late samples, answers and benches.
    Scripted,
}

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

impl Clock {
    /// Its name, without the options.
    #[must_use]
    pub fn name(&self) -> ClockName {
        match self {
            Self::Lockstep | Self::Untimed => ClockName::Lockstep,
            Self::RealTime(_) | Self::Scripted => ClockName::RealTime,
        }
    }
}
