//! The transmission time of a UART, for links without one: a pseudo-terminal, a socket and a call pass bytes at once,
//! at any baud rate.
//!
//! A byte takes ten bits, and the two directions are independent. A piece that the bench sends reaches the drive when its
//! last byte has passed. Bytes of the drive pass one after the other: telemetry delays the torque behind it.
//!
//! The model needs no thread. Bytes move while the bench receives or [idles](Link::idle). A byte of the drive starts when
//! the bench has read it from the link below, some microseconds after the drive has sent it. The model follows the clock of
//! the link below, which is the wall clock unless time is [scripted](TimeBase::Scripted).

mod direction;

use std::thread;
use std::time::Instant;

pub use direction::transmission_time;

use self::direction::Direction;
use super::deadline::remaining;
use super::error::WRITE_LIMIT;
use super::{Link, LinkError, TimeBase};

/// Bytes sent together reach the drive together up to this length; no frame is longer.
const PIECE: usize = 256;

/// A link behind a modelled UART.
pub struct UartModel {
    link: Box<dyn Link>,
    to_drive: Direction,
    from_drive: Direction,
    /// Why the link below failed. Bytes it received before are still on their way.
    broken: Option<LinkError>,
}

impl UartModel {
    /// Puts a UART of `baud` bits per second before `link`.
    #[must_use]
    pub fn new(mut link: Box<dyn Link>, baud: u32) -> Self {
        link.set_time_base(TimeBase::WallClock);
        Self { link, to_drive: Direction::new(baud), from_drive: Direction::new(baud), broken: None }
    }

    /// Sends on what has passed to the drive.
    fn deliver(&mut self, now: Instant) -> Result<(), LinkError> {
        let mut piece = [0; PIECE];
        loop {
            match self.to_drive.take_whole(now, &mut piece) {
                0 => return Ok(()),
                count => self.link.send(&piece[..count])?,
            }
        }
    }

    /// Waits for bytes of the drive until `until`.
    fn listen(&mut self, until: Instant) {
        let mut buffer = [0; PIECE];
        let free = self.from_drive.free().min(PIECE);
        if free > 0 && self.broken.is_none() {
            match self.link.receive(&mut buffer[..free], until) {
                Ok(0) => {}
                Ok(count) => {
                    let now = self.link.now();
                    return self.from_drive.put(&buffer[..count], now);
                }
                Err(error) => return self.broken = Some(error),
            }
        }
        // The queue is full or the link below has failed: only time helps.
        self.pass_time(until);
    }

    fn pass_time(&mut self, until: Instant) {
        // A link that has failed may not wait.
        if self.link.wait_until(until).is_err() {
            thread::sleep(remaining(until).unwrap_or_default());
        }
    }

    /// Moves bytes until `until` or until what has passed is worth reading.
    fn work(&mut self, until: Instant, reads: bool) -> Result<(), LinkError> {
        loop {
            let now = self.link.now();
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
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        self.work(until, false)
    }

    /// A modelled UART takes wall-clock time unless time is scripted.
    fn set_time_base(&mut self, time_base: TimeBase) {
        self.link.set_time_base(match time_base {
            TimeBase::Scripted => time_base,
            TimeBase::Virtual | TimeBase::WallClock => TimeBase::WallClock,
        });
    }

    /// Returns when the queue has taken the bytes, not when they have passed. Waits while the queue is full.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for piece in bytes.chunks(PIECE) {
            while self.to_drive.free() < piece.len() {
                let Some(next) = self.to_drive.first_whole_at() else { break };
                self.work(next, false)?;
            }
            let now = self.link.now();
            self.to_drive.put(piece, now);
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        self.work(deadline, true)?;
        // What the link below has by now starts on its way, even after the deadline.
        let now = self.link.now();
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
    /// The bytes sent last still have to pass, an emergency stop above all.
    fn drop(&mut self) {
        let give_up = self.link.now() + WRITE_LIMIT;
        while let Some(at) = self.to_drive.first_whole_at().filter(|at| *at <= give_up) {
            self.pass_time(at);
            let now = self.link.now();
            if self.deliver(now).is_err() {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests;
