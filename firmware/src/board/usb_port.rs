//! The chip's own USB port: a device of full speed on PA11 (D-) and PA12 (D+).
//!
//! The clock needs 0.25 % (USB 2.0, 7.1.11), which only a crystal has. The core doesn't watch VBUS: boards connect PA9 to it or
//! not. The pull-up at D+ is on from the start, and an unplugged device is a suspended one until the next reset of the bus.

use core::sync::atomic::{AtomicBool, Ordering};

use usb_device::bus::{UsbBus, UsbBusAllocator};

use crate::usb::{Identification, PACKET_BYTES, SerialNumber, UsbLine, serial_number};

/// Packets that the driver keeps: one of the control endpoint, one of the bulk endpoint.
const PACKETS: usize = 2;

static IS_OPEN: AtomicBool = AtomicBool::new(false);

/// What the port needs for as long as the firmware runs.
pub struct UsbMemory<B: UsbBus> {
    packets: [u32; PACKETS * PACKET_BYTES / 4],
    serial_number: SerialNumber,
    bus: Option<UsbBusAllocator<B>>,
}

impl<B: UsbBus> UsbMemory<B> {
    /// Before the port is open.
    #[must_use]
    pub const fn new() -> Self {
        Self { packets: [0; _], serial_number: SerialNumber::new(), bus: None }
    }
}

impl<B: UsbBus> Default for UsbMemory<B> {
    fn default() -> Self {
        Self::new()
    }
}

/// Opens the port with the driver that `driver` makes of memory for its packets.
pub(super) fn open<B: UsbBus>(
    driver: impl FnOnce(&'static mut [u32]) -> UsbBusAllocator<B>,
    unique_id: [u32; 3],
    memory: &'static mut UsbMemory<B>,
) -> Option<UsbLine<'static, B>> {
    let UsbMemory { packets, serial_number: number, bus } = memory;
    *number = serial_number(unique_id);
    let bus = bus.insert(driver(packets));
    let line = UsbLine::new(bus, Identification::of_bench_drive(number)).ok()?;
    IS_OPEN.store(true, Ordering::Relaxed);
    Some(line)
}

/// Whether the port is open.
pub(super) fn is_open() -> bool {
    IS_OPEN.load(Ordering::Relaxed)
}
