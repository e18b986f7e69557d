//! A link whose waits end at SIGINT and SIGTERM.

use std::io;
use std::time::{Duration, Instant};

use lashloop_bench::supervisor::is_interrupted;
use lashloop_link::{Link, LinkError};

/// Time between two looks.
const SLICE: Duration = Duration::from_millis(100);

/// Waits in slices and fails once a signal has arrived, so that a drive that is silent keeps nobody waiting.
pub(crate) struct Interruptible(pub(crate) Box<dyn Link>);

impl Interruptible {
    /// The end of the next slice.
    ///
    /// # Errors
    /// A signal has arrived.
    fn slice(&mut self, until: Instant) -> Result<Instant, LinkError> {
        if is_interrupted() {
            return Err(io::Error::from(io::ErrorKind::Interrupted).into());
        }
        Ok(until.min(self.0.now() + SLICE))
    }
}

impl Link for Interruptible {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut *self.0)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.0.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let until = self.slice(deadline)?;
            let count = self.0.receive(buffer, until)?;
            if count > 0 || until == deadline {
                return Ok(count);
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.0.discard_input()
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        while self.0.now() < until {
            let end = self.slice(until)?;
            self.0.wait_until(end)?;
        }
        Ok(())
    }
}
