//! The drive between its lines: a UART, and a USB port if the board has one.
//!
//! The task that serves the drive calls [`Lines::poll`], and then [`Lines::exchange`] and [`Lines::send`] in turn until no byte
//! moves. Only `exchange` needs the drive: it takes at most one frame, so a control step waits for one request at most.

use heapless::Vec;
use lashloop_protocol::frame::DELIMITER;
use usb_device::bus::UsbBus;

use super::line::UsbLine;
use super::line_selection::{Line, LineSelection};
use crate::drive::{Clock, Drive};
use crate::law::LawSet;

/// Capacity of a [`Chunk`].
pub const CHUNK_BYTES: usize = 64;

/// Bytes taken from a UART at once.
pub type Chunk = Vec<u8, CHUNK_BYTES>;

/// A line of single bytes: a UART with its buffers.
pub trait ByteLine {
    /// Takes received bytes.
    fn take(&mut self) -> Chunk;
    /// Copies bytes for transmission, as many as the buffer has space for, and returns their number.
    fn load(&mut self, bytes: &[u8]) -> usize;
    /// Transmits the copied bytes, or starts their transmission.
    fn send(&mut self);
}

/// The lines of a drive.
pub struct Lines<'bus, U, B: UsbBus> {
    uart: U,
    /// `None` without a USB core, or without a clock that is accurate enough for one.
    usb: Option<UsbLine<'bus, B>>,
    selection: LineSelection,
    /// Bytes from the UART, and how many of them the drive has taken.
    chunk: Chunk,
    taken: usize,
    /// Bytes of the drive's output that the UART has copied since it was cleared.
    loaded: usize,
    /// A delimiter goes ahead of the output, as in [`UsbLine::restart`].
    delimiter_due: bool,
}

impl<'bus, U: ByteLine, B: UsbBus> Lines<'bus, U, B> {
    /// The lines at the start. The UART is served first.
    pub fn new(uart: U, usb: Option<UsbLine<'bus, B>>) -> Self {
        let selection = LineSelection::default();
        Self { uart, usb, selection, chunk: Chunk::new(), taken: 0, loaded: 0, delimiter_due: false }
    }

    /// Serves the events of the bus.
    pub fn poll(&mut self) {
        if let Some(usb) = &mut self.usb {
            usb.poll();
        }
    }

    /// Passes at most one received frame to the drive, and at most one piece of its output to the served line. Returns whether
    /// any byte has moved.
    pub fn exchange<L: LawSet>(&mut self, drive: &mut Drive<L>, clock: &impl Clock) -> bool {
        let received = self.receive_uart(drive, clock) || self.receive_usb(drive, clock);
        received | self.transmit(drive)
    }

    /// Transmits what [`Self::exchange`] has passed to the UART.
    pub fn send(&mut self) {
        self.uart.send();
    }

    /// The USB port.
    pub fn usb(&self) -> Option<&UsbLine<'bus, B>> {
        self.usb.as_ref()
    }

    /// The UART.
    pub fn uart(&mut self) -> &mut U {
        &mut self.uart
    }

    fn receive_uart<L: LawSet>(&mut self, drive: &mut Drive<L>, clock: &impl Clock) -> bool {
        if self.taken == self.chunk.len() {
            self.chunk = self.uart.take();
            self.taken = 0;
        }
        if self.chunk.is_empty() {
            return false;
        }
        if !self.turn_to(Line::Usart, drive) {
            self.chunk.clear();
            self.taken = 0;
            return true;
        }
        let used = drive.receive(&self.chunk[self.taken..], clock);
        self.taken += used;
        used > 0
    }

    fn receive_usb<L: LawSet>(&mut self, drive: &mut Drive<L>, clock: &impl Clock) -> bool {
        if !self.usb.as_mut().is_some_and(UsbLine::has_received) {
            return false;
        }
        let is_admitted = self.turn_to(Line::Usb, drive);
        let Some(usb) = &mut self.usb else { return false };
        if is_admitted {
            return usb.receive(drive, clock);
        }
        usb.discard_received();
        true
    }

    /// Serves the line, unless a run binds the drive to the other one. Output for the other line is discarded.
    fn turn_to<L: LawSet>(&mut self, line: Line, drive: &mut Drive<L>) -> bool {
        let before = self.selection.served();
        let is_admitted = self.selection.admits(line, drive.state());
        if self.selection.served() != before {
            drive.clear_output();
            self.loaded = 0;
            match (line, &mut self.usb) {
                (Line::Usb, Some(usb)) => usb.restart(),
                (Line::Usb, None) => {}
                (Line::Usart, _) => self.delimiter_due = true,
            }
        }
        is_admitted
    }

    fn transmit<L: LawSet>(&mut self, drive: &mut Drive<L>) -> bool {
        match (self.selection.served(), &mut self.usb) {
            (Line::Usb, Some(usb)) => usb.transmit(drive),
            (Line::Usb, None) | (Line::Usart, _) => self.load(drive),
        }
    }

    fn load<L: LawSet>(&mut self, drive: &mut Drive<L>) -> bool {
        if self.delimiter_due {
            self.delimiter_due = self.uart.load(&[DELIMITER]) == 0;
            return !self.delimiter_due;
        }
        let rest = drive.output().get(self.loaded..).unwrap_or_default();
        if rest.is_empty() {
            return false;
        }
        let count = self.uart.load(rest);
        self.loaded += count;
        if self.loaded == drive.output().len() {
            drive.clear_output();
            self.loaded = 0;
        }
        count > 0
    }
}
