//! Lines over pipes, with deadlines.

use std::io::{self, PipeReader, PipeWriter, Read, Write};
use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::supervisor::is_interrupted;

/// Longest line that is read, in bytes.
const LONGEST_LINE: usize = 1 << 20;

/// Time between two looks at whether the user has interrupted the program.
const SLICE: Duration = Duration::from_millis(100);

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
    /// The process wrote no line by the deadline.
    Late,
    /// The process did not read its line by the deadline.
    NotRead,
    /// The line is longer than [`LONGEST_LINE`].
    TooLong,
    /// The user has interrupted the program, which has to wait.
    Interrupted,
}

impl Lines {
    pub(super) fn new(to_process: PipeWriter, from_process: PipeReader) -> io::Result<Self> {
        // A blocking pipe would hold the bench for as long as the process reads nothing.
        rustix::io::ioctl_fionbio(&to_process, true)?;
        Ok(Self { to_process, from_process, pending: Vec::new() })
    }

    /// Writes a line.
    pub(super) fn write(&mut self, mut line: Vec<u8>, deadline: Instant) -> Result<(), NoLine> {
        line.push(b'\n');
        let mut left = &line[..];
        while !left.is_empty() {
            match self.to_process.write(left) {
                Ok(count) => left = &left[count..],
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    if !is_ready(&self.to_process, PollFlags::OUT, deadline)? {
                        return Err(NoLine::NotRead);
                    }
                }
                Err(_) => return Err(NoLine::Closed),
            }
        }
        Ok(())
    }

    /// A line that has arrived already, without its end. Nothing waits.
    pub(super) fn arrived(&mut self) -> Option<Vec<u8>> {
        let has_input = is_ready(&self.from_process, PollFlags::IN, Instant::now());
        if has_input.is_ok_and(|has_input| has_input) {
            // The exchange that follows reports a process that has ended.
            self.receive().ok()?;
        }
        let end = self.pending.iter().position(|&byte| byte == b'\n')?;
        Some(self.take(end))
    }

    /// Reads a line, without its end.
    pub(super) fn read(&mut self, deadline: Instant) -> Result<Vec<u8>, NoLine> {
        let mut searched = 0;
        loop {
            if let Some(end) = self.pending[searched..].iter().position(|&byte| byte == b'\n') {
                return Ok(self.take(searched + end));
            }
            searched = self.pending.len();
            if searched > LONGEST_LINE {
                return Err(NoLine::TooLong);
            }
            if !is_ready(&self.from_process, PollFlags::IN, deadline)? {
                return Err(NoLine::Late);
            }
            self.receive()?;
        }
    }

    /// The line whose end is at `end`.
    fn take(&mut self, end: usize) -> Vec<u8> {
        let mut line: Vec<u8> = self.pending.drain(..=end).collect();
        line.pop();
        line
    }

    /// Reads once.
    fn receive(&mut self) -> Result<(), NoLine> {
        let mut buffer = [0; 4096];
        match self.from_process.read(&mut buffer) {
            Ok(0) => Err(NoLine::Closed),
            Ok(count) => {
                self.pending.extend_from_slice(&buffer[..count]);
                Ok(())
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(()),
            Err(_) => Err(NoLine::Closed),
        }
    }
}

/// Whether `pipe` is ready by the deadline. A closed pipe is ready.
fn is_ready(pipe: impl AsFd, flags: PollFlags, deadline: Instant) -> Result<bool, NoLine> {
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        let timeout = Timespec::try_from(left.min(SLICE)).ok();
        match poll(&mut [PollFd::new(&pipe, flags)], timeout.as_ref()) {
            // A process that answers is not interrupted: the run ends at its step.
            Ok(0) if left > SLICE && is_interrupted() => return Err(NoLine::Interrupted),
            Ok(0) if left > SLICE => {}
            Ok(count) => return Ok(count > 0),
            Err(rustix::io::Errno::INTR) => {}
            Err(_) => return Err(NoLine::Closed),
        }
    }
}
