//! The socket of the bench that the UART of an emulated board connects to.

use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixListener};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};
use std::{io, thread};

use lashloop_link::socket::Socket;

use super::drive_host::not_up;
use super::error::DeviceError;
use crate::supervisor::{Process, Wait};

/// Makes the names of this bench's sockets unique.
static SOCKETS: AtomicU32 = AtomicU32::new(0);

/// A listening socket in the abstract namespace, because a killed bench would leave a file behind.
pub(super) struct UartSocket {
    /// Its abstract name.
    pub(super) name: String,
    listener: UnixListener,
}

impl UartSocket {
    /// Opens a socket under a new name.
    ///
    /// # Errors
    /// The system refused.
    pub(super) fn listen() -> io::Result<Self> {
        let name = format!("lashloop-{}-{}", std::process::id(), SOCKETS.fetch_add(1, Ordering::Relaxed));
        let listener = UnixListener::bind_addr(&SocketAddr::from_abstract_name(&name)?)?;
        listener.set_nonblocking(true)?;
        Ok(Self { name, listener })
    }

    /// Waits for the connection of the emulated board.
    ///
    /// # Errors
    /// The process ended, or did not connect within `limit` though nothing kept it from that.
    pub(super) fn accept(self, process: &Process, limit: Duration) -> Result<Socket, DeviceError> {
        let deadline = Instant::now() + limit;
        let mut wait = process.watch.wait();
        let failed = |source| DeviceError::Spawn { name: process.name, source };
        loop {
            match self.listener.accept() {
                Ok((stream, _)) => return Socket::new(stream).map_err(failed),
                Err(error) if error.kind() != io::ErrorKind::WouldBlock => return Err(failed(error)),
                Err(_) if process.ended_within(Duration::ZERO).is_some() => return Err(not_up(process)),
                Err(_) if Instant::now() < deadline => thread::sleep(Duration::from_millis(2)),
                Err(_) if wait.is_excused() => thread::sleep(Wait::SLICE),
                Err(_) => return Err(not_up(process)),
            }
        }
    }
}
