//! The drive in this process: its frames pass the same encoder, decoder and state machine as anywhere, but no line.
//!
//! Device time is the link's time. By default it is virtual: it stands still while bench and drive compute and advances at
//! once while the bench waits, from one tick of the drive to the next. So a run repeats bit for bit, a lost frame costs no
//! wall-clock time, and the watchdog trips exactly at its limit. A real-time run follows the wall clock instead.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use lashloop_firmware::Laws;
use lashloop_firmware::drive::{Clock, Drive};
use lashloop_firmware::law::LawSet;

use super::{Link, LinkError, TimeBase};

/// Name of the board in the identity of a drive in process.
pub const BOARD: &str = "in-process";

/// Bytes that wait for a suspended drive at most, as many as a terminal of Linux keeps.
const CAPACITY: usize = 4096;

/// The watchdog trips after its limit, not at it.
const PAST_LIMIT: Duration = Duration::from_nanos(1);

/// Device time of the drive's next tick. One that is due and changed nothing is not waited for again.
pub fn next_tick<L: LawSet>(drive: &Drive<L>, now: Duration) -> Option<Duration> {
    drive.next_tick().map(|due| due + PAST_LIMIT).filter(|due| *due > now)
}

/// Bytes that a drive in this process has sent and nothing has read yet.
#[derive(Debug, Default)]
pub struct Unread(Vec<u8>);

impl Unread {
    /// Takes over what the drive has sent.
    pub fn take<L: LawSet>(&mut self, drive: &mut Drive<L>) {
        self.0.extend_from_slice(drive.output());
        drive.clear_output();
    }

    /// Whether there is nothing to read.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Moves the first bytes to the buffer and returns their number.
    pub fn read(&mut self, buffer: &mut [u8]) -> usize {
        let count = self.0.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.0[..count]);
        self.0.drain(..count);
        count
    }

    /// Discards every byte.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// Suspends and resumes a drive in process from outside its link, as `SIGSTOP` and `SIGCONT` do with a process.
#[derive(Debug, Clone, Default)]
pub struct Suspension(Arc<AtomicBool>);

impl Suspension {
    /// Suspends or resumes the drive. A suspended drive takes no byte and no tick, and its time continues. A resumed one sees
    /// by its watchdog the time that has passed before it takes the bytes that wait.
    pub fn set(&self, is_suspended: bool) {
        self.0.store(is_suspended, Ordering::Relaxed);
    }

    fn is_active(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Device time.
enum DeviceClock {
    Virtual { now: Duration },
    WallClock { at_start: Duration, start: Instant },
}

impl Clock for DeviceClock {
    fn now(&self) -> Duration {
        match self {
            Self::Virtual { now } => *now,
            Self::WallClock { at_start, start } => *at_start + start.elapsed(),
        }
    }
}

/// A link to a drive with these laws in this process.
pub struct InProcess<L: LawSet = Laws> {
    drive: Drive<L>,
    /// The instant at device time zero.
    boot: Instant,
    clock: DeviceClock,
    /// The switch that suspends this drive.
    pub suspension: Suspension,
    /// Sent to the drive while it was suspended.
    to_drive: Vec<u8>,
    from_drive: Unread,
}

impl<L: LawSet> Default for InProcess<L> {
    fn default() -> Self {
        Self {
            drive: Drive::with_laws(BOARD),
            boot: Instant::now(),
            clock: DeviceClock::Virtual { now: Duration::ZERO },
            suspension: Suspension::default(),
            to_drive: Vec::with_capacity(CAPACITY),
            from_drive: Unread(Vec::with_capacity(CAPACITY)),
        }
    }
}

impl<L: LawSet> InProcess<L> {
    /// Brings the drive to the present time, unless it is suspended: the watchdog first, then the bytes that wait.
    fn catch_up(&mut self) {
        if self.suspension.is_active() {
            return;
        }
        let now = self.clock.now();
        self.drive.tick(now);
        self.from_drive.take(&mut self.drive);
        if !self.to_drive.is_empty() {
            let waiting = std::mem::take(&mut self.to_drive);
            self.feed(&waiting);
            self.to_drive = waiting;
            self.to_drive.clear();
        }
    }

    fn feed(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let used = self.drive.receive(bytes, &self.clock);
            bytes = &bytes[used..];
            self.from_drive.take(&mut self.drive);
        }
    }

    /// Lets time pass until the drive's next tick, `until` at most.
    fn advance(&mut self, until: Instant) {
        let now = self.clock.now();
        let until = until.saturating_duration_since(self.boot);
        let next = match next_tick(&self.drive, now) {
            Some(tick) if !self.suspension.is_active() => tick.min(until),
            _ => until,
        };
        match &mut self.clock {
            DeviceClock::Virtual { now } => *now = next.max(*now),
            DeviceClock::WallClock { .. } => thread::sleep(next.saturating_sub(now)),
        }
        self.catch_up();
    }
}

impl<L: LawSet> Link for InProcess<L> {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.boot + self.clock.now()
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        self.catch_up();
        while self.now() < until {
            self.advance(until);
        }
        Ok(())
    }

    fn set_time_base(&mut self, time_base: TimeBase) {
        let now = self.clock.now();
        self.clock = match time_base {
            TimeBase::Virtual | TimeBase::Scripted => DeviceClock::Virtual { now },
            TimeBase::WallClock => {
                // From here on the link's time is the wall clock's, and device time continues from where it is.
                let start = Instant::now();
                self.boot = start.checked_sub(now).unwrap_or(start);
                DeviceClock::WallClock { at_start: now, start }
            }
        };
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.catch_up();
        if !self.suspension.is_active() {
            self.feed(bytes);
            return Ok(());
        }
        if self.to_drive.len() + bytes.len() > CAPACITY {
            let give_up = self.now() + crate::error::WRITE_LIMIT;
            self.wait_until(give_up)?;
            return Err(LinkError::Stuck);
        }
        self.to_drive.extend_from_slice(bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        self.catch_up();
        while self.from_drive.is_empty() && self.now() < deadline {
            self.advance(deadline);
        }
        Ok(self.from_drive.read(buffer))
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.from_drive.clear();
        Ok(())
    }
}
