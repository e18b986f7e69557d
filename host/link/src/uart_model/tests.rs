//! The UART model with a drive below it that answers at once. All times have lower bounds, which hold on a busy machine.

use std::collections::VecDeque;
use std::sync::mpsc;

use super::*;

/// A byte takes 100 us.
const BAUD: u32 = 100_000;
const BYTE: Duration = Duration::from_micros(100);

/// Sends `answer` for every piece it receives, and reports when that was.
struct Answering {
    answer: &'static [u8],
    pending: VecDeque<u8>,
    reached: mpsc::Sender<(Instant, Vec<u8>)>,
    ends: bool,
}

impl Link for Answering {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.pending.extend(self.answer);
        let _ = self.reached.send((Instant::now(), bytes.to_vec()));
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
            thread::sleep(remaining(deadline).unwrap_or_default());
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.pending.clear();
        Ok(())
    }
}

type Reached = mpsc::Receiver<(Instant, Vec<u8>)>;

fn wire(answer: &'static [u8]) -> (UartModel, Reached) {
    let (reached, arrivals) = mpsc::channel();
    (
        UartModel::new(Box::new(Answering { answer, pending: VecDeque::new(), reached, ends: false }), BAUD),
        arrivals,
    )
}

/// Reads `count` pieces, each with the time of its arrival.
fn frames(wire: &mut UartModel, count: usize) -> Vec<(Instant, Vec<u8>)> {
    let mut buffer = [0; 64];
    (0..count)
        .map(|_| {
            let read = wire.receive(&mut buffer, Instant::now() + Duration::from_secs(10)).expect("a line");
            (Instant::now(), buffer[..read].to_vec())
        })
        .collect()
}

#[test]
fn a_frame_reaches_the_drive_when_its_last_byte_has_passed() {
    let (mut wire, reached) = wire(&[1, 0]);
    let sent = Instant::now();
    wire.send(&[7; 20]).expect("a line");
    assert!(reached.try_recv().is_err(), "nothing is there at once");
    let answer = frames(&mut wire, 1);
    let (at, bytes) = reached.try_recv().expect("it has arrived");
    assert_eq!(bytes, [7; 20]);
    assert!(at - sent >= 20 * BYTE, "{:?}", at - sent);
    assert_eq!(answer[0].1, [1, 0]);
    assert!(answer[0].0 - at >= 2 * BYTE, "{:?}", answer[0].0 - at);
}

#[test]
fn two_frames_sent_back_to_back_arrive_one_behind_the_other() {
    let (mut wire, reached) = wire(&[]);
    let sent = Instant::now();
    wire.send(&[7; 20]).expect("a line");
    wire.send(&[8; 20]).expect("a line");
    wire.idle(sent + 60 * BYTE).expect("a line");
    let arrived: Vec<_> = reached.try_iter().collect();
    assert_eq!(arrived.len(), 2);
    assert!(arrived[0].0 - sent >= 20 * BYTE && arrived[1].0 - sent >= 40 * BYTE, "{arrived:?}");
    assert_eq!(arrived[1].1, [8; 20]);
}

#[test]
fn telemetry_delays_the_answer_behind_it() {
    let (mut wire, reached) = wire(&[9, 9, 0, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 0]);
    // The torque is read; the telemetry that follows it is still on the wire when the next sample is sent.
    wire.send(&[7]).expect("a line");
    assert_eq!(frames(&mut wire, 1)[0].1, [9, 9, 0]);
    let (first_at, _) = reached.try_recv().expect("the first sample");
    wire.send(&[7]).expect("a line");
    let answers = frames(&mut wire, 2);
    assert_eq!(answers[0].1.len(), 20, "the telemetry");
    assert_eq!(answers[1].1, [9, 9, 0], "and only then the torque");
    assert!(answers[1].0 - first_at >= 26 * BYTE, "three, twenty and three bytes after the first sample");
}

#[test]
fn the_directions_do_not_wait_for_each_other() {
    let (mut wire, reached) = wire(&[3; 50]);
    wire.send(&[7]).expect("a line");
    wire.idle(Instant::now() + 3 * BYTE).expect("a line");
    let (first_at, _) = reached.try_recv().expect("the first frame");
    // Fifty bytes come back for the next five milliseconds. What goes out needs only its own byte.
    let queued = wire.from_drive.worth_reading_at().expect("bytes on their way");
    let sent = Instant::now();
    wire.send(&[8]).expect("a line");
    let due = wire.to_drive.first_whole_at().expect("a byte on its way");
    assert!(due - sent < 2 * BYTE + (Instant::now() - sent), "{:?}", due - sent);
    assert!(queued - first_at >= 50 * BYTE);
}

#[test]
fn the_last_bytes_of_a_line_arrive_before_its_end() {
    let (reached, _arrivals) = mpsc::channel();
    let below = Answering { answer: &[4, 0], pending: VecDeque::from([1, 2, 0]), reached, ends: true };
    let mut wire = UartModel::new(Box::new(below), BAUD);
    assert_eq!(frames(&mut wire, 1)[0].1, [1, 2, 0]);
    let asked = Instant::now();
    let end = wire.receive(&mut [0; 8], asked + Duration::from_secs(100));
    assert!(asked.elapsed() < Duration::from_secs(50), "the end is not waited for");
    assert!(matches!(end, Err(LinkError::Disconnected)), "{end:?}");
}

#[test]
fn silence_ends_at_the_deadline() {
    let (mut wire, _reached) = wire(&[]);
    let deadline = Instant::now() + Duration::from_millis(20);
    assert_eq!(wire.receive(&mut [0; 8], deadline).expect("a line"), 0);
    assert!(Instant::now() >= deadline);
}

#[test]
fn a_dropped_line_still_delivers_what_was_sent() {
    let (mut wire, reached) = wire(&[]);
    let sent = Instant::now();
    wire.send(&[7; 10]).expect("a line");
    drop(wire);
    let (at, bytes) = reached.try_recv().expect("it has arrived");
    assert!(at - sent >= 10 * BYTE && bytes == [7; 10]);
}

#[test]
fn more_than_the_queue_holds_arrives_complete() {
    let (reached, arrivals) = mpsc::channel();
    let below = Answering { answer: &[], pending: VecDeque::new(), reached, ends: false };
    let mut wire = UartModel::new(Box::new(below), 12_000_000);
    let bytes: Vec<u8> = (0..10_000_u32).map(|at| at as u8).collect();
    wire.send(&bytes).expect("a line");
    drop(wire);
    let arrived: Vec<u8> = arrivals.try_iter().flat_map(|(_, piece)| piece).collect();
    assert_eq!(arrived, bytes);
}
