//! The contract of a link.

use std::thread;
use std::time::{Duration, Instant};

use super::LinkError;
use super::deadline::remaining;

/// The clock that a link with a time of its own follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeBase {
    /// Virtual time: it advances only while the bench waits, and then at once. A modelled UART takes wall-clock time all the
    /// same.
    Virtual,
    /// Wall-clock time.
    WallClock,
    /// Virtual time for real time, a modelled UART included: a run depends on what the link does alone, not on the machine.
    Scripted,
}

/// Carries bytes to a drive and back.
///
/// Deadlines are instants of the link's own time, [`Link::now`]. It is wall-clock time everywhere but in process, where a
/// lockstep run has a virtual clock.
pub trait Link: Send {
    /// The link that a middleware wraps; `None` for a link that reaches a drive by itself, and while there is none.
    /// Every method with a default forwards to it.
    fn inner(&mut self) -> Option<&mut dyn Link>;

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// The far end is disconnected or the system refused; some of the bytes may have been sent.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;

    /// Waits until at least one byte has arrived or the deadline has passed, and returns the number of bytes put into
    /// `buffer`: zero only after the deadline.
    ///
    /// # Errors
    /// The far end is disconnected or the system refused.
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError>;

    /// Discards what has arrived and has not been read: the rest of another session.
    ///
    /// # Errors
    /// The far end is disconnected or the system refused.
    fn discard_input(&mut self) -> Result<(), LinkError>;

    /// The link's present time.
    fn now(&mut self) -> Instant {
        self.inner().map_or_else(Instant::now, Link::now)
    }

    /// Waits until an instant of the link's time. The drive continues meanwhile.
    ///
    /// # Errors
    /// The far end is disconnected or the system refused.
    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        match self.inner() {
            Some(inner) => inner.wait_until(until),
            None => {
                thread::sleep(remaining(until).unwrap_or_default());
                Ok(())
            }
        }
    }

    /// Announces that the bench sends and receives nothing until `until`. A link that moves bytes only while it is called,
    /// as the UART model does, moves them until then; any other link returns at once.
    ///
    /// # Errors
    /// The far end is disconnected or the system refused.
    fn idle(&mut self, until: Instant) -> Result<(), LinkError> {
        self.inner().map_or(Ok(()), |inner| inner.idle(until))
    }

    /// Time for which the programs at the far end have waited for a core, as far as the bench has started them; else zero.
    fn starved(&mut self) -> Duration {
        self.inner().map_or(Duration::ZERO, Link::starved)
    }

    /// Chooses the clock of a link that has a time of its own. Any other link follows the wall clock and ignores this.
    fn set_time_base(&mut self, time_base: TimeBase) {
        if let Some(inner) = self.inner() {
            inner.set_time_base(time_base);
        }
    }
}
