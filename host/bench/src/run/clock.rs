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
}

impl Clock {
    /// Its name, without the options.
    #[must_use]
    pub fn name(&self) -> ClockName {
        match self {
            Self::Lockstep => ClockName::Lockstep,
            Self::RealTime(_) => ClockName::RealTime,
        }
    }
}
