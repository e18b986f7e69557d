//! The native twin: the drive as a process on a pseudo-terminal.
//!
//! It runs the same [`Drive`] as the image. Two threads share it: one waits for bytes, the other for the moment the
//! watchdog would trip, so that nobody has to poll and an idle twin costs nothing. As in the image, sending never holds
//! the drive: a host that does not read can't keep the watchdog from tripping.

use std::io::{self, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::panic;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{process, thread};

use lashloop_protocol::enums::FaultCode;
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use lashloop_firmware::drive::{Clock, Drive, fault_frame};

/// Name of the board in the twin's identity.
pub const BOARD: &str = "native-twin";

/// A pseudo-terminal in raw mode that stays up while nobody is connected, as a real line does.
pub struct Terminal {
    /// The end that a drive reads and writes.
    pub line: OwnedFd,
    /// Where a host finds the other end.
    pub path: PathBuf,
    _near_end: OwnedFd,
}

impl Terminal {
    /// Opens one.
    ///
    /// # Errors
    /// If the system has no pseudo-terminal left or none at all.
    pub fn open() -> io::Result<Self> {
        let line = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&line)?;
        unlockpt(&line)?;
        let name = ptsname(&line, [])?;
        let path = PathBuf::from(name.to_string_lossy().into_owned());
        let near_end =
            rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        let mut settings = tcgetattr(&near_end)?;
        settings.make_raw();
        tcsetattr(&near_end, OptionalActions::Now, &settings)?;
        Ok(Self { line, path, _near_end: near_end })
    }
}

/// A pseudo-terminal with a drive at its far end.
pub struct Twin {
    terminal: Terminal,
}

impl Twin {
    /// Opens the pseudo-terminal.
    ///
    /// # Errors
    /// As [`Terminal::open`].
    pub fn open() -> io::Result<Self> {
        Ok(Self { terminal: Terminal::open()? })
    }

    /// Where a host finds the drive.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.terminal.path
    }

    /// Runs the drive until the line breaks. A panic ends the process, as it ends the image: torque is gone, and the last
    /// frame on the line says why.
    ///
    /// # Errors
    /// What broke the line.
    pub fn serve(&self) -> io::Result<()> {
        let line = &self.terminal.line;
        die_loudly(line.try_clone()?);
        let shared = Shared {
            drive: Mutex::new(Drive::new(BOARD)),
            changed: Condvar::new(),
            ended: AtomicBool::new(false),
            sending: Mutex::new(Vec::new()),
            clock: BootClock(Instant::now()),
        };
        thread::scope(|scope| {
            scope.spawn(|| shared.watch(line));
            let error = shared.answer(line);
            shared.ended.store(true, Ordering::Relaxed);
            // Under the lock, or the other thread could look just before and wait just after.
            let _drive = shared.drive();
            shared.changed.notify_all();
            Err(error)
        })
    }
}

/// What `main` of the twin does: open, print the path, serve.
///
/// # Errors
/// A sentence that says what the twin could not do.
pub fn main() -> Result<(), String> {
    let twin = Twin::open().map_err(|error| format!("no pseudo-terminal for the drive: {error}"))?;
    writeln!(io::stdout(), "{}", twin.path().display())
        .map_err(|error| format!("can't print the path: {error}"))?;
    twin.serve().map_err(|error| format!("the line of the drive broke: {error}"))
}

fn die_loudly(line: OwnedFd) {
    let report = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        let at = info.location().map_or(0, panic::Location::line);
        let _ = rustix::io::write(&line, &fault_frame(FaultCode::Panic, at));
        report(info);
        process::exit(101);
    }));
}

struct BootClock(Instant);

impl Clock for BootClock {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

struct Shared {
    drive: Mutex<Drive>,
    /// Told when the drive needs a tick earlier than it did before.
    changed: Condvar,
    /// The line is gone.
    ended: AtomicBool,
    /// Held by whoever sends, so that frames stay in order; what is in it is on its way.
    sending: Mutex<Vec<u8>>,
    clock: BootClock,
}

impl Shared {
    fn drive(&self) -> MutexGuard<'_, Drive> {
        self.drive.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads and answers until the line breaks.
    fn answer(&self, line: &OwnedFd) -> io::Error {
        let mut buffer = [0; 4096];
        loop {
            let mut bytes = match rustix::io::read(line, &mut buffer) {
                Ok(0) => return io::ErrorKind::UnexpectedEof.into(),
                Ok(count) => &buffer[..count],
                Err(rustix::io::Errno::INTR) => continue,
                Err(error) => return error.into(),
            };
            while !bytes.is_empty() {
                let mut drive = self.drive();
                let before = drive.next_tick();
                let used = drive.receive(bytes, &self.clock);
                bytes = &bytes[used..];
                if drive.next_tick().is_some_and(|due| before.is_none_or(|before| due < before)) {
                    self.changed.notify_all();
                }
                drop(drive);
                if let Err(error) = self.send(line) {
                    return error;
                }
            }
        }
    }

    /// Ticks when it is time to.
    fn watch(&self, line: &OwnedFd) {
        while !self.ended.load(Ordering::Relaxed) {
            let mut drive = self.drive();
            drive.tick(self.clock.now());
            if !drive.output().is_empty() {
                drop(drive);
                // A line that breaks here breaks in the other thread too, which then reports it.
                if self.send(line).is_err() {
                    return;
                }
                continue;
            }
            match drive.next_tick() {
                None => drop(self.changed.wait(drive)),
                Some(due) => {
                    // A moment past the deadline, because the watchdog lets the limit itself pass.
                    let wait = due.saturating_sub(self.clock.now()) + Duration::from_micros(100);
                    drop(self.changed.wait_timeout(drive, wait));
                }
            }
        }
    }

    fn send(&self, line: impl AsFd) -> io::Result<()> {
        let mut sending = self.sending.lock().unwrap_or_else(PoisonError::into_inner);
        let mut drive = self.drive();
        sending.extend_from_slice(drive.output());
        drive.clear_output();
        drop(drive);
        let mut unsent = &sending[..];
        while !unsent.is_empty() {
            match rustix::io::write(&line, unsent) {
                Ok(count) => unsent = &unsent[count..],
                Err(rustix::io::Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
        sending.clear();
        Ok(())
    }
}
