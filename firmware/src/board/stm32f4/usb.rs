//! OTG_FS.
//!
//! The driver sets VBUS sensing and re-enables endpoints by the id of the core, so it doesn't work on a core whose id it
//! doesn't have. The id is read first, and nothing else of such a core is touched.

use stm32f4xx_hal::gpio::{PA11, PA12};
use stm32f4xx_hal::otg_fs::{USB, UsbBus};
use stm32f4xx_hal::pac::{OTG_FS_DEVICE, OTG_FS_GLOBAL, OTG_FS_PWRCLK};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use crate::board::usb_port::{self, UsbMemory};
use crate::usb::UsbLine;

pub(super) type Bus = UsbBus<USB>;

/// Ids of the cores that the driver treats as one of an STM32F405. Chips of the family report 0x1200 for OTG_FS (TinyUSB's table
/// of cores); RM0090 34.16.2 prints 0x1000.
const CORES: [u32; 2] = [0x1100, 0x1200];

/// Address of the unique id (RM0090 39.1).
const UNIQUE_ID: *const [u32; 3] = 0x1fff_7a10 as *const _;

/// Opens the port; `None` on a chip with another core.
pub(super) fn open(
    (global, device, power): (OTG_FS_GLOBAL, OTG_FS_DEVICE, OTG_FS_PWRCLK),
    (data_minus, data_plus): (PA11, PA12),
    rcc: &mut Rcc,
    memory: &'static mut UsbMemory<Bus>,
) -> Option<UsbLine<'static, Bus>> {
    OTG_FS_GLOBAL::enable(rcc);
    if !CORES.contains(&global.cid().read().bits()) {
        OTG_FS_GLOBAL::disable(rcc);
        return None;
    }
    // SAFETY: the address is that of three words in the chip's system memory, which nothing writes.
    #[allow(unsafe_code)]
    let unique_id = unsafe { UNIQUE_ID.read_volatile() };
    let usb = USB::new((global, device, power), (data_minus, data_plus), &rcc.clocks);
    usb_port::open(|packets| UsbBus::new(usb, packets), unique_id, memory)
}
