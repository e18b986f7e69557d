//! 168 MHz from the crystal, or from the internal oscillator without a crystal of a known frequency.

use stm32f4xx_hal::pac::{RCC, TIM5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

use super::fitted;
use super::stopwatch::LsiStopwatch;
use crate::board::clock_source::{ClockSource, Unusable, crystal_hz};
use crate::board::parts::CORE_HZ;

/// Polls of the crystal's ready flag before the internal oscillator is used. A poll takes at least 8 cycles at the
/// initial 16 MHz, so the limit is 100 ms or slightly more; the data sheet gives 2 ms for a crystal.
const CRYSTAL_POLLS: u32 = 200_000;

/// Configures the clock tree.
pub(super) fn start(rcc: RCC, timer: &TIM5, emulated: bool) -> (Rcc, ClockSource) {
    if emulated {
        // With any other configuration the HAL waits for ready flags that QEMU never sets.
        return (rcc.freeze(Config::hsi()), ClockSource::Emulator);
    }
    reset(&rcc);
    if fitted::HAS_CLOCK {
        rcc.cr().modify(|_, w| w.hsebyp().bypassed());
    }
    // The HAL waits for the crystal without a timeout, so we start it first and select it only if it runs.
    rcc.cr().modify(|_, w| w.hseon().on());
    let steady = (0..CRYSTAL_POLLS).any(|_| rcc.cr().read().hserdy().is_ready());
    let crystal = if steady {
        // From here on a crystal that stops is a break of TIM1, and a non-maskable interrupt, which switches off too.
        rcc.cr().modify(|_, w| w.csson().on());
        LsiStopwatch::start(&rcc, timer).and_then(crystal_hz).ok_or(Unusable::UnknownFrequency)
    } else {
        Err(Unusable::Silent)
    };
    let (config, source) = match crystal {
        Ok(hz) => (Config::hse(hz.Hz()), ClockSource::Crystal),
        Err(why) => {
            rcc.cr().modify(|_, w| w.csson().off().hseon().off());
            (Config::hsi(), ClockSource::InternalOscillator(why))
        }
    };
    (rcc.freeze(config.sysclk(CORE_HZ.Hz()).require_pll48clk()), source)
}

/// Clocks and peripherals as after a reset. A boot loader that has jumped here may still run from the PLL, whose configuration
/// can't change while it is on (RM0090 7.3.2), and have its peripherals at the pins.
#[inline(never)]
fn reset(rcc: &RCC) {
    rcc.cr().modify(|_, w| w.hsion().on());
    while rcc.cr().read().hsirdy().is_not_ready() {}
    rcc.cfgr().reset();
    while !rcc.cfgr().read().sws().is_hsi() {}
    rcc.cr().modify(|_, w| w.csson().off().pllon().off().hseon().off().hsebyp().not_bypassed());
    while rcc.cr().read().pllrdy().is_ready() {}
    // SAFETY: every bit resets a peripheral or nothing, and no peripheral is in use.
    #[allow(unsafe_code)]
    unsafe {
        rcc.ahb1rstr().write(|w| w.bits(u32::MAX));
        rcc.ahb2rstr().write(|w| w.bits(u32::MAX));
        rcc.apb1rstr().write(|w| w.bits(u32::MAX));
        rcc.apb2rstr().write(|w| w.bits(u32::MAX));
    }
    rcc.ahb1rstr().reset();
    rcc.ahb2rstr().reset();
    rcc.apb1rstr().reset();
    rcc.apb2rstr().reset();
}
