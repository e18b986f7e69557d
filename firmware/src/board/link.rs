//! The link: the serial port of the board, 8N1.
//!
//! The interrupt queues received bytes. Two ways lead out, and [`open`] chooses one:
//!
//! | machine | transmission |
//! |---|---|
//! | silicon | the interrupt writes a queued byte whenever the data register is empty: no task waits for the line |
//! | QEMU | the task that serves the drive polls the data register: QEMU never raises the transmitter's interrupts. Bytes and ticks interrupt the polling |

use super::Fitted;
use super::chip::Chip;
use super::parts::{LineError, Receiver as _, Transmitter as _};
use crate::usb::{ByteLine, CHUNK_BYTES, Chunk};
use cortex_m::peripheral::NVIC;
use heapless::{Vec, spsc};

/// Capacity of the receive queue: 11 ms of line time, far more than the handling of one frame takes.
const RECEIVE_BYTES: usize = 1024;

/// Capacity of the transmit queue: almost four of the longest frames. The drive keeps what doesn't fit.
const TRANSMIT_BYTES: usize = 256;

/// How bytes leave.
#[derive(Clone, Copy)]
pub(super) enum Transmission {
    /// By the interrupt.
    Interrupt,
    /// By polling.
    Polling,
}

/// The queues between the interrupt and the task that serves the drive.
pub struct Queues {
    received: spsc::Queue<u8, RECEIVE_BYTES>,
    to_transmit: spsc::Queue<u8, TRANSMIT_BYTES>,
}

/// Owned by the interrupt.
pub struct UsartInterrupt {
    rx: <Fitted as Chip>::Receiver,
    received: spsc::Producer<'static, u8>,
    /// `None` where the task polls.
    transmitter: Option<Transmitter>,
}

struct Transmitter {
    tx: <Fitted as Chip>::Transmitter,
    queue: spsc::Consumer<'static, u8>,
    /// Whether an empty data register raises the interrupt.
    is_listening: bool,
}

/// Owned by the task that serves the drive.
pub struct Usart {
    received: spsc::Consumer<'static, u8>,
    output: Output,
}

enum Output {
    Interrupt { queue: spsc::Producer<'static, u8>, is_loaded: bool },
    Polling { tx: <Fitted as Chip>::Transmitter, piece: Vec<u8, CHUNK_BYTES> },
}

/// Opens the link.
pub(super) fn open(
    (rx, tx): (<Fitted as Chip>::Receiver, <Fitted as Chip>::Transmitter),
    queues: &'static mut Queues,
    transmission: Transmission,
) -> (UsartInterrupt, Usart) {
    let (received, inbox) = queues.received.split();
    let (transmitter, output) = match transmission {
        Transmission::Interrupt => {
            let (outbox, queue) = queues.to_transmit.split();
            let transmitter = Transmitter { tx, queue, is_listening: false };
            (Some(transmitter), Output::Interrupt { queue: outbox, is_loaded: false })
        }
        Transmission::Polling => (None, Output::Polling { tx, piece: Vec::new() }),
    };
    (UsartInterrupt { rx, received, transmitter }, Usart { received: inbox, output })
}

impl Queues {
    /// Empty queues.
    #[must_use]
    pub const fn new() -> Self {
        Self { received: spsc::Queue::new(), to_transmit: spsc::Queue::new() }
    }
}

impl Default for Queues {
    fn default() -> Self {
        Self::new()
    }
}

impl UsartInterrupt {
    /// Moves the bytes that raised the interrupt. Returns whether the task that serves the drive is to run: a byte has arrived,
    /// or the last queued byte has left.
    ///
    /// # Errors
    /// A received byte is lost.
    pub fn serve(&mut self) -> Result<bool, LineError> {
        let has_drained = self.transmitter.as_mut().is_some_and(Transmitter::serve);
        match self.rx.read()? {
            Some(byte) => self.received.enqueue(byte).map(|()| true).map_err(|_| LineError),
            None => Ok(has_drained),
        }
    }
}

impl Transmitter {
    /// Writes a byte if the data register is empty. Returns whether it was the last of the queue: two byte times remain to
    /// queue more without a gap on the line.
    fn serve(&mut self) -> bool {
        if !self.tx.is_empty() {
            return false;
        }
        let Some(byte) = self.queue.dequeue() else {
            if self.is_listening {
                self.tx.interrupt_when_empty(false);
                self.is_listening = false;
            }
            return false;
        };
        self.tx.write(byte);
        if !self.is_listening {
            self.tx.interrupt_when_empty(true);
            self.is_listening = true;
        }
        !self.queue.ready()
    }
}

impl ByteLine for Usart {
    fn take(&mut self) -> Chunk {
        core::iter::from_fn(|| self.received.dequeue()).take(CHUNK_BYTES).collect()
    }

    fn load(&mut self, bytes: &[u8]) -> usize {
        match &mut self.output {
            Output::Interrupt { queue, is_loaded } => {
                let count = bytes.iter().take_while(|byte| queue.enqueue(**byte).is_ok()).count();
                *is_loaded |= count > 0;
                count
            }
            Output::Polling { piece, .. } => {
                let count = bytes.len().min(piece.capacity() - piece.len());
                // At most what is free.
                let _ = piece.extend_from_slice(&bytes[..count]);
                count
            }
        }
    }

    /// By polling, at 11 us per byte.
    fn send(&mut self) {
        match &mut self.output {
            Output::Interrupt { is_loaded, .. } => {
                if core::mem::take(is_loaded) {
                    NVIC::pend(Fitted::LINK);
                }
            }
            Output::Polling { tx, piece } => {
                for byte in piece.iter() {
                    while !tx.is_empty() {}
                    tx.write(*byte);
                }
                piece.clear();
            }
        }
    }
}
