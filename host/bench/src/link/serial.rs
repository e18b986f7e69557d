//! A serial port, by the `serialport` crate: exclusive, 8 data bits, no parity, one stop bit, no flow control.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, SerialPort, TTYPort};

use super::{Link, LinkError, WRITE_LIMIT, remaining, stuck};

/// A serial port.
pub struct Serial {
    port: TTYPort,
    /// What the port waits at most, so that it is told only when it changes.
    timeout: Duration,
}

impl Serial {
    /// Opens a port at `baud` bits a second.
    ///
    /// DTR is left as the driver sets it: on boards that reset by DTR the open is a reset, and the greeting waits for
    /// the drive to come up.
    ///
    /// # Errors
    /// It is not there, not a serial port, or another program holds it.
    pub fn open(path: &Path, baud: u32) -> Result<Self, io::Error> {
        let port = serialport::new(path.to_string_lossy(), baud).timeout(WRITE_LIMIT).open_native()?;
        Ok(Self { port, timeout: WRITE_LIMIT })
    }

    fn wait_at_most(&mut self, timeout: Duration) -> Result<(), LinkError> {
        if self.timeout != timeout {
            self.port.set_timeout(timeout).map_err(io::Error::from)?;
            self.timeout = timeout;
        }
        Ok(())
    }
}

impl Link for Serial {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.wait_at_most(WRITE_LIMIT)?;
        self.port.write_all(bytes).map_err(stuck)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            // What is there already is read even after the deadline.
            let left = remaining(deadline);
            self.wait_at_most(left.unwrap_or_default().min(WRITE_LIMIT))?;
            match self.port.read(buffer) {
                // A terminal that is readable and has nothing to read is one whose device is gone.
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
        // The crate keeps the system's reason to itself, and there is one reason only: the port is gone.
        self.port.clear(ClearBuffer::Input).map_err(|_| LinkError::Disconnected)
    }
}
