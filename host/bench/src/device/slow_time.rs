//! The time of a device that is emulated in lockstep.

use std::time::{Duration, Instant};

use lashloop_link::{Link, LinkError};

/// Wall-clock time for a unit of the link's time. The chip answers within milliseconds of its own time, but its emulation on
/// a busy machine may take seconds. A request that is retransmitted meanwhile would be received twice, and the run would
/// not repeat bit for bit.
const SLOWER: u32 = 40;

/// A link whose time is slower than the wall clock, and with it every timeout.
pub(super) struct SlowTime<L> {
    link: L,
    began: Instant,
}

impl<L: Link> SlowTime<L> {
    pub(super) fn new(link: L) -> Self {
        Self { link, began: Instant::now() }
    }

    fn wall_clock(&self, at: Instant) -> Instant {
        let elapsed = at.saturating_duration_since(self.began);
        self.began + elapsed.saturating_mul(SLOWER).min(LONGEST)
    }
}

/// Far beyond any timeout, and short enough to be added to an instant.
const LONGEST: Duration = Duration::from_secs(1 << 30);

impl<L: Link> Link for SlowTime<L> {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut self.link)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let deadline = self.wall_clock(deadline);
        self.link.receive(buffer, deadline)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.link.discard_input()
    }

    fn now(&mut self) -> Instant {
        self.began + self.began.elapsed() / SLOWER
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        let until = self.wall_clock(until);
        self.link.wait_until(until)
    }

    fn idle(&mut self, until: Instant) -> Result<(), LinkError> {
        let until = self.wall_clock(until);
        self.link.idle(until)
    }
}
