//! What paces a run.

use super::real_time::RealTime;
use crate::timing::ClockName;

/// What paces a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Clock {
    /// The plant waits for the drive and the drive for the plant.
    #[default]
    Lockstep,
    /// The wall clock.
    RealTime(RealTime),
    /// Real time on the link's own virtual clock, which only a drive in this process has. What is late is late by what the link
    /// does, in every run the same: for tests of late samples, answers and benches.
    Scripted,
}

impl Clock {
    /// Its name, without the options.
    #[must_use]
    pub fn name(&self) -> ClockName {
        match self {
            Self::Lockstep => ClockName::Lockstep,
            Self::RealTime(_) | Self::Scripted => ClockName::RealTime,
        }
    }
}
