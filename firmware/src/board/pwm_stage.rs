//! The power stage: pulse-width modulation on TIM1, with break input and enable line.
//!
//! While the outputs are off the pulse output is low and the enable line is low: a duty of 0, which an amplifier for 10 to
//! 90 % takes for a broken wire.

use stm32f4xx_hal::gpio::{Alternate, Output, PB0, PB12};
use stm32f4xx_hal::pac::TIM1;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::power_stage::{DutyScale, PowerStage, PowerStageFault};

/// Cycles of the timer's 168 MHz in a period of the modulation: 20 kHz.
const PERIOD_CYCLES: u16 = 8_400;

/// The pins of the stage, apart from its pulse output.
pub(super) struct StagePins {
    /// Break input, high while the amplifier isn't ready.
    pub(super) not_ready: PB12<Alternate<1>>,
    /// Enable line, high while the amplifier may drive.
    pub(super) enable: PB0<Output>,
}

/// The power stage of the board.
pub struct PwmStage {
    timer: TIM1,
    pins: StagePins,
    scale: Option<DutyScale>,
}

impl PwmStage {
    /// Starts the modulation with its output off.
    pub(super) fn new(timer: TIM1, pins: StagePins, rcc: &mut Rcc) -> Self {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        timer.arr().write(|w| w.arr().set(PERIOD_CYCLES - 1));
        timer.ccmr1_output().write(|w| w.oc1m().pwm_mode1().oc1pe().enabled());
        timer.ccer().write(|w| w.cc1e().set_bit());
        // Off is the idle level of the output, low, and not an open pin. A break turns off without a clock, and only
        // software turns on again.
        timer.bdtr().write(|w| {
            w.bke().enabled().bkp().active_high();
            // No later store disables the break or changes the idle level.
            w.lock().level1();
            w.ossi().idle_level().aoe().manual().moe().disabled_idle()
        });
        timer.egr().write(|w| w.ug().update());
        timer.cr1().write(|w| w.arpe().enabled().cen().enabled());
        Self { timer, pins, scale: None }
    }

    fn set_duty(&self, duty: f32) {
        let cycles = duty * f32::from(PERIOD_CYCLES) + 0.5;
        self.timer.ccr1().write(|w| w.ccr().set(cycles as u16));
    }
}

impl PowerStage for PwmStage {
    fn enable(&mut self, scale: &DutyScale) {
        self.scale = Some(*scale);
        self.set_duty(scale.duty(0.0));
        // From the preload to the comparator before the output is on.
        self.timer.egr().write(|w| w.ug().update());
        self.timer.bdtr().modify(|_, w| w.moe().enabled());
        self.pins.enable.set_high();
    }

    fn apply(&mut self, torque_nm: f32) {
        if let Some(scale) = &self.scale {
            self.set_duty(scale.duty(torque_nm));
        }
    }

    fn disable(&mut self) {
        switch_off();
        self.scale = None;
    }

    fn fault(&mut self) -> Option<PowerStageFault> {
        // The flag keeps a pulse of the input; the pin has the level.
        let had_break = self.timer.sr().read().bif().bit_is_set();
        if had_break {
            self.timer.sr().modify(|_, w| w.bif().clear_bit());
        }
        (had_break || self.pins.not_ready.is_high()).then_some(PowerStageFault::BreakInput)
    }
}

/// Switches the outputs off, from any code. Before the start of the stage they are off, and this has no effect.
///
/// A function of its own in the image: tests on virtual silicon remove it, and every cause has to fail then.
#[inline(never)]
pub(super) fn switch_off() {
    use stm32f4xx_hal::pac::GPIOB;
    // SAFETY: two stores that only turn off; the owners never run again, or turn on again as they would have.
    #[allow(unsafe_code)]
    let (timer, port) = unsafe { (TIM1::steal(), GPIOB::steal()) };
    timer.bdtr().modify(|_, w| w.moe().disabled_idle());
    port.bsrr().write(|w| w.br0().set_bit());
}
