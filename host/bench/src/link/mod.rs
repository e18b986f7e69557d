//! Anything that carries bytes to a drive and back.
//!
//! | link | reaches |
//! |---|---|
//! | [`in_process`] | the drive in this very process, called directly |
//! | [`pty`] | a drive on a pseudo-terminal: the native twin, or a foreign one |
//! | [`serial`] | a drive on a serial port, by the `serialport` crate |
//! | [`socket`] | the emulator's UART |
//! | [`reopening`] | a terminal, again after it was gone |
//! | [`wire`] | any of these but a serial port, as slow as one |
//! | [`capture`] | any of these, with a record of every frame |
//!
//! Every wait has a deadline, and the end of a line is an error on its own: a terminal whose far end is gone reads as
//! "nothing yet" for ever if one lets it.

pub mod in_process;
pub mod pty;
pub mod reopening;
pub mod serial;
pub mod socket;
pub mod uart_model;

use std::io;
use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// What can go wrong with a line.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The far end is gone: unplugged, closed or killed.
    #[error("the far end closed the line")]
    Disconnected,
    /// The line takes no more bytes.
    #[error("the line took no bytes for {} s: the drive does not read", WRITE_LIMIT.as_secs())]
    Stuck,
    /// The operating system refused.
    #[error("{0}")]
    Io(io::Error),
}

/// A write that takes longer than this is to a line that no longer takes anything.
const WRITE_LIMIT: Duration = Duration::from_secs(1);

/// The error of a write with a time limit.
fn stuck(error: io::Error) -> LinkError {
    match error.kind() {
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => LinkError::Stuck,
        _ => error.into(),
    }
}

impl From<io::Error> for LinkError {
    fn from(error: io::Error) -> Self {
        use io::ErrorKind::{BrokenPipe, ConnectionReset, NotConnected, UnexpectedEof};
        // EIO is what a terminal says when the other side of it is closed or unplugged; ENXIO and ENODEV likewise.
        let gone = matches!(error.raw_os_error(), Some(5 | 6 | 19));
        if gone || matches!(error.kind(), BrokenPipe | ConnectionReset | NotConnected | UnexpectedEof) {
            Self::Disconnected
        } else {
            Self::Io(error)
        }
    }
}

impl From<rustix::io::Errno> for LinkError {
    fn from(error: rustix::io::Errno) -> Self {
        io::Error::from(error).into()
    }
}

/// A line to a drive.
pub trait Link: Send {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// The line is gone or the system refused; some of the bytes may have been sent.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;

    /// Waits until at least one byte has arrived or the deadline has passed, and returns the number of bytes put into
    /// `buffer`: zero only after the deadline.
    ///
    /// # Errors
    /// The line is gone or the system refused.
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError>;

    /// Says that nobody is going to ask for anything until a moment. A line that lives by being called, as a modelled wire
    /// does, passes on what is on its way until then; any other returns at once.
    ///
    /// # Errors
    /// The line is gone or the system refused.
    fn idle(&mut self, until: Instant) -> Result<(), LinkError> {
        let _ = until;
        Ok(())
    }

    /// Throws away what has arrived and not been read: the rest of somebody else's conversation.
    ///
    /// # Errors
    /// The line is gone or the system refused.
    fn discard_input(&mut self) -> Result<(), LinkError>;
}

/// Time until the deadline; `None` once it has passed.
fn remaining(deadline: Instant) -> Option<Duration> {
    deadline.checked_duration_since(Instant::now()).filter(|left| !left.is_zero())
}

/// Whether there is something to read by the deadline; the end of the line is something.
fn readable_by(line: impl AsFd, deadline: Instant) -> Result<bool, LinkError> {
    loop {
        let mut fds = [PollFd::new(&line, PollFlags::IN)];
        let left = remaining(deadline).unwrap_or_default();
        let left = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: left.subsec_nanos().into() };
        match poll(&mut fds, Some(&left)) {
            Ok(count) => return Ok(count > 0),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
}
