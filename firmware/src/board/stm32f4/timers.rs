//! TIM2 and TIM5, counting microseconds in 32 bits.

use stm32f4xx_hal::pac::{TIM2, TIM5};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::board::parts::PeriodTimer;

/// Both timers have these registers, of two types.
macro_rules! period_timer {
    ($(#[$doc:meta])* $name:ident, $timer:ident) => {
        $(#[$doc])*
        pub struct $name($timer);

        impl $name {
            /// Starts to count; the first restart sets the period.
            pub(super) fn start(timer: $timer, rcc: &mut Rcc) -> Self {
                $timer::enable(rcc);
                $timer::reset(rcc);
                // 84 MHz on this chip.
                let cycles = rcc.clocks.timclk1().raw() / 1_000_000;
                timer.psc().write(|w| w.psc().set((cycles - 1) as u16));
                // A restart is an update event that is to raise no interrupt. It loads the prescaler too.
                timer.cr1().write(|w| w.urs().counter_only().cen().enabled());
                timer.dier().write(|w| w.uie().enabled());
                Self(timer)
            }
        }

        impl PeriodTimer for $name {
            fn restart(&mut self, period_us: u32) {
                self.0.arr().write(|w| w.set(period_us.saturating_sub(1)));
                self.0.egr().write(|w| w.ug().update());
            }

            fn count_us(&self) -> u32 {
                self.0.cnt().read().bits()
            }

            fn has_ended(&self) -> bool {
                self.0.sr().read().uif().bit_is_set()
            }

            fn clear(&mut self) {
                self.0.sr().modify(|_, w| w.uif().clear_bit());
            }
        }
    };
}

period_timer! {
    /// The timer of the monitor.
    Tim2, TIM2
}
period_timer! {
    /// The timer of the tick.
    Tim5, TIM5
}
