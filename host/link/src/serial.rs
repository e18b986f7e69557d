//! A serial port, by the `serialport` crate: exclusive, 8 data bits, no parity, one stop bit, no flow control.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, SerialPort, TTYPort};

use super::deadline::remaining;
use super::error::WRITE_LIMIT;
use super::{Link, LinkError};

/// An open serial port.
pub struct Serial {
    port: TTYPort,
    /// The timeout in force. Setting it is a system call, so it is set only when it changes.
    timeout: Duration,
}

impl Serial {
    /// Opens a port at `baud` bits per second.
    ///
    /// DTR is left as the driver sets it: a board that resets by DTR resets on opening, and the handshake is repeated until
    /// the drive is up.
    ///
    /// # Errors
    /// `path` is missing, isn't a serial port, or another program holds it: [`io::ErrorKind::ResourceBusy`].
    pub fn open(path: &Path, baud: u32) -> Result<Self, io::Error> {
        let port = serialport::new(path.to_string_lossy(), baud).timeout(WRITE_LIMIT).open_native();
        let port = port.map_err(|error| error_of_open(error.into(), path.exists()))?;
        Ok(Self { port, timeout: WRITE_LIMIT })
    }

    fn set_timeout(&mut self, timeout: Duration) -> Result<(), LinkError> {
        if self.timeout != timeout {
            self.port.set_timeout(timeout).map_err(|error| error_of_transfer(error.into()))?;
            self.timeout = timeout;
        }
        Ok(())
    }
}

impl Link for Serial {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.set_timeout(WRITE_LIMIT)?;
        self.port.write_all(bytes).map_err(|error| match error.kind() {
            io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => LinkError::Stuck,
            _ => error_of_transfer(error),
        })
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            // What has arrived is read even after the deadline.
            let left = remaining(deadline);
            self.set_timeout(left.unwrap_or_default().min(WRITE_LIMIT))?;
            match self.port.read(buffer) {
                // A terminal is readable without a byte when its device is disconnected.
                Ok(0) => return Err(LinkError::Disconnected),
                Ok(count) => return Ok(count),
                Err(error)
                    if !matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::Interrupted) =>
                {
                    return Err(error_of_transfer(error));
                }
                Err(_) if left.is_none() => return Ok(0),
                Err(_) => {}
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        // The crate drops the system's error code, and only a disconnected port fails here.
        self.port.clear(ClearBuffer::Input).map_err(|_| LinkError::Disconnected)
    }
}

/// The crate reports a port that another program holds as missing: it maps `EBUSY` and a lock that is taken to "no device".
fn error_of_open(error: io::Error, exists: bool) -> io::Error {
    match error.kind() {
        io::ErrorKind::NotFound if exists => io::Error::new(io::ErrorKind::ResourceBusy, error),
        _ => error,
    }
}

/// The crate drops the system's error code. What it reports as of kind `Other` during a transfer is `EIO`, `ENXIO` or
/// `ENODEV`, the errors of an adapter that was unplugged between the wait and the transfer.
fn error_of_transfer(error: io::Error) -> LinkError {
    match (error.kind(), error.raw_os_error()) {
        (io::ErrorKind::Other, None) => LinkError::Disconnected,
        _ => error.into(),
    }
}

#[cfg(test)]
mod tests {
    use serialport::{Error, ErrorKind};

    use super::*;

    #[test]
    fn an_adapter_unplugged_before_a_transfer_is_disconnected() {
        for text in ["I/O error", "No such device", "No such device or address"] {
            let error = error_of_transfer(Error::new(ErrorKind::Unknown, text).into());
            assert!(matches!(error, LinkError::Disconnected), "{text}: {error:?}");
        }
        let refused =
            error_of_transfer(Error::new(ErrorKind::Io(io::ErrorKind::PermissionDenied), "").into());
        assert!(matches!(refused, LinkError::Io(_)), "{refused:?}");
        let pipe = error_of_transfer(io::ErrorKind::BrokenPipe.into());
        assert!(matches!(pipe, LinkError::Disconnected), "{pipe:?}");
    }

    #[test]
    fn a_port_that_exists_and_is_held_is_busy_and_not_missing() {
        let no_device = || Error::new(ErrorKind::NoDevice, "Device or resource busy").into();
        assert_eq!(error_of_open(no_device(), true).kind(), io::ErrorKind::ResourceBusy);
        assert_eq!(error_of_open(no_device(), false).kind(), io::ErrorKind::NotFound);
        let refused = io::ErrorKind::PermissionDenied.into();
        assert_eq!(error_of_open(refused, true).kind(), io::ErrorKind::PermissionDenied);
    }

    #[test]
    fn a_terminal_that_another_program_has_locked_is_busy() {
        let terminal = crate::terminal::Terminal::open().unwrap();
        let holder = Serial::open(&terminal.path, 115_200).unwrap();
        let error = Serial::open(&terminal.path, 115_200).err().expect("a second host is rejected");
        assert_eq!(error.kind(), io::ErrorKind::ResourceBusy, "{error}");
        drop(holder);
        let missing = Serial::open(Path::new("/dev/ttyUSB-none"), 115_200).err().expect("no such port");
        assert_eq!(missing.kind(), io::ErrorKind::NotFound, "{missing}");
    }
}
