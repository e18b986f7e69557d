//! One direction of a UART: bytes on their way, and when each has passed.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use lashloop_protocol::frame::DELIMITER;

/// Start bit, 8 data bits, stop bit.
const BITS_PER_BYTE: u64 = 10;

/// Bytes on their way at most, as many as a terminal of Linux keeps.
const CAPACITY: usize = 4096;

/// Transmission time of `bytes` at `baud` bits per second, rounded down to whole nanoseconds.
#[must_use]
pub const fn transmission_time(bytes: u64, baud: u32) -> Duration {
    Duration::from_nanos(bytes * BITS_PER_BYTE * 1_000_000_000 / baud as u64)
}

/// Bytes that were queued together, so that only the first can have waited for those before them.
#[derive(Debug, Clone, Copy)]
struct Flight {
    began: Instant,
    len: usize,
    /// Bytes taken so far.
    taken: usize,
}

/// Bytes on their way, first in, first out. Allocates only on creation.
#[derive(Debug)]
pub(super) struct Direction {
    baud: u32,
    bytes: VecDeque<u8>,
    flights: VecDeque<Flight>,
}

impl Direction {
    pub(super) fn new(baud: u32) -> Self {
        Self { baud, bytes: VecDeque::with_capacity(CAPACITY), flights: VecDeque::with_capacity(CAPACITY) }
    }

    /// Bytes that [`Self::put`] takes at present.
    pub(super) fn free(&self) -> usize {
        CAPACITY - self.bytes.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Queues bytes, at most [`Self::free`] of them, behind those on their way.
    pub(super) fn put(&mut self, bytes: &[u8], now: Instant) {
        if bytes.is_empty() {
            return;
        }
        let free_at = self.flights.back().map_or(now, |last| self.passed(last, last.len));
        self.bytes.extend(bytes);
        self.flights.push_back(Flight { began: now.max(free_at), len: bytes.len(), taken: 0 });
    }

    /// When the whole of the first flight has passed.
    pub(super) fn first_whole_at(&self) -> Option<Instant> {
        self.flights.front().map(|flight| self.passed(flight, flight.len))
    }

    /// Takes the first flight once the whole of it has passed; nothing before.
    pub(super) fn take_whole(&mut self, now: Instant, buffer: &mut [u8]) -> usize {
        if self.first_whole_at().is_some_and(|at| at <= now) { self.take(now, buffer) } else { 0 }
    }

    /// When a read is worth while: a whole frame has passed, or all bytes have.
    pub(super) fn worth_reading_at(&self) -> Option<Instant> {
        let delimiter = self.bytes.iter().position(|&byte| byte == DELIMITER);
        let mut left = delimiter.map_or(self.bytes.len(), |at| at + 1);
        for flight in &self.flights {
            let here = flight.len - flight.taken;
            if left <= here {
                return Some(self.passed(flight, flight.taken + left));
            }
            left -= here;
        }
        None
    }

    /// Takes bytes of the first flight that have passed.
    pub(super) fn take(&mut self, now: Instant, buffer: &mut [u8]) -> usize {
        let Some(mut flight) = self.flights.front().copied() else { return 0 };
        let mut count = 0;
        while count < buffer.len()
            && flight.taken < flight.len
            && self.passed(&flight, flight.taken + 1) <= now
        {
            let Some(byte) = self.bytes.pop_front() else { break };
            buffer[count] = byte;
            count += 1;
            flight.taken += 1;
        }
        match self.flights.front_mut() {
            Some(front) if flight.taken < flight.len => *front = flight,
            _ => {
                self.flights.pop_front();
            }
        }
        count
    }

    /// Drops all bytes on their way.
    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.flights.clear();
    }

    /// When the first `count` bytes of a flight have passed.
    fn passed(&self, flight: &Flight, count: usize) -> Instant {
        flight.began + transmission_time(count as u64, self.baud)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A byte takes 10 us.
    const BAUD: u32 = 1_000_000;

    fn us(count: u64) -> Duration {
        Duration::from_micros(count)
    }

    fn all_taken(direction: &mut Direction, now: Instant) -> Vec<u8> {
        let mut taken = Vec::new();
        let mut buffer = [0; 7];
        loop {
            match direction.take(now, &mut buffer) {
                0 => return taken,
                count => taken.extend_from_slice(&buffer[..count]),
            }
        }
    }

    #[test]
    fn a_byte_is_ten_bits() {
        assert_eq!(transmission_time(42, 115_200), Duration::from_nanos(3_645_833));
        assert_eq!(transmission_time(1, 12_000_000), Duration::from_nanos(833));
    }

    #[test]
    fn bytes_pass_one_by_one() {
        let (mut direction, start) = (Direction::new(BAUD), Instant::now());
        direction.put(&[1, 2, 3], start);
        assert!(all_taken(&mut direction, start + us(10) - Duration::from_nanos(1)).is_empty());
        assert_eq!(all_taken(&mut direction, start + us(10)), [1]);
        assert_eq!(all_taken(&mut direction, start + us(30)), [2, 3]);
        assert!(direction.is_empty());
    }

    #[test]
    fn two_frames_back_to_back_take_twice_the_time() {
        let (mut direction, start) = (Direction::new(BAUD), Instant::now());
        let frame = [7, 7, 7, 7, 0];
        direction.put(&frame, start);
        assert_eq!(direction.worth_reading_at(), Some(start + us(50)));
        direction.put(&frame, start);
        assert_eq!(all_taken(&mut direction, start + us(50)), frame);
        assert_eq!(direction.worth_reading_at(), Some(start + us(100)));
        assert_eq!(all_taken(&mut direction, start + us(100)), frame);
    }

    #[test]
    fn a_line_is_busy_until_its_last_byte_has_passed() {
        let (mut direction, start) = (Direction::new(BAUD), Instant::now());
        direction.put(&[1, 2, 3, 4], start);
        assert_eq!(all_taken(&mut direction, start + us(20)), [1, 2]);
        direction.put(&[5], start + us(25));
        assert_eq!(all_taken(&mut direction, start + us(49)), [3, 4]);
        assert_eq!(all_taken(&mut direction, start + us(50)), [5]);
    }

    #[test]
    fn an_idle_line_starts_at_once() {
        let (mut direction, start) = (Direction::new(BAUD), Instant::now());
        direction.put(&[1], start);
        assert_eq!(all_taken(&mut direction, start + us(500)), [1]);
        direction.put(&[2], start + us(500));
        assert_eq!(direction.first_whole_at(), Some(start + us(510)));
    }

    #[test]
    fn bytes_queued_together_are_taken_together() {
        let (mut direction, start) = (Direction::new(BAUD), Instant::now());
        let mut buffer = [9; 8];
        direction.put(&[1, 2, 3], start);
        direction.put(&[4], start);
        assert_eq!(direction.take_whole(start + us(29), &mut buffer), 0);
        assert_eq!(direction.take_whole(start + us(40), &mut buffer), 3);
        assert_eq!(buffer[..3], [1, 2, 3]);
        assert_eq!(direction.take_whole(start + us(40), &mut buffer), 1);
    }

    #[test]
    fn half_a_frame_is_worth_reading_when_nothing_follows() {
        let (mut direction, start) = (Direction::new(BAUD), Instant::now());
        assert_eq!(direction.worth_reading_at(), None);
        direction.put(&[1, 2], start);
        direction.put(&[3], start);
        assert_eq!(direction.worth_reading_at(), Some(start + us(30)));
        direction.put(&[0, 4], start);
        assert_eq!(direction.worth_reading_at(), Some(start + us(40)), "the end of the frame");
    }
}
