//! The time that a session spends waiting for answers, all requests together.

use std::time::Duration;

/// Time that a session waits for answers, all requests from the opening of its line to the start of a run together. A
/// request has its own limit, but a drive may have hundreds of parameters and answer each just in time.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// What is left of [`PATIENCE`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Patience {
    left: Duration,
    /// Waits so far.
    pub waits: u32,
}

impl Default for Patience {
    fn default() -> Self {
        Self { left: PATIENCE, waits: 0 }
    }
}

impl Patience {
    /// The part of `limit` that is left.
    pub fn within(&self, limit: Duration) -> Duration {
        limit.min(self.left)
    }

    pub fn is_exhausted(&self) -> bool {
        self.left.is_zero()
    }

    /// A wait has taken `time`.
    pub fn spend(&mut self, time: Duration) {
        self.left = self.left.saturating_sub(time);
        self.waits += 1;
    }
}
