//! The gate driver of an ODrive, a DRV8301, at SPI3: its registers as far as a firmware sees them (TI SLOS719).

use rigless::chip::Timeline;
use rigless::chip::spi::Peer;
use rigless::snapshot::Store;

/// First status register, and the two control registers.
const STATUS: usize = 0;
const CONTROLS: std::ops::RangeInclusive<usize> = 2..=3;
const DATA: u16 = 0x07ff;

/// The driver with a supply.
#[derive(Debug, Default)]
pub struct GateDriver {
    registers: [u16; 16],
    /// Answer to the last frame.
    answer: u16,
    has_no_supply: bool,
}

impl GateDriver {
    /// Bits of the first status register: 9 and 8 undervoltage, 7 and 6 temperature, 5 to 0 overcurrent.
    pub fn set_status(&mut self, bits: u16) {
        self.registers[STATUS] = bits & DATA;
    }

    /// The first control register.
    #[must_use]
    pub fn control(&self) -> u16 {
        self.registers[*CONTROLS.start()]
    }

    /// Takes or gives the supply: without it the registers lose their values, and nothing answers.
    pub fn set_supply(&mut self, has_supply: bool) {
        *self = Self { has_no_supply: !has_supply, ..Self::default() };
    }
}

impl Store for GateDriver {}

impl Peer for GateDriver {
    fn transfer(&mut self, frame: u32, _bits: u8, _context: &mut Timeline<'_, '_>) -> u32 {
        if self.has_no_supply {
            // The pull-up of the chip.
            return 0xffff;
        }
        let frame = frame as u16;
        let (is_read, address) = (frame >> 15 == 1, usize::from(frame >> 11 & 0xf));
        let answer = std::mem::replace(&mut self.answer, (frame & 0x7800) | self.registers[address]);
        if !is_read {
            self.answer = self.registers[STATUS];
            if CONTROLS.contains(&address) {
                self.registers[address] = frame & DATA;
            }
        }
        answer.into()
    }
}
