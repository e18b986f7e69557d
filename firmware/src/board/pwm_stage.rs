//! The power stage: pulse-width modulation on TIM1. A board has its lines to amplifier or bridge.

use stm32f4xx_hal::pac::TIM1;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::power_stage::{DutyScale, PowerStage, PowerStageFault};

/// Cycles of the timer's 168 MHz in a period of the modulation: 20 kHz.
const PERIOD_CYCLES: u16 = 8_400;

/// What a board has between timer and motor.
pub trait StageLines {
    /// Time in which both switches of a half-bridge are off, in cycles of the timer, up to 127: channels 1 and 2 with their
    /// complements drive a half-bridge at the duty, and one at 1 minus the duty. `None` for a pulse output on channel 1, and a
    /// break input that switches it off without software while it is high.
    const DEAD_TIME_CYCLES: Option<u8>;

    /// Lets the amplifier or the bridge drive.
    fn enable(&mut self);

    /// The fault that the lines show.
    fn fault(&self) -> Option<PowerStageFault>;

    /// Switches the stage off, from any code: [`clear_main_output`], and the board's own lines. Not inlined: tests on virtual
    /// silicon remove this function from the image, and then every cause has to fail.
    fn switch_off();
}

/// The power stage of a board.
pub struct PwmStage<S> {
    timer: TIM1,
    lines: S,
    scale: Option<DutyScale>,
}

impl<S: StageLines> PwmStage<S> {
    /// Starts the modulation with its output off.
    pub(super) fn new(timer: TIM1, lines: S, rcc: &mut Rcc) -> Self {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        timer.arr().write(|w| w.arr().set(PERIOD_CYCLES - 1));
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode1().oc1pe().enabled();
            w.oc2m().pwm_mode1().oc2pe().enabled()
        });
        timer.ccer().write(|w| match S::DEAD_TIME_CYCLES {
            None => w.cc1e().set_bit(),
            Some(_) => w.cc1e().set_bit().cc1ne().set_bit().cc2e().set_bit().cc2ne().set_bit(),
        });
        // Off is the idle level of the output, low, and not an open pin. A break turns off without a clock, and only
        // software turns on again.
        timer.bdtr().write(|w| {
            match S::DEAD_TIME_CYCLES {
                None => w.bke().enabled().bkp().active_high(),
                Some(cycles) => w.dtg().set(cycles),
            };
            // No later store disables the break, or changes dead time or idle level.
            w.lock().level1();
            w.ossi().idle_level().aoe().manual().moe().disabled_idle()
        });
        timer.egr().write(|w| w.ug().update());
        timer.cr1().write(|w| w.arpe().enabled().cen().enabled());
        Self { timer, lines, scale: None }
    }

    fn set_duty(&self, duty: f32) {
        let cycles = (duty * f32::from(PERIOD_CYCLES) + 0.5) as u16;
        // Both take effect in the same period of the modulation: an update between the two would turn one half-bridge alone.
        self.timer.cr1().modify(|_, w| w.udis().disabled());
        self.timer.ccr1().write(|w| w.ccr().set(cycles));
        self.timer.ccr2().write(|w| w.ccr().set(PERIOD_CYCLES - cycles));
        self.timer.cr1().modify(|_, w| w.udis().enabled());
    }
}

impl<S: StageLines> PowerStage for PwmStage<S> {
    fn enable(&mut self, scale: &DutyScale) {
        self.scale = Some(*scale);
        self.set_duty(scale.duty(0.0));
        // From the preload to the comparator before the output is on.
        self.timer.egr().write(|w| w.ug().update());
        // The monitor of the tick interrupts tasks; between read and write its trip would be undone.
        cortex_m::interrupt::free(|_| self.timer.bdtr().modify(|_, w| w.moe().enabled()));
        self.lines.enable();
    }

    fn apply(&mut self, torque_nm: f32) {
        if let Some(scale) = &self.scale {
            self.set_duty(scale.duty(torque_nm));
        }
    }

    fn disable(&mut self) {
        S::switch_off();
        self.scale = None;
    }

    fn fault(&mut self) -> Option<PowerStageFault> {
        // The flag keeps a pulse of the input; the pin has the level.
        let had_break = self.timer.sr().read().bif().bit_is_set();
        if had_break {
            self.timer.sr().modify(|_, w| w.bif().clear_bit());
        }
        if had_break { Some(PowerStageFault::BreakInput) } else { self.lines.fault() }
    }
}

/// Clears the main output enable, from any code. Before the start of the stage it is clear, and this has no effect.
pub(super) fn clear_main_output() {
    // SAFETY: of the register only the output enable changes after the start, and its owner changes it with interrupts
    // masked: what is written back here is what the owner has left. A non-maskable interrupt may come in between, and never
    // returns to the owner.
    #[allow(unsafe_code)]
    let timer = unsafe { TIM1::steal() };
    timer.bdtr().modify(|_, w| w.moe().disabled_idle());
}
