//! The drive in this process: frames go through the same encoder, decoder and state machine, but no line.
//!
//! Its device time stands still. In lockstep the drive has all the time it wants, and nobody can pull the line.

use std::time::Instant;

use lashloop_firmware::drive::{Drive, ManualClock};

use super::{Link, LinkError};

/// Name of the board in the identity of a drive in process.
pub const BOARD: &str = "in-process";

/// A drive, and what it said and nobody has read yet.
pub struct InProcess {
    drive: Drive,
    said: Vec<u8>,
}

impl Default for InProcess {
    fn default() -> Self {
        Self { drive: Drive::new(BOARD), said: Vec::new() }
    }
}

impl Link for InProcess {
    fn send(&mut self, mut bytes: &[u8]) -> Result<(), LinkError> {
        while !bytes.is_empty() {
            let used = self.drive.receive(bytes, &ManualClock::default());
            bytes = &bytes[used..];
            self.said.extend_from_slice(self.drive.output());
            self.drive.clear_output();
        }
        Ok(())
    }

    /// Never waits: a drive in process has said what it has to say when [`Link::send`] returns.
    fn receive(&mut self, buffer: &mut [u8], _deadline: Instant) -> Result<usize, LinkError> {
        let count = self.said.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.said[..count]);
        self.said.drain(..count);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.said.clear();
        Ok(())
    }
}
