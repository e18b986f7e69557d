//! The crystal, measured and not believed.
//!
//! TIM5 counts 32 periods of the low-speed oscillator (RM0090 18.4.20), once with the internal oscillator as its clock and once
//! with the crystal. The quotient is that of the two clocks; the frequency of the low-speed oscillator, 17 to 47 kHz, cancels.

use stm32f4xx_hal::pac::{RCC, TIM5};

/// Crystals that the clock tree takes to 168 and 48 MHz.
const KNOWN_HZ: [u32; 4] = [8_000_000, 12_000_000, 16_000_000, 25_000_000];
/// The internal oscillator, to 1 % at room temperature and 4 % from -10 to 85 degrees Celsius.
const INTERNAL_KHZ: u32 = 16_000;
/// A crystal that differs by more than one part in this is another one.
const TOLERANCE: u32 = 20;
/// Captures in a measurement, each of [`PERIODS_PER_CAPTURE`] periods.
const CAPTURES: usize = 4;
/// By the prescaler of the capture.
const PERIODS_PER_CAPTURE: u8 = 8;
/// Polls until the low-speed oscillator is ready, or a capture has come. Eight periods take at most 0.5 ms, and a poll at least 8
/// cycles of at most 26 MHz.
const POLLS: u32 = 10_000;

/// The frequency of the crystal in Hz, if it is a known one. The core has to run from the internal oscillator, and does so
/// afterwards; the crystal has to run.
pub(super) fn frequency_hz(rcc: &RCC, timer: &TIM5) -> Option<u32> {
    rcc.csr().modify(|_, w| w.lsion().on());
    rcc.apb1enr().modify(|_, w| w.tim5en().enabled());
    // Erratum: the clock of a peripheral comes two cycles after its enable (ES0182 2.1.13).
    cortex_m::asm::dsb();
    // SAFETY: 1 connects channel 4 to the low-speed oscillator.
    #[allow(unsafe_code)]
    timer.or().write(|w| unsafe { w.it4_rmp().bits(1) });
    // SAFETY: 3 captures every eighth edge.
    #[allow(unsafe_code)]
    timer.ccmr2_input().write(|w| unsafe { w.cc4s().ti4().ic4psc().bits(PERIODS_PER_CAPTURE.ilog2() as u8) });
    timer.ccer().write(|w| w.cc4e().set_bit());
    timer.cr1().write(|w| w.cen().enabled());
    let counts = (0..POLLS).any(|_| rcc.csr().read().lsirdy().is_ready()).then(|| both(rcc, timer)).flatten();
    rcc.apb1rstr().modify(|_, w| w.tim5rst().reset());
    rcc.apb1rstr().modify(|_, w| w.tim5rst().clear_bit());
    rcc.apb1enr().modify(|_, w| w.tim5en().disabled());
    rcc.csr().modify(|_, w| w.lsion().off());
    let (internal, crystal) = counts?;
    // At most 4 times 8 periods of 17 kHz at 26 MHz: 49,000 counts.
    let khz = crystal.checked_mul(INTERNAL_KHZ)?.checked_div(internal)?;
    KNOWN_HZ.into_iter().find(|known_hz| (known_hz / 1_000).abs_diff(khz) <= known_hz / 1_000 / TOLERANCE)
}

/// Counts of the same time by the internal oscillator and by the crystal. The clock security system notices a crystal that stops
/// meanwhile.
fn both(rcc: &RCC, timer: &TIM5) -> Option<(u32, u32)> {
    let internal = counts(timer)?;
    rcc.cfgr().modify(|_, w| w.sw().hse());
    if !(0..POLLS).any(|_| rcc.cfgr().read().sws().is_hse()) {
        return None;
    }
    let crystal = counts(timer);
    rcc.cfgr().modify(|_, w| w.sw().hsi());
    while !rcc.cfgr().read().sws().is_hsi() {}
    Some((internal, crystal?))
}

/// Counts of the timer from one capture to the [`CAPTURES`]th after the next.
fn counts(timer: &TIM5) -> Option<u32> {
    // The period that is being counted began with another clock.
    capture(timer)?;
    let first = capture(timer)?;
    let mut last = first;
    for _ in 0..CAPTURES {
        last = capture(timer)?;
    }
    Some(last.wrapping_sub(first))
}

/// The count at the next capture; reading it clears the flag.
fn capture(timer: &TIM5) -> Option<u32> {
    (0..POLLS).find(|_| timer.sr().read().cc4if().bit_is_set())?;
    Some(timer.ccr4().read().bits())
}
