//! A connected stream socket: the emulator's UART without the delays of its pseudo-terminal, or a TCP connection.

use std::io;
use std::os::fd::OwnedFd;
use std::time::{Duration, Instant};

use rustix::io::Errno;
use rustix::net::sockopt::{Timeout, set_socket_timeout};
use rustix::net::{RecvFlags, SendFlags, recv, send};

use super::deadline::{readable_by, remaining};
use super::error::{WHOLE_WRITE_LIMIT, WRITE_LIMIT};
use super::{Link, LinkError};

/// The kernel does the waiting, in slices of this length: changing a timeout would cost a system call. A nearer deadline is
/// waited for by poll.
const SLICE: Duration = Duration::from_millis(50);

/// A connected stream socket.
pub struct Socket {
    stream: OwnedFd,
}

impl Socket {
    /// Takes over a connected Unix or TCP stream.
    ///
    /// # Errors
    /// The system refused to set the time limits.
    pub fn new(stream: impl Into<OwnedFd>) -> io::Result<Self> {
        let stream = stream.into();
        rustix::io::ioctl_fionbio(&stream, false)?;
        set_socket_timeout(&stream, Timeout::Recv, Some(SLICE))?;
        set_socket_timeout(&stream, Timeout::Send, Some(WRITE_LIMIT))?;
        Ok(Self { stream })
    }

    /// Copies the first bytes that wait, or arrive until the deadline, and leaves them on the line.
    ///
    /// # Errors
    /// The far end is disconnected or the system refused.
    pub fn peek(&self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        if !readable_by(&self.stream, deadline)? {
            return Ok(0);
        }
        Ok(recv(&self.stream, buffer, RecvFlags::PEEK)?.0)
    }
}

impl Link for Socket {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, mut bytes: &[u8]) -> Result<(), LinkError> {
        let mut give_up = None;
        while !bytes.is_empty() {
            match send(&self.stream, bytes, SendFlags::NOSIGNAL) {
                Ok(count) if count == bytes.len() => return Ok(()),
                Ok(count) => {
                    bytes = &bytes[count..];
                    let give_up = *give_up.get_or_insert_with(|| Instant::now() + WHOLE_WRITE_LIMIT);
                    if remaining(give_up).is_none() {
                        return Err(LinkError::Stuck);
                    }
                }
                Err(Errno::INTR) => {}
                // The time limit of the socket has passed.
                Err(Errno::AGAIN) => return Err(LinkError::Stuck),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let is_near = remaining(deadline).is_none_or(|left| left < SLICE);
            if is_near && !readable_by(&self.stream, deadline)? {
                return Ok(0);
            }
            match rustix::io::read(&self.stream, &mut *buffer) {
                Ok(0) => return Err(LinkError::Disconnected),
                Ok(count) => return Ok(count),
                Err(Errno::AGAIN | Errno::INTR) => {
                    if remaining(deadline).is_none() {
                        return Ok(0);
                    }
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        // As much as a socket holds at most. A drive that fills it continues to send, and the rest is no older.
        let mut rest = vec![0; 1 << 18];
        match recv(&self.stream, &mut rest[..], RecvFlags::DONTWAIT) {
            Ok((0, _)) => Err(LinkError::Disconnected),
            Ok(_) | Err(Errno::AGAIN) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }
}
