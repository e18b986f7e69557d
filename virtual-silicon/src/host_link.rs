//! A program at the far end of the link, paced by the wall clock or in lockstep with the chip.

use std::io::{self, Read, Write};
use std::ops::ControlFlow;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, TryRecvError};
use std::thread;
use std::time::{Duration, Instant};

use crate::lockstep::{Disconnected, Lockstep};
use crate::pacer::Pacer;
use crate::pins::Pins;
use crate::surroundings::End;

/// Between two turns while bytes are on the line: about 5 bytes at 921,600 Bd. What the chip sends is passed on at the
/// turn after a pause of this length, so a frame is mostly passed on whole.
const BUSY_TURN: Duration = Duration::from_micros(50);
/// Between two turns while the line is idle.
const IDLE_TURN: Duration = Duration::from_millis(1);
/// Bytes that are passed on without a pause in the transmission.
const PIECE_BYTES: usize = 256;
/// Device time after which a silent line counts as idle.
const IDLE_AFTER: Duration = Duration::from_micros(500);

/// What device time does while the line is silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// It follows the wall clock, and a silent host trips the drive's watchdog.
    Wall,
    /// It stands still until the host sends, and no host is too slow. The chip takes one frame of the host at each of these
    /// turns, so a run repeats bit for bit.
    Lockstep,
}

/// A program at the far end.
pub struct HostLink {
    to_host: Box<dyn Write + Send>,
    from_host: Receiver<Vec<u8>>,
    pace: Pace,
}

/// The clock with its state.
enum Pace {
    /// From the first turn on.
    Wall(Option<Pacer>),
    Lockstep(Lockstep),
}

impl HostLink {
    /// Starts to read. The end of `from_host` ends the run.
    pub fn new(
        from_host: impl Read + Send + 'static,
        to_host: impl Write + Send + 'static,
        clock: Clock,
    ) -> Self {
        let (sender, receiver) = mpsc::channel();
        thread::spawn(move || pass_on(from_host, &sender));
        let pace = match clock {
            Clock::Wall => Pace::Wall(None),
            Clock::Lockstep => Pace::Lockstep(Lockstep::default()),
        };
        Self { to_host: Box::new(to_host), from_host: receiver, pace }
    }

    /// Exchanges bytes, and returns the device time of the next exchange.
    pub fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        let now = chip.now();
        let line = chip.serial_line();
        let pause = now.saturating_sub(line.last_byte_at());
        if !line.received().is_empty() && (pause >= BUSY_TURN || line.received().len() >= PIECE_BYTES) {
            let bytes = line.take();
            if let Pace::Lockstep(lockstep) = &mut self.pace {
                lockstep.note_sent(&bytes);
            }
            if self.to_host.write_all(&bytes).and_then(|()| self.to_host.flush()).is_err() {
                return ControlFlow::Break(End::Disconnected);
            }
        }
        let is_silent = line.unsent() == 0 && line.received().is_empty();
        let bytes = match &mut self.pace {
            Pace::Wall(pacer) => wait(pacer, &self.from_host, now),
            Pace::Lockstep(lockstep) if is_silent && lockstep.is_hosts_turn(pause) => {
                lockstep.next_frame(&self.from_host)
            }
            Pace::Lockstep(_) => Ok(Vec::new()),
        };
        let Ok(bytes) = bytes else { return ControlFlow::Break(End::Disconnected) };
        let is_idle = bytes.is_empty() && line.unsent() == 0 && pause > IDLE_AFTER;
        line.send(&bytes);
        ControlFlow::Continue(next_turn(now, if is_idle { IDLE_TURN } else { BUSY_TURN }))
    }
}

/// The next multiple of an interval: an instruction more or less of the chip moves no turn.
fn next_turn(now: Duration, interval: Duration) -> Duration {
    let turns = now.as_nanos() / interval.as_nanos() + 1;
    // 2^32 turns of 50 us are 59 hours.
    interval * u32::try_from(turns).unwrap_or(u32::MAX)
}

/// Waits until device time is no longer ahead of the wall clock, or until the host sends.
fn wait(
    pacer: &mut Option<Pacer>,
    from_host: &Receiver<Vec<u8>>,
    now: Duration,
) -> Result<Vec<u8>, Disconnected> {
    let pacer = pacer.get_or_insert_with(|| Pacer::new(Instant::now(), now));
    let due = pacer.due(Instant::now(), now);
    let wait = due.saturating_duration_since(Instant::now());
    let bytes = if wait.is_zero() {
        match from_host.try_recv() {
            Ok(bytes) => bytes,
            Err(TryRecvError::Empty) => Vec::new(),
            Err(TryRecvError::Disconnected) => return Err(Disconnected),
        }
    } else {
        match from_host.recv_timeout(wait) {
            Ok(bytes) => bytes,
            Err(RecvTimeoutError::Timeout) => Vec::new(),
            Err(RecvTimeoutError::Disconnected) => return Err(Disconnected),
        }
    };
    pacer.resume(Instant::now(), now);
    Ok(bytes)
}

fn pass_on(mut from_host: impl Read, receiver: &mpsc::Sender<Vec<u8>>) {
    let mut bytes = [0; 4096];
    loop {
        match from_host.read(&mut bytes) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Ok(0) | Err(_) => return,
            Ok(count) => {
                if receiver.send(bytes[..count].to_vec()).is_err() {
                    return;
                }
            }
        }
    }
}
