//! 168 MHz from the crystal, or from the internal oscillator when there is none.

use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// Core clock (hertz), the highest of the STM32F405 and what QEMU's machine counts SysTick with.
pub(crate) const CORE_HZ: u32 = 168_000_000;

/// Frequency of the crystal on OSC_IN and OSC_OUT (hertz). A board with another one must have it written here: the
/// PLL would run at a wrong multiple.
const CRYSTAL_HZ: u32 = 8_000_000;

/// How often to look for a steady crystal. A look takes at least 8 cycles of the 16 MHz the chip starts with, so
/// this is 100 ms or a little more; a crystal needs some 2 ms by the data sheet.
const CRYSTAL_LOOKS: u32 = 200_000;

/// What drives the core.
#[derive(Clone, Copy)]
pub(crate) enum Source {
    /// QEMU: always 168 MHz, nothing to set.
    Emulator,
    /// The crystal, some 50 ppm.
    Crystal,
    /// The internal RC oscillator, 1 % at room temperature: good enough for the link, not for timing.
    InternalOscillator,
}

/// Sets the clock tree up.
pub(crate) fn start(rcc: RCC, emulated: bool) -> (Rcc, Source) {
    if emulated {
        // The HAL would wait for ready flags that never come; this configuration has none to wait for.
        return (rcc.freeze(Config::hsi()), Source::Emulator);
    }
    // The HAL waits for the crystal without end, so we start it ourselves and give the HAL only one that runs.
    rcc.cr().modify(|_, w| w.hseon().on());
    let steady = (0..CRYSTAL_LOOKS).any(|_| rcc.cr().read().hserdy().is_ready());
    let (config, source) = if steady {
        (Config::hse(CRYSTAL_HZ.Hz()), Source::Crystal)
    } else {
        rcc.cr().modify(|_, w| w.hseon().off());
        (Config::hsi(), Source::InternalOscillator)
    };
    (rcc.freeze(config.sysclk(CORE_HZ.Hz())), source)
}
