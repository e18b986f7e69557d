//! Turns of host and chip in lockstep.
//!
//! Device time stands still when the chip has ended its turn: it has answered, or it has reported a control step of bench mode,
//! and the line is silent. The host's turn is one frame. Neither the speed of the machine nor the pieces in which bytes arrive
//! decide at which device time a frame reaches the chip.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// Device time after which a chip that has sent nothing has ended its turn. It has finished its answers by then.
const ANSWERED_AFTER: Duration = Duration::from_millis(5);
/// The same after the report of a control step, whose telemetry follows without a pause. It is shorter than a control period.
const REPORTED_AFTER: Duration = Duration::from_micros(100);
/// Ends a frame.
const DELIMITER: u8 = 0;
/// Kind of `BenchSample`, the first byte of a frame behind its code byte.
const BENCH_SAMPLE: u8 = 0x95;
/// Wall-clock time after which bytes without a delimiter are passed on: a host may send a part of a frame.
const PART_LIMIT: Duration = Duration::from_millis(50);

/// The host has disconnected.
pub(crate) struct Disconnected;

/// Whose turn it is.
#[derive(Debug, Default)]
pub(crate) struct Lockstep {
    /// Bytes of the host that the chip has not received.
    waiting: VecDeque<u8>,
    /// Place in the present frame of the chip, and whether that is a report of a control step so far.
    place: usize,
    is_report: bool,
    /// Whether the chip has reported a control step in its present turn.
    has_reported: bool,
}

impl Lockstep {
    /// The chip has sent bytes.
    pub(crate) fn note_sent(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if *byte == DELIMITER {
                self.has_reported |= self.is_report;
                (self.place, self.is_report) = (0, false);
            } else {
                // The kind isn't zero, so stuffing leaves it as it is.
                self.is_report |= self.place == 1 && *byte == BENCH_SAMPLE;
                self.place += 1;
            }
        }
    }

    /// Whether the chip has ended its turn, `pause` after the last byte in either direction.
    pub(crate) fn is_hosts_turn(&self, pause: Duration) -> bool {
        pause > if self.has_reported { REPORTED_AFTER } else { ANSWERED_AFTER }
    }

    /// Waits for the host's frame, which begins the chip's turn.
    pub(crate) fn next_frame(&mut self, from_host: &Receiver<Vec<u8>>) -> Result<Vec<u8>, Disconnected> {
        self.has_reported = false;
        loop {
            if let Some(end) = self.waiting.iter().position(|byte| *byte == DELIMITER) {
                return Ok(self.waiting.drain(..=end).collect());
            }
            let more = if self.waiting.is_empty() {
                from_host.recv().map_err(|_| RecvTimeoutError::Disconnected)
            } else {
                from_host.recv_timeout(PART_LIMIT)
            };
            match more {
                Ok(bytes) => self.waiting.extend(bytes),
                Err(RecvTimeoutError::Timeout) => return Ok(self.waiting.drain(..).collect()),
                Err(RecvTimeoutError::Disconnected) => return Err(Disconnected),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    #[test]
    fn the_host_sends_one_frame_in_a_turn_however_its_bytes_arrive() {
        let (sender, receiver) = mpsc::channel();
        for piece in [&[0, 3, 1][..], &[2, 0, 3], &[4, 5, 0]] {
            sender.send(piece.to_vec()).unwrap();
        }
        let mut lockstep = Lockstep::default();
        let mut next = || lockstep.next_frame(&receiver).ok().unwrap();
        assert_eq!([next(), next(), next()], [vec![0], vec![3, 1, 2, 0], vec![3, 4, 5, 0]]);
    }

    #[test]
    fn a_report_of_a_step_ends_the_turn_sooner_than_an_answer() {
        let mut lockstep = Lockstep::default();
        lockstep.note_sent(&[4, 0x88, BENCH_SAMPLE, 1, 0]);
        assert!(!lockstep.is_hosts_turn(ANSWERED_AFTER), "the second byte of a body isn't a kind");
        lockstep.note_sent(&[4, BENCH_SAMPLE]);
        lockstep.note_sent(&[1, 2, 0]);
        assert!(lockstep.is_hosts_turn(2 * REPORTED_AFTER) && !lockstep.is_hosts_turn(REPORTED_AFTER));
    }

    #[test]
    fn a_part_of_a_frame_is_passed_on_after_a_while() {
        let (sender, receiver) = mpsc::channel();
        sender.send(vec![3, 1]).unwrap();
        let mut lockstep = Lockstep::default();
        assert_eq!(lockstep.next_frame(&receiver).ok(), Some(vec![3, 1]));
        drop(sender);
        assert!(lockstep.next_frame(&receiver).is_err(), "the host has disconnected");
    }
}
