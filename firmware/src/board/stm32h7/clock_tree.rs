//! 168 MHz from the crystal, or from the internal oscillator without a crystal of a known frequency. Timers have the clocks of an
//! STM32F405: 84 MHz, TIM1 168 MHz.

use stm32h7xx_hal::pac::{PWR, RCC, SYSCFG, TIM16};
use stm32h7xx_hal::prelude::*;
use stm32h7xx_hal::rcc::rec::UsbClkSel;
use stm32h7xx_hal::rcc::{Ccdr, PllConfigStrategy};

use super::fitted;
use super::stopwatch::LsiStopwatch;
use crate::board::clock_source::{ClockSource, Unusable, crystal_hz};
use crate::board::parts::CORE_HZ;

/// Polls of the crystal's ready flag before the internal oscillator is used. A poll takes at least 8 cycles at the
/// initial 64 MHz, so the limit is 100 ms or slightly more.
const CRYSTAL_POLLS: u32 = 800_000;

/// Configures the clock tree.
pub(super) fn start(rcc: RCC, pwr: PWR, syscfg: &SYSCFG, timer: &TIM16) -> (Ccdr, ClockSource) {
    reset(&rcc);
    rcc.cr.modify(|_, w| w.hsebyp().bit(fitted::HAS_CLOCK));
    // The HAL waits for the crystal without a timeout, so we start it first and select it only if it runs.
    rcc.cr.modify(|_, w| w.hseon().on());
    let steady = (0..CRYSTAL_POLLS).any(|_| rcc.cr.read().hserdy().is_ready());
    let crystal = if steady {
        LsiStopwatch::start(&rcc, timer).and_then(crystal_hz).ok_or(Unusable::UnknownFrequency)
    } else {
        Err(Unusable::Silent)
    };
    if crystal.is_ok() {
        // From here on a crystal that stops is a break of TIM1, and a non-maskable interrupt, which switches off too. Only a reset
        // turns this off again.
        rcc.cr.modify(|_, w| w.hsecsson().on());
    } else {
        rcc.cr.modify(|_, w| w.hseon().off());
    }
    // The transceiver of another speed, which isn't there, has a clock that the core would wait for in its sleep.
    rcc.ahb1lpenr.modify(|_, w| w.usb2otghsulpilpen().clear_bit());
    let config = rcc
        .constrain()
        .pll1_strategy(PllConfigStrategy::Fractional)
        .sys_ck(CORE_HZ.Hz())
        .hclk(CORE_HZ.Hz())
        .pclk1((CORE_HZ / 4).Hz())
        .pclk2((CORE_HZ / 2).Hz())
        .pclk3((CORE_HZ / 2).Hz())
        .pclk4((CORE_HZ / 2).Hz())
        .pll1_q_ck(48.MHz());
    let (config, source) = match crystal {
        Ok(hz) if fitted::HAS_CLOCK => (config.use_hse(hz.Hz()).bypass_hse(), ClockSource::Crystal),
        Ok(hz) => (config.use_hse(hz.Hz()), ClockSource::Crystal),
        Err(why) => (config, ClockSource::InternalOscillator(why)),
    };
    // 25 MHz give 168 MHz to 1 ppm, the others exactly.
    let mut tree = config.freeze(pwr.constrain().freeze(), syscfg);
    tree.peripheral.kernel_usb_clk_mux(UsbClkSel::Pll1Q);
    (tree, source)
}

/// Clocks and peripherals as after a reset. A boot loader that has jumped here may still run from the PLL, whose configuration
/// can't change while it is on (RM0433 8.5.5), and have its peripherals at the pins.
#[inline(never)]
fn reset(rcc: &RCC) {
    rcc.cr.modify(|_, w| w.hsion().on());
    while rcc.cr.read().hsirdy().is_not_ready() {}
    rcc.cfgr.reset();
    while !rcc.cfgr.read().sws().is_hsi() {}
    // Clocks of the peripherals, while the former ones still run: a selector needs both to change.
    rcc.d1ccipr.reset();
    rcc.d2ccip1r.reset();
    rcc.d2ccip2r.reset();
    rcc.d3ccipr.reset();
    rcc.cr.modify(|_, w| w.pll1on().off().pll2on().off().pll3on().off().hseon().off());
    while rcc.cr.read().pll1rdy().is_ready() {}
    while rcc.cr.read().pll2rdy().is_ready() {}
    while rcc.cr.read().pll3rdy().is_ready() {}
    rcc.pllcfgr.reset();
    // A divider that a PLL uses can't change.
    rcc.cr.modify(|_, w| w.hsidiv().div1());
    rcc.d1cfgr.reset();
    rcc.d2cfgr.reset();
    rcc.d3cfgr.reset();
    // SAFETY: every bit resets a peripheral or nothing, and no peripheral is in use. The register of AHB3 resets the core too, so
    // it isn't among them.
    #[allow(unsafe_code)]
    unsafe {
        rcc.ahb1rstr.write(|w| w.bits(u32::MAX));
        rcc.ahb2rstr.write(|w| w.bits(u32::MAX));
        rcc.ahb4rstr.write(|w| w.bits(u32::MAX));
        rcc.apb1lrstr.write(|w| w.bits(u32::MAX));
        rcc.apb1hrstr.write(|w| w.bits(u32::MAX));
        rcc.apb2rstr.write(|w| w.bits(u32::MAX));
    }
    rcc.ahb1rstr.reset();
    rcc.ahb2rstr.reset();
    rcc.ahb4rstr.reset();
    rcc.apb1lrstr.reset();
    rcc.apb1hrstr.reset();
    rcc.apb2rstr.reset();
}
