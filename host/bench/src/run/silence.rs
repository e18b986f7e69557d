//! For how long the drive has been silent.

use std::time::{Duration, Instant};

/// The silence of the drive, in the link's time.
#[derive(Debug)]
pub(super) struct Silence {
    /// When the first sample was sent that has no answer yet; `None` if the latest one was answered.
    since: Option<Instant>,
    limit: Duration,
}

impl Silence {
    pub(super) fn new(limit: Duration) -> Self {
        Self { since: None, limit }
    }

    /// The longest silence that the scenario allows.
    pub(super) fn limit(&self) -> Duration {
        self.limit
    }

    /// When the limit is reached, if the sample sent at `sent` gets no answer.
    pub(super) fn ends_at(&self, sent: Instant) -> Instant {
        self.since.unwrap_or(sent) + self.limit
    }

    /// The sample sent at `sent` got no answer.
    pub(super) fn extend(&mut self, sent: Instant) {
        self.since.get_or_insert(sent);
    }

    /// The drive has answered or was restarted.
    pub(super) fn end(&mut self) {
        self.since = None;
    }
}
