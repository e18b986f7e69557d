//! What the loop is compared with: the bytes of a control cycle to and fro over a pseudo-terminal, and nothing else.
//! Blocking reads and writes, one process at either end, no frames, no drive, no plant.

use std::io::{self, Write};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::{Duration, Instant};

use lashloop::verdict::Exit;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::wire::Payload;
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::error::CliError;

const OUT: usize = EncoderSample::LAYOUT.frame_len();
const BACK: usize = TorqueAnswer::LAYOUT.frame_len();

/// The far end: opens the pseudo-terminal, prints its path, answers until the line closes.
pub(super) fn answer() -> Result<Exit, CliError> {
    let failed = |source: io::Error| CliError::System { what: "answer the ping-pong", source };
    let serve = || -> io::Result<()> {
        let line = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        grantpt(&line)?;
        unlockpt(&line)?;
        let path = ptsname(&line, [])?;
        let near_end = open_raw(Path::new(&*path.to_string_lossy()))?;
        say!("{}", path.to_string_lossy());
        io::stdout().flush()?;
        let mut bytes = [0; OUT];
        loop {
            read_exactly(&line, &mut bytes)?;
            write_all(&line, &[1; BACK])?;
            // Open until here, or the line would hang up before the other side has opened it.
            let _ = &near_end;
        }
    };
    serve().map_err(failed)?;
    Ok(Exit::Pass)
}

/// The near end: `rounds` round trips, and the time they took.
pub(super) fn play(path: &Path, rounds: u32) -> io::Result<Duration> {
    let line = open_raw(path)?;
    let mut bytes = [0; BACK];
    let started = Instant::now();
    for _ in 0..rounds {
        write_all(&line, &[1; OUT])?;
        read_exactly(&line, &mut bytes)?;
    }
    Ok(started.elapsed())
}

fn open_raw(path: &Path) -> io::Result<OwnedFd> {
    let end = rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
    let mut settings = tcgetattr(&end)?;
    settings.make_raw();
    tcsetattr(&end, OptionalActions::Now, &settings)?;
    Ok(end)
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
