//! The link: USART2 on PA2 (out) and PA3 (in), 8N1.
//!
//! Received bytes come by interrupt and wait in a queue. Answers are sent by polling: QEMU never raises the
//! transmitter's interrupts, and a path that ran nowhere but on silicon would be the one path no test has seen. The
//! processor has nothing better to do meanwhile, and what does come (bytes, ticks) interrupts it.

use heapless::{Vec, spsc};
use lashloop_firmware::drive::Drive;
use stm32f4xx_hal::gpio::{PA2, PA3, Pull};
use stm32f4xx_hal::nb;
use stm32f4xx_hal::pac::USART2;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Config, Rx, RxListen, Tx};

/// Bits per second, as hosts take by default. Our divider makes 913,043 of it (42 MHz by 46), the common USB adapters
/// 923,077 (3 MHz by 3.25): they are 1.1 % apart, and the receiver bears 3.3 % (RM0090 30.3.5).
const BAUD: u32 = 921_600;

/// Received bytes that may wait: 11 ms of the line, far more than one frame's work.
const QUEUE_BYTES: usize = 1024;

/// Bytes handed to the drive, or copied from it, at once.
const CHUNK_BYTES: usize = 64;

/// Where received bytes wait.
pub(crate) type Queue = spsc::Queue<u8, QUEUE_BYTES>;

/// Something was lost on the way in: an overrun of the USART or the queue, a framing error or noise.
pub(crate) struct LineError;

/// The side of the receive interrupt.
pub(crate) struct Receiver {
    rx: Rx<USART2>,
    queue: spsc::Producer<'static, u8>,
}

/// The side of the task that reads.
pub(crate) struct Inbox {
    queue: spsc::Consumer<'static, u8>,
}

/// A piece of the drive's output, and the way out.
pub(crate) struct Outbox {
    tx: Tx<USART2>,
    piece: Vec<u8, CHUNK_BYTES>,
    /// Bytes of the drive's output that were loaded since it was cleared.
    loaded: usize,
}

/// Opens the link and listens.
pub(crate) fn open(
    usart: USART2,
    (out_pin, in_pin): (PA2, PA3),
    rcc: &mut Rcc,
    queue: &'static mut Queue,
) -> (Receiver, Inbox, Outbox) {
    // The pull-up keeps an open input at rest: without it noise would look like bytes.
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
    pub(crate) fn take_byte(&mut self) -> Result<(), LineError> {
        match self.rx.read() {
            Ok(byte) => self.queue.enqueue(byte).map_err(|_| LineError),
            Err(nb::Error::WouldBlock) => Ok(()),
            Err(nb::Error::Other(_)) => Err(LineError),
        }
    }
}

impl Inbox {
    /// Takes what has come, at most a chunk.
    pub(crate) fn take(&mut self) -> Vec<u8, CHUNK_BYTES> {
        core::iter::from_fn(|| self.queue.dequeue()).take(CHUNK_BYTES).collect()
    }

    /// Whether nothing waits.
    pub(crate) fn is_empty(&self) -> bool {
        !self.queue.ready()
    }
}

impl Outbox {
    /// Copies the next piece of the drive's output. When all of it has been sent, clears it and returns `false`.
    ///
    /// Piece by piece, because the drive is locked only while we copy and may add to its output while we send.
    pub(crate) fn load(&mut self, drive: &mut Drive) -> bool {
        self.piece = drive.output().iter().skip(self.loaded).take(CHUNK_BYTES).copied().collect();
        self.loaded += self.piece.len();
        let more = !self.piece.is_empty();
        if !more {
            drive.clear_output();
            self.loaded = 0;
        }
        more
    }

    /// Sends the piece, 11 us a byte.
    pub(crate) fn send(&mut self) {
        for byte in &self.piece {
            // A transmitter has no error to report (RM0090 30.6.1), it only makes us wait.
            let _ = nb::block!(self.tx.write(*byte));
        }
    }
}
