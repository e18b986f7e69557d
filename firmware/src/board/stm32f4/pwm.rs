//! Pulse-width modulation on TIM1, at 168 MHz.

use stm32f4xx_hal::pac::TIM1;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::board::parts::{Outputs, PwmTimer, StageLines};

/// Length of the trigger of the sensor before the end of the period, in counts.
const TRIGGER: u16 = 8;

/// The timer, with its main output off until it is turned on.
pub struct Tim1(TIM1);

impl Tim1 {
    /// Starts the timer for these lines.
    pub(super) fn start<S: StageLines>(timer: TIM1, rcc: &mut Rcc) -> Self {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode1().oc1pe().enabled();
            w.oc2m().pwm_mode1().oc2pe().enabled()
        });
        timer.bdtr().write(|w| {
            w.dtg().set(S::DEAD_TIME_CYCLES);
            if S::HAS_BREAK {
                w.bke().enabled().bkp().active_high();
            }
            // No later store disables the break, or changes dead time or idle level.
            w.lock().level1();
            w.ossi().idle_level().aoe().manual().moe().disabled_idle()
        });
        // The trigger of the bridge's sensor: high from the count of channel 4 on, independent of the main output.
        timer.ccmr2_output().write(|w| w.oc4m().pwm_mode2());
        timer.cr2().write(|w| w.mms().compare_oc4());
        timer.cr1().write(|w| w.arpe().enabled().cen().enabled());
        Self(timer)
    }
}

impl PwmTimer for Tim1 {
    fn select(&mut self, cycles_per_count: u16, counts: u16, is_centred: bool, outputs: Outputs) {
        // A counter that runs doesn't change its direction.
        self.0.cr1().modify(|_, w| w.cen().disabled());
        self.0
            .cr1()
            .modify(|_, w| if is_centred { w.cms().center_aligned2() } else { w.cms().edge_aligned() });
        // A centred counter has its own direction, which stays where it was and can't be written until then.
        if !is_centred {
            self.0.cr1().modify(|_, w| w.dir().up());
        }
        self.0.cnt().reset();
        self.0.psc().write(|w| w.psc().set(cycles_per_count - 1));
        // A centred counter turns at the last count, which it has once.
        let last = if is_centred { counts } else { counts - 1 };
        self.0.arr().write(|w| w.arr().set(last));
        // The sensor is started before the end, or the turn: 8 counts are 48 ns, and the converter samples its trigger at 84 MHz.
        self.0.ccr4().write(|w| w.ccr().set(last - TRIGGER));
        // The old prescaler and period would hold until the next update.
        self.update();
        self.0.cr1().modify(|_, w| w.cen().enabled());
        self.0.ccer().write(|w| {
            w.cc1e().set_bit().cc2e().bit(outputs.has_second);
            w.cc1ne().bit(outputs.has_complements).cc2ne().bit(outputs.has_complements)
        });
    }

    fn count(&self) -> u16 {
        self.0.cnt().read().cnt().bits()
    }

    fn set_high(&mut self, first: u16, second: u16) {
        self.0.cr1().modify(|_, w| w.udis().disabled());
        self.0.ccr1().write(|w| w.ccr().set(first));
        self.0.ccr2().write(|w| w.ccr().set(second));
        self.0.cr1().modify(|_, w| w.udis().enabled());
    }

    fn set_high_from_any_code(first: u16, second: u16) {
        // SAFETY: while the loop of the bridge runs, only its interrupt writes these registers.
        #[allow(unsafe_code)]
        let timer = unsafe { TIM1::steal() };
        timer.ccr1().write(|w| w.ccr().set(first));
        timer.ccr2().write(|w| w.ccr().set(second));
    }

    fn update(&mut self) {
        self.0.egr().write(|w| w.ug().update());
    }

    fn enable_outputs(&mut self) {
        self.0.bdtr().modify(|_, w| w.moe().enabled());
    }

    fn take_break(&mut self) -> bool {
        let had_break = self.0.sr().read().bif().bit_is_set();
        if had_break {
            self.0.sr().modify(|_, w| w.bif().clear_bit());
        }
        had_break
    }

    fn disable_outputs() {
        // SAFETY: of the register only the output enable changes after the start, and its owner changes it with interrupts
        // masked: what is written back here is what the owner has left. A non-maskable interrupt may come in between, and never
        // returns to the owner.
        #[allow(unsafe_code)]
        let timer = unsafe { TIM1::steal() };
        timer.bdtr().modify(|_, w| w.moe().disabled_idle());
    }
}
