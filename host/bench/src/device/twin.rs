//! The native twin: the drive as a process on a pseudo-terminal.
//!
//! The process runs the same [`Drive`] as the image. Two threads share the drive: one waits for bytes, the other for the
//! next tick of the watchdog, so an idle twin takes no processor time. As in the image, sending never locks the drive: a
//! host that does not read can't keep the watchdog from tripping.

use std::os::fd::{AsFd, OwnedFd};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{io, panic, process, thread};

use lashloop_firmware::Laws;
use lashloop_firmware::drive::{Clock, Drive, fault_frame};
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::FaultCode;

use lashloop_link::spin::{Spin, is_readable};
use lashloop_link::terminal::Terminal;

/// Name of the board in the twin's identity.
pub const BOARD: &str = "native-twin";

/// A pseudo-terminal with a drive at its far end.
pub struct Twin {
    /// The terminal; its path is for a host to open.
    pub terminal: Terminal,
    /// The origin of device time.
    boot: Instant,
}

impl From<Terminal> for Twin {
    /// A drive that is powered up now.
    fn from(terminal: Terminal) -> Self {
        Self { terminal, boot: Instant::now() }
    }
}

impl Twin {
    /// Opens the pseudo-terminal.
    ///
    /// # Errors
    /// As [`Terminal::open`].
    pub fn open() -> io::Result<Self> {
        Ok(Terminal::open()?.into())
    }

    /// Runs a drive with Lashloop's own laws, see [`Self::serve_laws`].
    ///
    /// # Errors
    /// Why the line broke.
    pub fn serve(&self) -> io::Result<()> {
        self.serve_laws::<Laws>()
    }

    /// Makes any panic of this process end it, as a panic ends the image: the torque is zero, and the last frame on the line is the
    /// fault report. For a process that does nothing else than serve.
    ///
    /// # Errors
    /// The line can't be shared.
    pub fn end_at_panics(&self) -> io::Result<()> {
        let (line, report, boot) = (self.terminal.far_end.try_clone()?, panic::take_hook(), self.boot);
        panic::set_hook(Box::new(move |info| {
            let at = info.location().map_or(0, panic::Location::line);
            let _ = rustix::io::write(&line, &fault_frame(FaultCode::Panic, at, boot.elapsed()));
            report(info);
            process::exit(101);
        }));
        Ok(())
    }

    /// Runs a drive with these laws until the line breaks.
    ///
    /// # Errors
    /// Why the line broke.
    pub fn serve_laws<L: LawSet>(&self) -> io::Result<()> {
        let line = &self.terminal.far_end;
        let shared = Shared {
            drive: Mutex::new(Drive::<L>::with_laws(BOARD)),
            changed: Condvar::new(),
            ended: AtomicBool::new(false),
            sending: Mutex::new(Vec::new()),
            clock: BootClock(self.boot),
        };
        thread::scope(|scope| {
            scope.spawn(|| shared.serve_watchdog(line));
            let error = shared.serve_requests(line);
            shared.ended.store(true, Ordering::Relaxed);
            // Under the lock: else the other thread could check just before and wait just after.
            let _drive = shared.drive();
            shared.changed.notify_all();
            Err(error)
        })
    }
}

struct BootClock(Instant);

impl Clock for BootClock {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

struct Shared<L: LawSet> {
    drive: Mutex<Drive<L>>,
    /// Notified when the next tick becomes earlier, and at the end.
    changed: Condvar,
    /// Whether the line broke.
    ended: AtomicBool,
    /// Bytes being sent. The lock keeps frames in order.
    sending: Mutex<Vec<u8>>,
    clock: BootClock,
}

impl<L: LawSet> Shared<L> {
    fn drive(&self) -> MutexGuard<'_, Drive<L>> {
        self.drive.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads and answers until the line breaks.
    fn serve_requests(&self, line: &OwnedFd) -> io::Error {
        let (mut buffer, mut spin) = ([0; 4096], Spin::default());
        loop {
            let _ = spin.first(|| is_readable(line).then_some(()));
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

    /// Ticks the drive whenever a tick is due.
    fn serve_watchdog(&self, line: &OwnedFd) {
        while !self.ended.load(Ordering::Relaxed) {
            let mut drive = self.drive();
            drive.tick(self.clock.now());
            if !drive.output().is_empty() {
                drop(drive);
                // A broken line fails in the other thread too, and that thread reports it.
                if self.send(line).is_err() {
                    return;
                }
                continue;
            }
            match drive.next_tick() {
                None => drop(self.changed.wait(drive)),
                Some(due) => {
                    // Past the deadline, because the watchdog trips after its limit, not at it.
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
