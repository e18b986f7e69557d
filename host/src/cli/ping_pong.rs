//! What the loop is compared with: the bytes of a control cycle to and fro over a pseudo-terminal, and nothing else.
//! Reads and writes, one process at either end, no frames, no drive, no plant.

use std::io::{self, Write};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::{Duration, Instant};

use lashloop_bench::device::twin::Terminal;
use lashloop_bench::link::pty::set_raw;
use lashloop_bench::verdict::Exit;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::wire::Payload;
use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::{Mode, OFlags};
use rustix::time::Timespec;

use super::error::CliError;

const OUT: usize = EncoderSample::LAYOUT.frame_len();
const BACK: usize = TorqueAnswer::LAYOUT.frame_len();
/// Tenths of a second after which a far end that does not answer is given up.
const PATIENCE_TENTHS: u8 = 20;

/// The far end: opens the pseudo-terminal, prints its path, answers until the line closes.
pub(super) fn answer() -> Result<Exit, CliError> {
    let failed = |source: io::Error| CliError::System { what: "answer the ping-pong", source };
    let serve = || -> io::Result<()> {
        let terminal = Terminal::open()?;
        writeln!(io::stdout(), "{}", terminal.path.display())?;
        let mut bytes = [0; OUT];
        loop {
            read_exactly(&terminal.line, &mut bytes)?;
            write_all(&terminal.line, &[1; BACK])?;
        }
    };
    serve().map_err(failed)?;
    Ok(Exit::Pass)
}

/// The near end.
pub(super) struct NearEnd(OwnedFd);

impl NearEnd {
    /// Opens the pseudo-terminal of the far end.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let line = rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        set_raw(&line, 0, PATIENCE_TENTHS)?;
        Ok(Self(line))
    }

    /// The bytes of a control cycle there and back, and the time they took. Waits for them as long as it takes.
    pub(super) fn round_trip(&mut self) -> io::Result<Duration> {
        let started = Instant::now();
        write_all(&self.0, &[1; OUT])?;
        read_exactly(&self.0, &mut [0; BACK])?;
        Ok(started.elapsed())
    }

    /// The same by somebody who has a next period to keep: he has to be able to give up, and a read alone knows no time
    /// shorter than a tenth of a second. Bytes that come after `limit` are waited for all the same.
    pub(super) fn round_trip_with_a_deadline(&mut self, limit: Timespec) -> io::Result<Duration> {
        let started = Instant::now();
        write_all(&self.0, &[1; OUT])?;
        poll(&mut [PollFd::new(&self.0, PollFlags::IN)], Some(&limit))?;
        read_exactly(&self.0, &mut [0; BACK])?;
        Ok(started.elapsed())
    }
}

fn read_exactly(line: &OwnedFd, mut bytes: &mut [u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match rustix::io::read(line, &mut *bytes)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            count => bytes = &mut bytes[count..],
        }
    }
    Ok(())
}

fn write_all(line: &OwnedFd, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        bytes = &bytes[rustix::io::write(line, bytes)?..];
    }
    Ok(())
}
