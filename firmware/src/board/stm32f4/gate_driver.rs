//! The gate driver of an ODrive, a DRV8301 (TI SLOS719), over SPI3.
//!
//! Its registers lose their values without a supply, which may come after the start of this firmware. So while the outputs are off,
//! each tick exchanges one frame: one sets the register, one reads it back, one reads the status. A frame answers the one before it.

use stm32f4xx_hal::gpio::{Output, PC10, PC11, PC12, PC13};
use stm32f4xx_hal::pac::SPI3;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::{Mode, Phase, Polarity, Spi};

use crate::power_stage::PowerStageFault;

/// Overcurrent from 0.73 V between drain and source of a switch on, which switches the bridge off until the next power cycle; six
/// inputs, largest gate current. As in the board's own firmware.
const CONTROL: u16 = 21 << 6 | 0b01 << 4;
const DATA: u16 = 0x07ff;
/// The driver takes a bit at the falling edge. 1.3 MHz suit pins of the lowest speed.
const MODE: Mode = Mode { polarity: Polarity::IdleLow, phase: Phase::CaptureOnSecondTransition };

/// Frames: address at bit 11, bit 15 for reading.
const SET_CONTROL: u16 = 2 << 11 | CONTROL;
const READ_CONTROL: u16 = 1 << 15 | 2 << 11;
const READ_STATUS: u16 = 1 << 15;

/// Bits of the first status register.
const UNDERVOLTAGE: u16 = 1 << 9 | 1 << 8;
const OVERTEMPERATURE: u16 = 1 << 7 | 1 << 6;
const OVERCURRENT: u16 = 0x3f;

/// At least 400 ns between two frames, at 168 MHz.
const PAUSE_CYCLES: u32 = 84;

/// The driver of M0.
pub struct GateDriver {
    spi: Spi<SPI3, false, u16>,
    select: PC13<Output>,
    /// The last frame.
    sent: u16,
    is_set: bool,
    was_line_low: bool,
    status: u16,
}

impl GateDriver {
    pub(super) fn new(
        spi: SPI3,
        (clock, from_driver, to_driver): (PC10, PC11, PC12),
        select: PC13<Output>,
        rcc: &mut Rcc,
    ) -> Self {
        let pins = (Some(clock), Some(from_driver.into_pull_up_input()), Some(to_driver));
        let spi = Spi::new(spi, pins, MODE, 2.MHz(), rcc).frame_size_16bit();
        Self { spi, select, sent: READ_STATUS, is_set: false, was_line_low: false, status: 0 }
    }

    /// The fault of the driver whose fault line has this level. To be called once per tick.
    pub(super) fn fault(&mut self, is_line_low: bool, is_off: bool) -> Option<PowerStageFault> {
        if is_line_low && !self.was_line_low {
            self.exchange(READ_STATUS);
            self.status = self.exchange(READ_STATUS);
        } else if is_off {
            self.look();
        }
        self.was_line_low = is_line_low;
        if !self.is_set {
            return Some(PowerStageFault::NoSupply);
        }
        is_line_low.then(|| cause(self.status))
    }

    fn look(&mut self) {
        let next = match self.sent {
            SET_CONTROL => READ_CONTROL,
            READ_CONTROL => READ_STATUS,
            _ => SET_CONTROL,
        };
        let before = self.sent;
        let answer = self.exchange(next);
        match before {
            READ_CONTROL => self.is_set = answer == 2 << 11 | CONTROL,
            READ_STATUS => self.status = answer,
            _ => {}
        }
    }

    /// Sends a frame. Returns the answer to the one before.
    fn exchange(&mut self, frame: u16) -> u16 {
        let mut word = [frame];
        cortex_m::asm::delay(PAUSE_CYCLES);
        self.select.set_low();
        // 50 ns, and the edge of a slow pin.
        cortex_m::asm::delay(PAUSE_CYCLES);
        // A master always ends: its clock is that of the chip.
        let ended = self.spi.transfer_in_place(&mut word);
        self.select.set_high();
        self.sent = frame;
        if ended.is_ok() { word[0] } else { 0 }
    }
}

fn cause(status: u16) -> PowerStageFault {
    let has = |bits| status & DATA & bits != 0;
    if has(UNDERVOLTAGE) {
        PowerStageFault::NoSupply
    } else if has(OVERTEMPERATURE) {
        PowerStageFault::Overtemperature
    } else if has(OVERCURRENT) {
        PowerStageFault::Overcurrent
    } else {
        PowerStageFault::FaultLine
    }
}
