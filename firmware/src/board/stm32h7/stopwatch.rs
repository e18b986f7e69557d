//! TIM16 counts periods of the low-speed oscillator (RM0433 41.6.17, TI1SEL), to measure the crystal.

use stm32h7xx_hal::pac::{RCC, TIM16};

use crate::board::clock_source::{PERIODS_PER_CAPTURE, Stopwatch};

/// Polls until the low-speed oscillator is ready, or a capture has come. Eight periods take at most 0.5 ms, and a poll at least 8
/// cycles of at most 64 MHz.
const POLLS: u32 = 25_000;

/// Holds the timer; as after a reset when dropped.
pub(super) struct LsiStopwatch<'a> {
    rcc: &'a RCC,
    timer: &'a TIM16,
}

impl<'a> LsiStopwatch<'a> {
    /// Starts to count; `None` without a low-speed oscillator.
    pub(super) fn start(rcc: &'a RCC, timer: &'a TIM16) -> Option<Self> {
        rcc.csr.modify(|_, w| w.lsion().on());
        rcc.apb2enr.modify(|_, w| w.tim16en().enabled());
        // The clock of a peripheral comes two cycles after its enable.
        cortex_m::asm::dsb();
        // SAFETY: 1 connects channel 1 to the low-speed oscillator.
        #[allow(unsafe_code)]
        timer.tim16_tisel.write(|w| unsafe { w.ti1sel().bits(1) });
        // SAFETY: 3 captures every eighth edge.
        #[allow(unsafe_code)]
        timer
            .ccmr1_input()
            .write(|w| unsafe { w.cc1s().ti1().ic1psc().bits(PERIODS_PER_CAPTURE.ilog2() as u8) });
        timer.ccer.write(|w| w.cc1e().set_bit());
        timer.cr1.write(|w| w.cen().enabled());
        let stopwatch = Self { rcc, timer };
        (0..POLLS).any(|_| rcc.csr.read().lsirdy().is_ready()).then_some(stopwatch)
    }
}

impl Stopwatch for LsiStopwatch<'_> {
    const INTERNAL_KHZ: u32 = 64_000;
    const MAX: u32 = 0xffff;

    fn capture(&mut self) -> Option<u32> {
        (0..POLLS).find(|_| self.timer.sr.read().cc1if().bit_is_set())?;
        // Reading it clears the flag.
        Some(self.timer.ccr1().read().bits())
    }

    fn run_from_crystal(&mut self, from_crystal: bool) -> bool {
        let cfgr = &self.rcc.cfgr;
        cfgr.modify(|_, w| if from_crystal { w.sw().hse() } else { w.sw().hsi() });
        (0..POLLS).any(|_| {
            let source = cfgr.read().sws();
            if from_crystal { source.is_hse() } else { source.is_hsi() }
        })
    }
}

impl Drop for LsiStopwatch<'_> {
    fn drop(&mut self) {
        self.rcc.apb2rstr.modify(|_, w| w.tim16rst().set_bit());
        self.rcc.apb2rstr.modify(|_, w| w.tim16rst().clear_bit());
        self.rcc.apb2enr.modify(|_, w| w.tim16en().disabled());
        self.rcc.csr.modify(|_, w| w.lsion().off());
    }
}
