//! Current of a bridge and voltage of its bus: the injected group of ADC1, started by TIM1 in the middle of each period.

use stm32f4xx_hal::pac::{ADC_COMMON, ADC1};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::board::parts::BridgeSensor;

/// The converter with channel `CURRENT` of the current and `BUS` of the bus. Their pins have to be analog.
pub struct Adc<const CURRENT: u8, const BUS: u8>(ADC1);

impl<const CURRENT: u8, const BUS: u8> Adc<CURRENT, BUS> {
    /// Turns the converter on; nothing starts a conversion yet.
    pub(super) fn start((adc, common): (ADC1, ADC_COMMON), rcc: &mut Rcc) -> Self {
        ADC1::enable(rcc);
        ADC1::reset(rcc);
        // 84 MHz by 4: 21 MHz. 15 cycles to sample and 12 to convert, twice: 2.6 us.
        common.ccr().modify(|_, w| w.adcpre().div4());
        // SAFETY: every pattern of sampling times is one; 1 is 15 cycles, and a channel has 3 bits.
        #[allow(unsafe_code)]
        unsafe {
            adc.smpr1().write(|w| w.bits(0o111_111_111));
            adc.smpr2().write(|w| w.bits(0o1_111_111_111));
        }
        // Of a group of two the last ones are converted: numbers 3 and 4.
        // SAFETY: channels of the chip.
        #[allow(unsafe_code)]
        adc.jsqr().write(|w| unsafe { w.jl().bits(1).jsq3().bits(CURRENT).jsq4().bits(BUS) });
        adc.cr1().write(|w| w.scan().enabled().jeocie().enabled());
        adc.cr2().write(|w| w.adon().enabled().jextsel().tim1trgo());
        Self(adc)
    }
}

impl<const CURRENT: u8, const BUS: u8> BridgeSensor for Adc<CURRENT, BUS> {
    const EXISTS: bool = true;

    fn take(&mut self) -> [u16; 2] {
        self.0.sr().modify(|_, w| w.jeoc().clear_bit().jstrt().clear_bit());
        [self.0.jdr1().read().jdata().bits(), self.0.jdr2().read().jdata().bits()]
    }

    fn listen(does: bool) {
        // SAFETY: after the start the trigger is the only part of the register that changes, and only here.
        #[allow(unsafe_code)]
        let adc = unsafe { ADC1::steal() };
        adc.cr2().modify(|_, w| if does { w.jexten().rising_edge() } else { w.jexten().disabled() });
    }
}
