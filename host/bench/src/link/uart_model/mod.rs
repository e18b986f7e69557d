//! The time a wire would take, for lines that have none: a pseudo-terminal, a socket or a call passes bytes at once
//! whatever baud rate it is told.
//!
//! A byte takes ten bits, and each direction has its own wire. What the bench sends reaches the drive when the last byte
//! has passed. What the drive sends passes byte by byte, each behind the one before: telemetry that is on the wire delays the
//! torque that follows it.
//!
//! Nothing runs beside the loop for this. Bytes move while the bench receives or [idles](Link::idle), and a byte of the
//! drive begins its way when the bench has it from the line below, some microseconds after the drive has sent it.

mod direction;

use std::thread;
use std::time::{Duration, Instant};

pub use direction::time_of;

use self::direction::Direction;
use super::{Link, LinkError, WRITE_LIMIT, remaining};

/// What is sent in one piece reaches the drive in one piece up to this length; no frame is longer.
const PIECE: usize = 256;

/// A link behind a modelled wire.
pub struct UartModel {
    link: Box<dyn Link>,
    to_drive: Direction,
    from_drive: Direction,
    /// Why the line below gives nothing more. What it gave before is still on its way.
    broken: Option<LinkError>,
}

impl UartModel {
    /// Puts a wire of `baud` bits a second before `link`.
    #[must_use]
    pub fn new(link: Box<dyn Link>, baud: u32) -> Self {
        Self { link, to_drive: Direction::new(baud), from_drive: Direction::new(baud), broken: None }
    }

    /// Gives the drive what has passed.
    fn deliver(&mut self, now: Instant) -> Result<(), LinkError> {
        let mut piece = [0; PIECE];
        loop {
            match self.to_drive.take_whole(now, &mut piece) {
                0 => return Ok(()),
                count => self.link.send(&piece[..count])?,
            }
        }
    }

    /// Waits for what the drive sends, until a moment at most.
    fn listen(&mut self, until: Instant) {
        let mut buffer = [0; PIECE];
        let room = self.from_drive.room().min(PIECE);
        if room > 0 && self.broken.is_none() {
            match self.link.receive(&mut buffer[..room], until) {
                Ok(0) => {}
                Ok(count) => return self.from_drive.put(&buffer[..count], Instant::now()),
                Err(error) => return self.broken = Some(error),
            }
        }
        // A drive in this process has said all it has to say and never waits.
        if let Some(left) = remaining(until) {
            thread::sleep(left);
        }
    }

    /// Lets the wire work until a moment or until what has passed is worth reading.
    fn work(&mut self, until: Instant, reads: bool) -> Result<(), LinkError> {
        loop {
            let now = Instant::now();
            self.deliver(now)?;
            let readable = self.from_drive.worth_reading_at().filter(|_| reads);
            let over = reads && self.broken.is_some() && self.from_drive.is_empty();
            if over || now >= until || readable.is_some_and(|at| at <= now) {
                return Ok(());
            }
            let next = [self.to_drive.first_whole_at(), readable].into_iter().flatten().min();
            self.listen(next.map_or(until, |next| next.min(until)));
        }
    }
}

impl Link for UartModel {
    /// Returns when the wire has taken the bytes, not when they have passed. A wire that is full to the brim is waited for.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for piece in bytes.chunks(PIECE) {
            while self.to_drive.room() < piece.len() {
                let Some(next) = self.to_drive.first_whole_at() else { break };
                self.work(next, false)?;
            }
            self.to_drive.put(piece, Instant::now());
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        self.work(deadline, true)?;
        // What the line below has by now begins its way, even for a bench that asks after its deadline.
        let now = Instant::now();
        if now >= deadline {
            self.listen(now);
        }
        match self.from_drive.take(now, buffer) {
            0 if self.from_drive.is_empty() => self.broken.take().map_or(Ok(0), Err),
            count => Ok(count),
        }
    }

    fn idle(&mut self, until: Instant) -> Result<(), LinkError> {
        self.work(until, false)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.from_drive.clear();
        self.broken = None;
        self.link.discard_input()
    }
}

impl Drop for UartModel {
    /// What was sent last, an emergency stop above all, still has to pass.
    fn drop(&mut self) {
        let give_up = Instant::now() + WRITE_LIMIT;
        while let Some(at) = self.to_drive.first_whole_at().filter(|at| *at <= give_up) {
            thread::sleep(remaining(at).unwrap_or(Duration::ZERO));
            if self.deliver(Instant::now()).is_err() {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests;
