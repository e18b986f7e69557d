//! The USB port of the chip: OTG_FS as a device of full speed on PA11 (D-) and PA12 (D+).
//!
//! The driver sets VBUS sensing and re-enables endpoints by the id of the core, so it doesn't work on a core whose id it
//! doesn't have. The id is read first, and nothing else of such a core is touched. The clock needs 0.25 % (USB 2.0, 7.1.11),
//! which only a crystal has.
//!
//! The core doesn't watch VBUS: boards connect PA9 to it or not. The pull-up at D+ is on from the start, and an unplugged
//! device is a suspended one until the next reset of the bus.

use core::sync::atomic::{AtomicBool, Ordering};

use stm32f4xx_hal::gpio::{PA11, PA12};
use stm32f4xx_hal::otg_fs::{USB, UsbBus};
use stm32f4xx_hal::pac::{OTG_FS_DEVICE, OTG_FS_GLOBAL, OTG_FS_PWRCLK};
use stm32f4xx_hal::rcc::{Enable, Rcc};
use usb_device::bus::UsbBusAllocator;

use crate::usb::{Identification, PACKET_BYTES, SerialNumber, UsbLine, serial_number};

/// The bus of the chip.
pub type Bus = UsbBus<USB>;

/// Ids of the cores that the driver treats as one of an STM32F405. Chips of the family report 0x1200 for OTG_FS (TinyUSB's table
/// of cores); RM0090 34.16.2 prints 0x1000.
const CORES: [u32; 2] = [0x1100, 0x1200];

/// Address of the unique id (RM0090 39.1).
const UNIQUE_ID: *const [u32; 3] = 0x1fff_7a10 as *const _;

/// Packets that the driver keeps: one of the control endpoint, one of the bulk endpoint.
const PACKETS: usize = 2;

static IS_OPEN: AtomicBool = AtomicBool::new(false);

/// What the port needs for as long as the firmware runs.
pub struct UsbMemory {
    packets: [u32; PACKETS * PACKET_BYTES / 4],
    serial_number: SerialNumber,
    bus: Option<UsbBusAllocator<Bus>>,
}

impl UsbMemory {
    /// Before the port is open.
    #[must_use]
    pub const fn new() -> Self {
        Self { packets: [0; _], serial_number: SerialNumber::new(), bus: None }
    }
}

impl Default for UsbMemory {
    fn default() -> Self {
        Self::new()
    }
}

/// Opens the port; `None` on a chip with another core.
pub(super) fn open(
    (global, device, power): (OTG_FS_GLOBAL, OTG_FS_DEVICE, OTG_FS_PWRCLK),
    (data_minus, data_plus): (PA11, PA12),
    rcc: &mut Rcc,
    memory: &'static mut UsbMemory,
) -> Option<UsbLine<'static, Bus>> {
    OTG_FS_GLOBAL::enable(rcc);
    if !CORES.contains(&global.cid().read().bits()) {
        OTG_FS_GLOBAL::disable(rcc);
        return None;
    }
    // SAFETY: the address is that of three words in the chip's system memory, which nothing writes.
    #[allow(unsafe_code)]
    let unique_id = unsafe { UNIQUE_ID.read_volatile() };
    let UsbMemory { packets, serial_number: number, bus } = memory;
    *number = serial_number(unique_id);
    let usb = USB::new((global, device, power), (data_minus, data_plus), &rcc.clocks);
    let bus = bus.insert(UsbBus::new(usb, packets));
    let line = UsbLine::new(bus, Identification::of_bench_drive(number)).ok()?;
    IS_OPEN.store(true, Ordering::Relaxed);
    Some(line)
}

/// Disconnects the device from the host, if the port is open. The host then reports an unplugged device instead of a drive
/// that is silent.
pub(super) fn disconnect() {
    if IS_OPEN.load(Ordering::Relaxed) {
        // SAFETY: interrupts are off, and control never returns to the owner of the port.
        #[allow(unsafe_code)]
        let device = unsafe { OTG_FS_DEVICE::steal() };
        device.dctl().modify(|_, w| w.sdis().set_bit());
    }
}
