//! Lines over pipes, with deadlines.

use std::io::{self, PipeReader, PipeWriter, Read, Write};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// Longest line that is read, in bytes.
const LONGEST_LINE: usize = 1 << 20;

/// A process's standard input and output.
pub(super) struct Lines {
    to_process: PipeWriter,
    from_process: PipeReader,
    /// What was read of the next line.
    pending: Vec<u8>,
}

/// Why there is no line.
#[derive(Debug)]
pub(super) enum NoLine {
    /// The other end is closed.
    Closed,
    /// The deadline has passed.
    Late,
    /// The line is longer than [`LONGEST_LINE`].
    TooLong,
}

impl Lines {
    pub(super) fn new(to_process: PipeWriter, from_process: PipeReader) -> Self {
        Self { to_process, from_process, pending: Vec::new() }
    }

    /// Writes a line. The process reads each line before the next one is written, so a pipe has place for it.
    pub(super) fn write(&mut self, mut line: Vec<u8>) -> Result<(), NoLine> {
        line.push(b'\n');
        self.to_process.write_all(&line).map_err(|_| NoLine::Closed)
    }

    /// Reads a line, without its end.
    pub(super) fn read(&mut self, limit: Duration) -> Result<Vec<u8>, NoLine> {
        let deadline = Instant::now() + limit;
        let mut searched = 0;
        loop {
            if let Some(end) = self.pending[searched..].iter().position(|&byte| byte == b'\n') {
                let mut line: Vec<u8> = self.pending.drain(..=searched + end).collect();
                line.pop();
                return Ok(line);
            }
            searched = self.pending.len();
            if searched > LONGEST_LINE {
                return Err(NoLine::TooLong);
            }
            self.wait(deadline)?;
            let mut buffer = [0; 4096];
            match self.from_process.read(&mut buffer) {
                Ok(0) => return Err(NoLine::Closed),
                Ok(count) => self.pending.extend_from_slice(&buffer[..count]),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(_) => return Err(NoLine::Closed),
            }
        }
    }

    /// Waits until something can be read, or the end of the stream.
    fn wait(&self, deadline: Instant) -> Result<(), NoLine> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let timeout = Timespec::try_from(left).ok();
            match poll(&mut [PollFd::new(&self.from_process, PollFlags::IN)], timeout.as_ref()) {
                Ok(0) => return Err(NoLine::Late),
                Ok(_) => return Ok(()),
                Err(rustix::io::Errno::INTR) => {}
                Err(_) => return Err(NoLine::Closed),
            }
        }
    }
}
