//! A Unix socket: the emulator's UART without the delays of its pseudo-terminal.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use super::deadline::{readable_by, remaining};
use super::error::WRITE_LIMIT;
use super::{Link, LinkError};

/// The kernel does the waiting, in slices of this length: changing a timeout would cost a system call. A nearer deadline is
/// waited for by poll.
const SLICE: Duration = Duration::from_millis(50);

/// A connected socket.
pub struct Socket {
    stream: UnixStream,
}

impl Socket {
    /// Takes over a connected stream.
    ///
    /// # Errors
    /// The system refused to set the time limits.
    pub fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(SLICE))?;
        stream.set_write_timeout(Some(WRITE_LIMIT))?;
        Ok(Self { stream })
    }
}

impl Link for Socket {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.stream.write_all(bytes).map_err(LinkError::of_write)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let is_near = remaining(deadline).is_none_or(|left| left < SLICE);
            if is_near && !readable_by(&self.stream, deadline)? {
                return Ok(0);
            }
            match self.stream.read(buffer) {
                Ok(0) => return Err(LinkError::Disconnected),
                Ok(count) => return Ok(count),
                Err(error)
                    if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) =>
                {
                    if remaining(deadline).is_none() {
                        return Ok(0);
                    }
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        // As much as a socket holds at most. A drive that fills it goes on sending, and the rest is no older.
        let mut rest = vec![0; 1 << 18];
        self.stream.set_nonblocking(true)?;
        let drained = match self.stream.read(&mut rest) {
            Ok(0) => Err(LinkError::Disconnected),
            Err(error) if error.kind() != io::ErrorKind::WouldBlock => Err(error.into()),
            _ => Ok(()),
        };
        self.stream.set_nonblocking(false)?;
        drained
    }
}
