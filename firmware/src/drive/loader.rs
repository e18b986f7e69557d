//! The way into the boot loader of the chip, by request.

use core::time::Duration;

use lashloop_protocol::enums::{Outcome, State};

/// From the request to the exit: the answer has left the line by then.
const EXIT_AFTER: Duration = Duration::from_millis(20);

/// The boot loader of a chip as the drive sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Loader {
    /// The drive has no boot loader.
    #[default]
    Absent,
    Present,
    /// The firmware ends at this device time.
    Requested {
        exit_at: Duration,
    },
}

impl Loader {
    /// Takes a request in this state of the drive.
    pub(super) fn request(&mut self, state: State, now: Duration) -> Result<(), Outcome> {
        if *self != Self::Present || state != State::Idle {
            return Err(Outcome::WrongState);
        }
        *self = Self::Requested { exit_at: now + EXIT_AFTER };
        Ok(())
    }

    pub(super) fn is_requested(self) -> bool {
        matches!(self, Self::Requested { .. })
    }

    pub(super) fn is_due(self, now: Duration) -> bool {
        matches!(self, Self::Requested { exit_at } if now >= exit_at)
    }
}
