//! The link: USART2 on PA2 (out) and PA3 (in), 8N1.
//!
//! The receive interrupt queues bytes. Transmission polls: QEMU never raises the transmitter's interrupts, so an
//! interrupt-driven path would run on silicon only and stay untested. Bytes and ticks interrupt the polling.

use crate::drive::Drive;
use crate::law::LawSet;
use heapless::{Vec, spsc};
use stm32f4xx_hal::gpio::{PA2, PA3, Pull};
use stm32f4xx_hal::nb;
use stm32f4xx_hal::pac::USART2;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Config, Rx, RxListen, Tx};

/// Bits per second, the default of hosts. The divider gives 913,043 (42 MHz by 46), common USB adapters give 923,077
/// (3 MHz by 3.25): the difference is 1.1 %, and the receiver tolerates 3.3 % (RM0090 30.3.5).
const BAUD: u32 = 921_600;

/// Capacity of the receive queue: 11 ms of line time, far more than the handling of one frame takes.
const QUEUE_BYTES: usize = 1024;

/// Bytes passed to or from the drive at once.
const CHUNK_BYTES: usize = 64;

/// The receive queue.
pub type Queue = spsc::Queue<u8, QUEUE_BYTES>;

/// A received byte was lost: overrun of the USART or the queue, framing error or noise.
pub struct LineError;

/// Owned by the receive interrupt.
pub struct Receiver {
    rx: Rx<USART2>,
    queue: spsc::Producer<'static, u8>,
}

/// Owned by the task that reads.
pub struct Inbox {
    queue: spsc::Consumer<'static, u8>,
}

/// A piece of the drive's output, and the transmitter.
pub struct Outbox {
    tx: Tx<USART2>,
    piece: Vec<u8, CHUNK_BYTES>,
    /// Bytes of the drive's output loaded since it was cleared.
    loaded: usize,
}

/// Opens the link and enables the receive interrupt.
pub(crate) fn open(
    usart: USART2,
    (out_pin, in_pin): (PA2, PA3),
    rcc: &mut Rcc,
    queue: &'static mut Queue,
) -> (Receiver, Inbox, Outbox) {
    // The pull-up holds an open input idle: without it noise is received as bytes.
    let pins = (out_pin, in_pin.internal_resistor(Pull::Up));
    let config = Config::default().baudrate(BAUD.bps());
    let serial =
        usart.serial(pins, config, rcc).expect("the peripheral clock is at least 8 times the baud rate");
    let (tx, mut rx) = serial.split();
    rx.listen();
    let (producer, consumer) = queue.split();
    (Receiver { rx, queue: producer }, Inbox { queue: consumer }, Outbox { tx, piece: Vec::new(), loaded: 0 })
}

impl Receiver {
    /// Puts the byte that raised the interrupt into the queue.
    ///
    /// # Errors
    /// The byte is lost.
    pub fn take_byte(&mut self) -> Result<(), LineError> {
        match self.rx.read() {
            Ok(byte) => self.queue.enqueue(byte).map_err(|_| LineError),
            Err(nb::Error::WouldBlock) => Ok(()),
            Err(nb::Error::Other(_)) => Err(LineError),
        }
    }
}

impl Inbox {
    /// Takes received bytes, at most a chunk.
    pub fn take(&mut self) -> Vec<u8, CHUNK_BYTES> {
        core::iter::from_fn(|| self.queue.dequeue()).take(CHUNK_BYTES).collect()
    }

    /// Whether the queue is empty.
    pub fn is_empty(&self) -> bool {
        !self.queue.ready()
    }
}

impl Outbox {
    /// Copies the next piece of the drive's output. After the last piece it clears the output and returns `false`.
    ///
    /// Piece by piece: the drive is locked only during the copy and may append to its output during the transmission.
    pub fn load<L: LawSet>(&mut self, drive: &mut Drive<L>) -> bool {
        self.piece = drive.output().iter().skip(self.loaded).take(CHUNK_BYTES).copied().collect();
        self.loaded += self.piece.len();
        let more = !self.piece.is_empty();
        if !more {
            drive.clear_output();
            self.loaded = 0;
        }
        more
    }

    /// Transmits the piece, at 11 us per byte.
    pub fn send(&mut self) {
        for byte in &self.piece {
            // A transmitter reports no error (RM0090 30.6.1), only that it is busy.
            let _ = nb::block!(self.tx.write(*byte));
        }
    }
}
