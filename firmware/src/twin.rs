//! The native twin: the drive as a process on a pseudo-terminal.
//!
//! It runs the same [`Drive`] as the image. Two threads share it: one waits for bytes, the other for the moment the
//! watchdog would trip, so that nobody has to poll and an idle twin costs nothing.

use std::io;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{format, println, thread};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::drive::{Clock, Drive};

/// Name of the board in the twin's identity.
pub const BOARD: &str = "native-twin";

/// A pseudo-terminal with a drive at its far end.
pub struct Twin {
    line: OwnedFd,
    path: PathBuf,
    /// Held open so that the line stays up while no host is connected, as a real one does.
    _near_end: OwnedFd,
}

impl Twin {
    /// Opens a pseudo-terminal in raw mode.
    ///
    /// # Errors
    /// If the system has no pseudo-terminal left or none at all.
    pub fn open() -> io::Result<Self> {
        let line = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&line)?;
        unlockpt(&line)?;
        let name = ptsname(&line, [])?;
        let path = PathBuf::from(name.to_string_lossy().into_owned());
        let flags = rustix::fs::OFlags::RDWR | rustix::fs::OFlags::NOCTTY | rustix::fs::OFlags::CLOEXEC;
        let near_end = rustix::fs::open(&path, flags, rustix::fs::Mode::empty())?;
        let mut settings = tcgetattr(&near_end)?;
        settings.make_raw();
        tcsetattr(&near_end, OptionalActions::Now, &settings)?;
        Ok(Self { line, path, _near_end: near_end })
    }

    /// Where a host finds the drive.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Runs the drive until the line breaks.
    ///
    /// # Errors
    /// What broke the line.
    pub fn serve(&self) -> io::Result<()> {
        let shared =
            Shared { drive: Mutex::new(Drive::new(BOARD)), changed: Condvar::new(), clock: BootClock::new() };
        thread::scope(|scope| {
            scope.spawn(|| shared.watch(&self.line));
            let ended = shared.answer(&self.line);
            shared.changed.notify_all();
            ended
        })
    }
}

/// What `main` of the twin does: open, print the path, serve.
///
/// # Errors
/// A sentence that says what the twin could not do.
pub fn main() -> Result<(), std::string::String> {
    let twin = Twin::open().map_err(|error| format!("no pseudo-terminal for the drive: {error}"))?;
    println!("{}", twin.path().display());
    twin.serve().map_err(|error| format!("the line of the drive broke: {error}"))
}

struct BootClock(Instant);

impl BootClock {
    fn new() -> Self {
        Self(Instant::now())
    }
}

impl Clock for BootClock {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

struct Shared {
    drive: Mutex<Drive>,
    /// Told when the drive starts to need ticks.
    changed: Condvar,
    clock: BootClock,
}

impl Shared {
    /// A thread that panicked has left a drive without torque at worst; the other one goes on.
    fn drive(&self) -> MutexGuard<'_, Drive> {
        self.drive.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn answer(&self, line: &OwnedFd) -> io::Result<()> {
        let mut buffer = [0; 4096];
        loop {
            let count = match rustix::io::read(line, &mut buffer) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => count,
                Err(rustix::io::Errno::INTR) => continue,
                Err(error) => return Err(error.into()),
            };
            let mut bytes = &buffer[..count];
            let mut drive = self.drive();
            let needed_ticks = drive.next_tick().is_some();
            while !bytes.is_empty() {
                let used = drive.receive(bytes, &self.clock);
                bytes = &bytes[used..];
                send(&mut drive, line)?;
            }
            if !needed_ticks && drive.next_tick().is_some() {
                self.changed.notify_all();
            }
        }
    }

    fn watch(&self, line: &OwnedFd) {
        let mut drive = self.drive();
        loop {
            drive.tick(self.clock.now());
            // A line that breaks here breaks in the other thread too, which then reports it.
            if send(&mut drive, line).is_err() {
                return;
            }
            drive = match drive.next_tick() {
                None => self.changed.wait(drive).unwrap_or_else(PoisonError::into_inner),
                Some(due) => {
                    // A moment past the deadline, because the watchdog lets the limit itself pass.
                    let wait = due.saturating_sub(self.clock.now()) + Duration::from_micros(100);
                    self.changed.wait_timeout(drive, wait).unwrap_or_else(PoisonError::into_inner).0
                }
            };
        }
    }
}

fn send(drive: &mut Drive, line: &OwnedFd) -> io::Result<()> {
    let mut unsent = drive.output();
    while !unsent.is_empty() {
        match rustix::io::write(line, unsent) {
            Ok(count) => unsent = &unsent[count..],
            Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
    drive.clear_output();
    Ok(())
}
