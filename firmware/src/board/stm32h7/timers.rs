//! TIM2 and TIM5, counting microseconds in 32 bits.

use core::ops::Deref;

use stm32h7xx_hal::pac::{TIM2, TIM5, tim2::RegisterBlock};
use stm32h7xx_hal::rcc::ResetEnable;

use crate::board::parts::{CORE_HZ, PeriodTimer};

/// Cycles of the timers in a microsecond: 84 MHz.
const CYCLES_PER_US: u16 = (CORE_HZ / 2 / 1_000_000) as u16;

/// The timer of the monitor.
pub type Tim2 = Timer<TIM2>;
/// The timer of the tick.
pub type Tim5 = Timer<TIM5>;

/// One of both.
pub struct Timer<T>(T);

impl<T: Deref<Target = RegisterBlock>> Timer<T> {
    /// Starts to count; the first restart sets the period.
    pub(super) fn start(timer: T, block: impl ResetEnable) -> Self {
        let _ = block.enable().reset();
        timer.psc.write(|w| w.psc().bits(CYCLES_PER_US - 1));
        // A restart is an update event that is to raise no interrupt. It loads the prescaler too.
        timer.cr1.write(|w| w.urs().counter_only().cen().enabled());
        timer.dier.write(|w| w.uie().enabled());
        Self(timer)
    }
}

impl<T: Deref<Target = RegisterBlock> + Send + 'static> PeriodTimer for Timer<T> {
    fn restart(&mut self, period_us: u32) {
        self.0.arr.write(|w| w.arr().bits(period_us.saturating_sub(1)));
        self.0.egr.write(|w| w.ug().update());
    }

    fn count_us(&self) -> u32 {
        self.0.cnt.read().bits()
    }

    fn has_ended(&self) -> bool {
        self.0.sr.read().uif().bit_is_set()
    }

    fn clear(&mut self) {
        self.0.sr.modify(|_, w| w.uif().clear_bit());
    }
}
