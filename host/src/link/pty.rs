//! A pseudo-terminal, opened by the path of its near end.
//!
//! The terminal driver does the waiting: with `VMIN` 0 and `VTIME` 1 a read returns with the first byte or after a
//! tenth of a second, so a round trip costs one write and one read and no poll.

use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::Instant;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, Mode, OFlags, flock};
use rustix::io::Errno;
use rustix::termios::{OptionalActions, QueueSelector, SpecialCodeIndex, tcflush, tcgetattr, tcsetattr};

use super::{Link, LinkError, remaining};

/// Where the system keeps pseudo-terminals. They have no speed, no modem lines and no latency timer.
pub const DIRECTORY: &str = "/dev/pts";

/// The near end of a pseudo-terminal.
pub struct Pty {
    near_end: OwnedFd,
}

impl Pty {
    /// Opens it in raw mode and for nobody else.
    ///
    /// # Errors
    /// It is not there, not a terminal, or another bench holds it (`WouldBlock`).
    pub fn open(path: &Path) -> Result<Self, std::io::Error> {
        let near_end =
            rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        flock(&near_end, FlockOperation::NonBlockingLockExclusive)?;
        let mut settings = tcgetattr(&near_end)?;
        settings.make_raw();
        settings.special_codes[SpecialCodeIndex::VMIN] = 0;
        settings.special_codes[SpecialCodeIndex::VTIME] = 1;
        tcsetattr(&near_end, OptionalActions::Now, &settings)?;
        Ok(Self { near_end })
    }

    /// Whether a read of nothing meant the end of the line rather than a tenth of a second of silence.
    fn hung_up(&self) -> Result<bool, LinkError> {
        let mut fds = [PollFd::new(&self.near_end, PollFlags::IN)];
        poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 }))?;
        Ok(fds[0].revents().intersects(PollFlags::HUP | PollFlags::ERR))
    }
}

impl Link for Pty {
    fn send(&mut self, mut bytes: &[u8]) -> Result<(), LinkError> {
        while !bytes.is_empty() {
            match rustix::io::write(&self.near_end, bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            match rustix::io::read(&self.near_end, &mut *buffer) {
                Ok(0) if self.hung_up()? => return Err(LinkError::Disconnected),
                Ok(0) | Err(Errno::INTR) => {
                    if remaining(deadline).is_none() {
                        return Ok(0);
                    }
                }
                Ok(count) => return Ok(count),
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        Ok(tcflush(&self.near_end, QueueSelector::IFlush)?)
    }
}
