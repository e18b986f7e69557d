//! A pseudo-terminal, opened by the path of its near end.
//!
//! The terminal driver does the waiting: with `VMIN` 0 and `VTIME` 1 a read returns with the first byte or after a
//! tenth of a second, so a round trip costs one write and one read and no poll. A nearer deadline is waited for by poll,
//! which resolves nanoseconds. Before a long wait a few reads don't wait at all ([`Spin`]). Writes go through a second,
//! non-blocking description of the same terminal, because a drive that does not read would block the bench forever.

use std::io;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, Mode, OFlags, flock};
use rustix::io::Errno;
use rustix::termios::{OptionalActions, QueueSelector, Termios, tcflush, tcgetattr, tcsetattr, ttyname};

use super::deadline::{readable_by, remaining, send_all};
use super::spin::Spin;
use super::terminal::set_raw;
use super::{Link, LinkError};

/// Where the system keeps pseudo-terminals. They have no speed, no modem lines and no latency timer.
pub const DIRECTORY: &str = "/dev/pts";

/// Timeout of a read.
const READ_LIMIT: Duration = Duration::from_millis(100);
/// The same in the unit of `VTIME`.
const READ_LIMIT_TENTHS_S: u8 = 1;

/// The near end of a pseudo-terminal. Dropping it restores the terminal's settings.
pub struct Pty {
    reader: OwnedFd,
    writer: OwnedFd,
    settings_before: Termios,
    spin: Spin,
}

impl Pty {
    /// Opens the near end in raw mode and locks it.
    ///
    /// # Errors
    /// `path` is missing, isn't a terminal, is the terminal that the bench was started from (`InvalidInput`), or another
    /// bench holds it (`WouldBlock`).
    pub fn open(path: &Path) -> io::Result<Self> {
        if is_own_terminal(path) {
            let reason = "this is the terminal the bench was started from; a drive has another";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let reader = rustix::fs::open(path, flags, Mode::empty())?;
        flock(&reader, FlockOperation::NonBlockingLockExclusive)?;
        let writer = rustix::fs::open(path, flags | OFlags::NONBLOCK, Mode::empty())?;
        let settings_before = tcgetattr(&reader)?;
        set_raw(&reader, 0, READ_LIMIT_TENTHS_S)?;
        Ok(Self { reader, writer, settings_before, spin: Spin::default() })
    }

    /// Whether a read of zero bytes was the end of the line rather than a timeout.
    fn hung_up(&self) -> Result<bool, LinkError> {
        let mut fds = [PollFd::new(&self.reader, PollFlags::IN)];
        poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 }))?;
        Ok(fds[0].revents().intersects(PollFlags::HUP | PollFlags::ERR))
    }
}

fn is_own_terminal(path: &Path) -> bool {
    let own = [
        ttyname(rustix::stdio::stdin(), []),
        ttyname(rustix::stdio::stdout(), []),
        ttyname(rustix::stdio::stderr(), []),
    ];
    own.into_iter().flatten().any(|name| Path::new(&*name.to_string_lossy()) == path)
}

impl Drop for Pty {
    fn drop(&mut self) {
        // Fails only on a disconnected terminal, which has no settings to restore.
        let _ = tcsetattr(&self.reader, OptionalActions::Now, &self.settings_before);
    }
}

impl Link for Pty {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        send_all(&self.writer, bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let is_near = remaining(deadline).is_none_or(|left| left < READ_LIMIT);
            if is_near && !readable_by(&self.reader, deadline)? {
                return Ok(0);
            }
            if !is_near {
                let writer = &self.writer;
                let at_once =
                    self.spin.first(|| rustix::io::read(writer, &mut *buffer).ok().filter(|it| *it > 0));
                if let Some(count) = at_once {
                    return Ok(count);
                }
            }
            match rustix::io::read(&self.reader, &mut *buffer) {
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
        Ok(tcflush(&self.reader, QueueSelector::IFlush)?)
    }
}
