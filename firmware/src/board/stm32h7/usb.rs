//! OTG2, a core of high speed with a transceiver of full speed.
//!
//! The driver sets VBUS sensing and re-enables endpoints by the id of the core. The id is read first, and nothing else is touched of
//! a core whose id the driver doesn't have.

use stm32h7xx_hal::gpio::{PA11, PA12};
use stm32h7xx_hal::pac::{OTG2_HS_DEVICE, OTG2_HS_GLOBAL, OTG2_HS_PWRCLK};
use stm32h7xx_hal::rcc::{CoreClocks, ResetEnable, rec};
use stm32h7xx_hal::usb_hs::{USB2, UsbBus};

use crate::board::usb_port::{self, UsbMemory};
use crate::usb::UsbLine;

pub(super) type Bus = UsbBus<USB2>;

/// Ids of the cores that the driver treats as one of an STM32H7; RM0433 57.14.13 prints the first.
const CORES: [u32; 3] = [0x2300, 0x3000, 0x3100];

/// Address of the unique id (RM0433 61.1).
const UNIQUE_ID: *const [u32; 3] = 0x1ff1_e800 as *const _;

/// Opens the port; `None` on a chip with another core.
pub(super) fn open(
    (global, device, power): (OTG2_HS_GLOBAL, OTG2_HS_DEVICE, OTG2_HS_PWRCLK),
    block: rec::Usb2Otg,
    (data_minus, data_plus): (PA11, PA12),
    clocks: &CoreClocks,
    memory: &'static mut UsbMemory<Bus>,
) -> Option<UsbLine<'static, Bus>> {
    let block = block.enable();
    if !CORES.contains(&global.cid.read().bits()) {
        let _ = block.disable();
        return None;
    }
    // SAFETY: the address is that of three words in the chip's system memory, which nothing writes.
    #[allow(unsafe_code)]
    let unique_id = unsafe { UNIQUE_ID.read_volatile() };
    let pins = (data_minus.into_alternate(), data_plus.into_alternate());
    let usb = USB2::new(global, device, power, pins.0, pins.1, block, clocks);
    usb_port::open(|packets| UsbBus::new(usb, packets), unique_id, memory)
}
