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
    /// `path` is missing, is no serial port, or another program holds it.
    pub fn open(path: &Path, baud: u32) -> Result<Self, io::Error> {
        let port = serialport::new(path.to_string_lossy(), baud).timeout(WRITE_LIMIT).open_native()?;
        Ok(Self { port, timeout: WRITE_LIMIT })
    }

    fn set_timeout(&mut self, timeout: Duration) -> Result<(), LinkError> {
        if self.timeout != timeout {
            self.port.set_timeout(timeout).map_err(io::Error::from)?;
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
        self.port.write_all(bytes).map_err(LinkError::of_write)
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
                    return Err(error.into());
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
