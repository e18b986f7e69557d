//! A pseudo-terminal, opened by the path of its near end.
//!
//! The terminal driver does the waiting: with `VMIN` 0 and `VTIME` 1 a read returns with the first byte or after a
//! tenth of a second, so a round trip costs one write and one read and no poll. A deadline that is nearer than that is
//! waited for by poll, which knows nanoseconds. Writes go through a second description of
//! the same terminal, one that never waits, because a drive that does not read would hold the bench for ever.

use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, Mode, OFlags, flock};
use rustix::io::Errno;
use rustix::termios::{
    OptionalActions, QueueSelector, SpecialCodeIndex, Termios, tcflush, tcgetattr, tcsetattr, ttyname,
};

use super::{Link, LinkError, WRITE_LIMIT, readable_by, remaining};

/// Where the system keeps pseudo-terminals. They have no speed, no modem lines and no latency timer.
pub const DIRECTORY: &str = "/dev/pts";

/// How long a read waits for its first byte: `VTIME` counts in tenths of a second.
const READ_LIMIT: Duration = Duration::from_millis(100);

/// The near end of a pseudo-terminal. Dropping it gives the terminal its settings back.
pub struct Pty {
    reader: OwnedFd,
    writer: OwnedFd,
    settings_before: Termios,
}

impl Pty {
    /// Opens it in raw mode and for nobody else.
    ///
    /// # Errors
    /// It is not there, not a terminal, the one the bench itself was started from (`InvalidInput`), or another bench holds
    /// it (`WouldBlock`).
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
        set_raw(&reader, 0, 1)?;
        Ok(Self { reader, writer, settings_before })
    }

    /// Whether a read of nothing meant the end of the line rather than a tenth of a second of silence.
    fn hung_up(&self) -> Result<bool, LinkError> {
        let mut fds = [PollFd::new(&self.reader, PollFlags::IN)];
        poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 }))?;
        Ok(fds[0].revents().intersects(PollFlags::HUP | PollFlags::ERR))
    }

    /// Waits until the terminal takes bytes again.
    fn wait_for_room(&self) -> Result<(), LinkError> {
        let mut fds = [PollFd::new(&self.writer, PollFlags::OUT)];
        let limit = Timespec { tv_sec: WRITE_LIMIT.as_secs() as i64, tv_nsec: 0 };
        if poll(&mut fds, Some(&limit))? == 0 { Err(LinkError::Stuck) } else { Ok(()) }
    }
}

/// Puts a terminal into raw mode, its reads returning with `minimum` bytes or after `tenths` of a second.
///
/// # Errors
/// It is not a terminal, or gone.
pub fn set_raw(terminal: impl AsFd, minimum: u8, tenths: u8) -> io::Result<()> {
    let mut settings = tcgetattr(&terminal)?;
    settings.make_raw();
    settings.special_codes[SpecialCodeIndex::VMIN] = minimum;
    settings.special_codes[SpecialCodeIndex::VTIME] = tenths;
    Ok(tcsetattr(&terminal, OptionalActions::Now, &settings)?)
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
        // Of no use if the far end is gone, and then of no need.
        let _ = tcsetattr(&self.reader, OptionalActions::Now, &self.settings_before);
    }
}

impl Link for Pty {
    fn send(&mut self, mut bytes: &[u8]) -> Result<(), LinkError> {
        while !bytes.is_empty() {
            match rustix::io::write(&self.writer, bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(Errno::INTR) => {}
                Err(Errno::AGAIN) => self.wait_for_room()?,
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let is_near = remaining(deadline).is_none_or(|left| left < READ_LIMIT);
            if is_near && !readable_by(&self.reader, deadline)? {
                return Ok(0);
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
