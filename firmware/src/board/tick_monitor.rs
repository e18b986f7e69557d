//! The monitor of the tick: TIM2 counts from the start of every tick, and the power stage is off 1.5 periods later unless the next
//! tick restarts it.
//!
//! The timer is not that of the tick, and its task preempts all others. So neither a tick that stops nor a step that never
//! ends leaves the power stage on.

use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::fitted;
use super::pwm_stage::StageLines;

/// Owned by the task of TIM2, and by that of the tick.
pub struct TickMonitor {
    timer: TIM2,
}

impl TickMonitor {
    /// Starts to count; the first tick sets the limit.
    pub(super) fn start(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        // Counts microseconds; 84 MHz on this chip.
        let cycles = rcc.clocks.timclk1().raw() / 1_000_000;
        timer.psc().write(|w| w.psc().set((cycles - 1) as u16));
        // A restart is an update event that is to raise no interrupt. It loads the prescaler too.
        timer.cr1().write(|w| w.urs().counter_only().cen().enabled());
        timer.dier().write(|w| w.uie().enabled());
        Self { timer }
    }

    /// Counts from 0 to this limit.
    pub(super) fn restart(&mut self, limit_us: u32) {
        self.timer.arr().write(|w| w.set(limit_us));
        self.timer.egr().write(|w| w.ug().update());
    }

    /// Switches the power stage off. To be called at every interrupt; without ticks there is another one after each limit.
    pub fn trip(&mut self) {
        self.timer.sr().modify(|_, w| w.uif().clear_bit());
        fitted::Lines::switch_off();
    }
}
