//! A program at the far end of USART2, paced by the wall clock.

use std::io::{self, Read, Write};
use std::ops::ControlFlow;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, TryRecvError};
use std::thread;
use std::time::{Duration, Instant};

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
/// Device time after which a chip that has sent nothing waits for its host in lockstep. It has finished its answers by then.
const HOSTS_TURN_AFTER: Duration = Duration::from_millis(5);
/// Device time after which a silent line counts as idle.
const IDLE_AFTER: Duration = Duration::from_micros(500);

/// What device time does while the line is silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// It goes on with the wall clock, and a silent host trips the drive's watchdog.
    Wall,
    /// It stands still until the host sends, and no host is too slow.
    Lockstep,
}

/// A program at the far end.
pub struct HostLink {
    to_host: Box<dyn Write + Send>,
    from_host: Receiver<Vec<u8>>,
    /// From the first turn on.
    pacer: Option<Pacer>,
    clock: Clock,
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
        Self { to_host: Box::new(to_host), from_host: receiver, pacer: None, clock }
    }

    /// Exchanges bytes, and returns the device time of the next exchange.
    pub fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        let now = chip.now();
        let line = chip.serial_line();
        let pause = now.saturating_sub(line.last_byte_at());
        if !line.received().is_empty() && (pause >= BUSY_TURN || line.received().len() >= PIECE_BYTES) {
            let bytes = line.take();
            if self.to_host.write_all(&bytes).and_then(|()| self.to_host.flush()).is_err() {
                return ControlFlow::Break(End::Disconnected);
            }
        }
        let is_hosts_turn = line.unsent() == 0 && pause > HOSTS_TURN_AFTER;
        let Ok(bytes) = self.wait(now, is_hosts_turn) else { return ControlFlow::Break(End::Disconnected) };
        let is_idle = bytes.is_empty() && line.unsent() == 0 && pause > IDLE_AFTER;
        line.send(&bytes);
        ControlFlow::Continue(now + if is_idle { IDLE_TURN } else { BUSY_TURN })
    }

    /// Waits until device time is no longer ahead of the wall clock, or until the host sends.
    fn wait(&mut self, now: Duration, is_hosts_turn: bool) -> Result<Vec<u8>, Disconnected> {
        let pacer = self.pacer.get_or_insert_with(|| Pacer::new(Instant::now(), now));
        let due = pacer.due(Instant::now(), now);
        let wait = due.saturating_duration_since(Instant::now());
        let bytes = if self.clock == Clock::Lockstep && is_hosts_turn {
            self.from_host.recv().map_err(|_| Disconnected)?
        } else if wait.is_zero() {
            match self.from_host.try_recv() {
                Ok(bytes) => bytes,
                Err(TryRecvError::Empty) => Vec::new(),
                Err(TryRecvError::Disconnected) => return Err(Disconnected),
            }
        } else {
            match self.from_host.recv_timeout(wait) {
                Ok(bytes) => bytes,
                Err(RecvTimeoutError::Timeout) => Vec::new(),
                Err(RecvTimeoutError::Disconnected) => return Err(Disconnected),
            }
        };
        pacer.resume(Instant::now(), now);
        Ok(bytes)
    }
}

/// The host has disconnected.
struct Disconnected;

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
