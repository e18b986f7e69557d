//! The baseline of the loop: the bytes of a control cycle there and back over a pseudo-terminal, by plain reads and writes.
//! One process at either end, no frames, no drive, no plant.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use lashloop_bench::verdict::Exit;
use lashloop_link::terminal::{Terminal, open_near_end, set_raw};
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::wire::Payload;
use rustix::event::{PollFd, PollFlags, poll};
use rustix::time::Timespec;

use super::error::{CliError, system};

const OUT: usize = EncoderSample::LAYOUT.frame_len();
const BACK: usize = TorqueAnswer::LAYOUT.frame_len();
/// Timeout of an answer, in tenths of a second.
const TIMEOUT_TENTHS_S: u8 = 20;

/// The far end: opens a pseudo-terminal, prints its path, answers until the line closes.
pub(super) fn answer() -> Result<Exit, CliError> {
    let serve = || -> io::Result<()> {
        let terminal = Terminal::open()?;
        writeln!(io::stdout(), "{}", terminal.path.display())?;
        let mut far_end = File::from(terminal.far_end);
        let mut bytes = [0; OUT];
        loop {
            read_exactly(&far_end, &mut bytes)?;
            far_end.write_all(&[1; BACK])?;
        }
    };
    serve().map_err(system("answer the ping-pong"))?;
    Ok(Exit::Pass)
}

/// The near end.
pub(super) struct NearEnd(File);

impl NearEnd {
    /// Opens the pseudo-terminal of the far end.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let line = open_near_end(path)?;
        set_raw(&line, 0, TIMEOUT_TENTHS_S)?;
        Ok(Self(line.into()))
    }

    /// Sends the bytes of a control cycle there and back, and returns the time they took.
    pub(super) fn round_trip(&mut self) -> io::Result<Duration> {
        let started = Instant::now();
        self.0.write_all(&[1; OUT])?;
        read_exactly(&self.0, &mut [0; BACK])?;
        Ok(started.elapsed())
    }

    /// As [`Self::round_trip`], with the poll that a deadline costs: the timeout of a read is at least a tenth of a second.
    /// Bytes after `limit` are read all the same.
    pub(super) fn round_trip_with_a_deadline(&mut self, limit: Timespec) -> io::Result<Duration> {
        let started = Instant::now();
        self.0.write_all(&[1; OUT])?;
        poll(&mut [PollFd::new(&self.0, PollFlags::IN)], Some(&limit))?;
        read_exactly(&self.0, &mut [0; BACK])?;
        Ok(started.elapsed())
    }
}

fn read_exactly(line: &File, mut bytes: &mut [u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match rustix::io::read(line, &mut *bytes)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            count => bytes = &mut bytes[count..],
        }
    }
    Ok(())
}
