//! The time of a program that the bench started.

use std::time::{Duration, Instant};

use lashloop_link::{Link, LinkError, TimeBase};

use crate::supervisor::{Wait, Watch};

/// A link to a program that the bench started. Its time stands still at the end of a wait in which the program could not answer,
/// see [`Wait::is_excused`]: in virtual time the bench waits for such a program as long as that lives. The plant waits too, so
/// a run on a busy machine is the same as on an idle one.
pub(super) struct OwnTime {
    link: Box<dyn Link>,
    program: Watch,
    time_base: TimeBase,
    /// Time for which the link's time stood still.
    stood_still: Duration,
}

impl OwnTime {
    /// A link on the wall clock; [`Link::set_time_base`] changes that.
    pub(super) fn new(link: Box<dyn Link>, program: Watch) -> Self {
        Self { link, program, time_base: TimeBase::WallClock, stood_still: Duration::ZERO }
    }
}

impl Link for OwnTime {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let left = deadline.saturating_duration_since(self.now());
        let mut wait = self.program.wait();
        loop {
            let count = self.link.receive(buffer, deadline + self.stood_still)?;
            // A look at what has arrived doesn't wait.
            let may_wait = count == 0 && !left.is_zero() && self.time_base == TimeBase::Virtual;
            if !may_wait || !wait.is_excused() {
                return Ok(count);
            }
            let until = self.link.now() + Wait::SLICE.min(left);
            self.stood_still = until.saturating_duration_since(deadline);
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.link.discard_input()
    }

    fn now(&mut self) -> Instant {
        let now = self.link.now();
        now.checked_sub(self.stood_still).unwrap_or(now)
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        self.link.wait_until(until + self.stood_still)
    }

    fn idle(&mut self, until: Instant) -> Result<(), LinkError> {
        self.link.idle(until + self.stood_still)
    }

    fn starved(&mut self) -> Duration {
        self.program.starved()
    }

    fn set_time_base(&mut self, time_base: TimeBase) {
        self.time_base = time_base;
        if time_base != TimeBase::Virtual {
            self.stood_still = Duration::ZERO;
        }
        self.link.set_time_base(time_base);
    }
}
