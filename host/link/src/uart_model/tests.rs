//! The UART model with a drive below it that answers at once, on a clock that moves only when the model waits.

use std::collections::VecDeque;
use std::sync::mpsc;
use std::time::Duration;

use super::*;

/// A byte takes 100 us.
const BAUD: u32 = 100_000;
const BYTE: Duration = Duration::from_micros(100);

/// Sends `answer` for every piece it receives, and reports when that was.
struct Answering {
    now: Instant,
    answer: &'static [u8],
    pending: VecDeque<u8>,
    reached: mpsc::Sender<(Instant, Vec<u8>)>,
    ends: bool,
}

impl Link for Answering {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.now
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        self.now = self.now.max(until);
        if self.ends { Err(LinkError::Disconnected) } else { Ok(()) }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.pending.extend(self.answer);
        let _ = self.reached.send((self.now, bytes.to_vec()));
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let count = self.pending.len().min(buffer.len());
        for (place, byte) in buffer.iter_mut().zip(self.pending.drain(..count)) {
            *place = byte;
        }
        if count == 0 && self.ends {
            return Err(LinkError::Disconnected);
        }
        if count == 0 {
            self.now = self.now.max(deadline);
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.pending.clear();
        Ok(())
    }
}

type Reached = mpsc::Receiver<(Instant, Vec<u8>)>;

fn wire_to(answer: &'static [u8], pending: &[u8], baud: u32, ends: bool) -> (UartModel, Reached) {
    let (reached, arrivals) = mpsc::channel();
    let pending = pending.iter().copied().collect();
    let below = Answering { now: Instant::now(), answer, pending, reached, ends };
    (UartModel::new(Box::new(below), baud), arrivals)
}

fn wire(answer: &'static [u8]) -> (UartModel, Reached) {
    wire_to(answer, &[], BAUD, false)
}

/// Reads `count` pieces, each with the time of its arrival.
fn frames(wire: &mut UartModel, count: usize) -> Vec<(Instant, Vec<u8>)> {
    let mut buffer = [0; 64];
    (0..count)
        .map(|_| {
            let deadline = wire.now() + Duration::from_secs(10);
            let read = wire.receive(&mut buffer, deadline).expect("a line");
            (wire.now(), buffer[..read].to_vec())
        })
        .collect()
}

#[test]
fn a_frame_reaches_the_drive_when_its_last_byte_has_passed() {
    let (mut wire, reached) = wire(&[1, 0]);
    let sent = wire.now();
    wire.send(&[7; 20]).expect("a line");
    assert!(reached.try_recv().is_err(), "nothing is there at once");
    let answer = frames(&mut wire, 1);
    assert_eq!(reached.try_recv().expect("it has arrived"), (sent + 20 * BYTE, vec![7; 20]));
    assert_eq!(answer, [(sent + 22 * BYTE, vec![1, 0])]);
}

#[test]
fn two_frames_sent_back_to_back_arrive_one_behind_the_other() {
    let (mut wire, reached) = wire(&[]);
    let sent = wire.now();
    wire.send(&[7; 20]).expect("a line");
    wire.send(&[8; 20]).expect("a line");
    wire.idle(sent + 60 * BYTE).expect("a line");
    let arrived: Vec<_> = reached.try_iter().collect();
    assert_eq!(arrived, [(sent + 20 * BYTE, vec![7; 20]), (sent + 40 * BYTE, vec![8; 20])]);
}

#[test]
fn telemetry_delays_the_answer_behind_it() {
    let (mut wire, _reached) = wire(&[9, 9, 0, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 0]);
    let first_at = wire.now() + BYTE;
    // The torque is read; the telemetry that follows it is still on the wire when the next sample is sent.
    wire.send(&[7]).expect("a line");
    assert_eq!(frames(&mut wire, 1), [(first_at + 3 * BYTE, vec![9, 9, 0])]);
    wire.send(&[7]).expect("a line");
    let answers = frames(&mut wire, 2);
    assert_eq!((answers[0].0 - first_at, answers[0].1.len()), (23 * BYTE, 20), "the telemetry");
    assert_eq!(answers[1], (first_at + 26 * BYTE, vec![9, 9, 0]), "and only then the torque");
}

#[test]
fn the_directions_do_not_wait_for_each_other() {
    let (mut wire, reached) = wire(&[3; 50]);
    let first_at = wire.now() + BYTE;
    wire.send(&[7]).expect("a line");
    wire.idle(first_at + 2 * BYTE).expect("a line");
    assert_eq!(reached.try_recv().expect("the first frame").0, first_at);
    // Fifty bytes come back for the next five milliseconds. What goes out needs only its own byte.
    assert_eq!(wire.from_drive.worth_reading_at(), Some(first_at + 50 * BYTE));
    wire.send(&[8]).expect("a line");
    assert_eq!(wire.to_drive.first_whole_at(), Some(first_at + 3 * BYTE));
}

#[test]
fn the_last_bytes_of_a_line_arrive_before_its_end() {
    let (mut wire, _reached) = wire_to(&[4, 0], &[1, 2, 0], BAUD, true);
    assert_eq!(frames(&mut wire, 1)[0].1, [1, 2, 0]);
    let asked = wire.now();
    let end = wire.receive(&mut [0; 8], asked + Duration::from_secs(100));
    assert_eq!(wire.now(), asked, "the end is not waited for");
    assert!(matches!(end, Err(LinkError::Disconnected)), "{end:?}");
}

#[test]
fn silence_ends_at_the_deadline() {
    let (mut wire, _reached) = wire(&[]);
    let deadline = wire.now() + Duration::from_millis(20);
    assert_eq!(wire.receive(&mut [0; 8], deadline).expect("a line"), 0);
    assert_eq!(wire.now(), deadline);
}

#[test]
fn a_dropped_line_still_delivers_what_was_sent() {
    let (mut wire, reached) = wire(&[]);
    let sent = wire.now();
    wire.send(&[7; 10]).expect("a line");
    drop(wire);
    assert_eq!(reached.try_recv().expect("it has arrived"), (sent + 10 * BYTE, vec![7; 10]));
}

#[test]
fn more_than_the_queue_holds_arrives_complete() {
    let (mut wire, arrivals) = wire_to(&[], &[], 12_000_000, false);
    let bytes: Vec<u8> = (0..10_000_u32).map(|at| at as u8).collect();
    wire.send(&bytes).expect("a line");
    drop(wire);
    let arrived: Vec<u8> = arrivals.try_iter().flat_map(|(_, piece)| piece).collect();
    assert_eq!(arrived, bytes);
}
