//! Time by the drive's clock: an emulated drive and its line are slower than the bench.

use super::client::Client;
use crate::prelude::wire::*;

/// The moment of the latest answer, by the drive's clock if it has one.
#[derive(Clone, Copy)]
pub(super) struct Moment {
    at: Instant,
    device_us: Option<u32>,
}

impl Moment {
    pub(super) fn latest(client: &mut Client) -> Self {
        Self { at: client.line.now(), device_us: client.arrivals.device_us }
    }

    pub(super) const fn has_own_clock(self) -> bool {
        self.device_us.is_some()
    }

    /// The time since then, up to the latest answer.
    pub(super) fn elapsed(self, client: &mut Client) -> Duration {
        self.until(Self::latest(client))
    }

    pub(super) fn until(self, later: Self) -> Duration {
        match self.device_us.zip(later.device_us) {
            Some((from_us, to_us)) => Duration::from_micros(to_us.wrapping_sub(from_us).into()),
            None => later.at.saturating_duration_since(self.at),
        }
    }
}
