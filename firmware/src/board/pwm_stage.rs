//! The power stage: pulse-width modulation on TIM1. A board has its lines to amplifier or bridge.

use stm32f4xx_hal::pac::TIM1;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::power_stage::{Modulation, PowerStage, PowerStageFault, StageMode};

/// Frequency of the timer.
const TIMER_HZ: u32 = 168_000_000;

/// What a board has between timer and motor.
pub trait StageLines {
    /// What channels 1 and 2 of the timer, and their complements, can be to the power stage; first what they are by default.
    const MODES: &'static [StageMode];

    /// Time in which both switches of a half-bridge are off, in cycles of the timer, up to 127.
    const DEAD_TIME_CYCLES: u8;

    /// Whether a break input switches the outputs off without software while it is high.
    const HAS_BREAK: bool;

    /// Lets the amplifier or the bridge drive.
    fn enable(&mut self);

    /// The fault that the lines show. To be called once per tick, with whether the outputs are off.
    fn fault(&mut self, is_off: bool) -> Option<PowerStageFault>;

    /// Switches the stage off, from any code: [`clear_main_output`], and the board's own lines. Not inlined: tests on virtual
    /// silicon remove this function from the image, and then every cause has to fail.
    fn switch_off();
}

/// The power stage of a board.
pub struct PwmStage<S> {
    timer: TIM1,
    lines: S,
    modulation: Option<Modulation>,
    /// Counts of the timer in a period of the modulation.
    period_counts: u16,
}

impl<S: StageLines> PwmStage<S> {
    /// Starts the modulation with its output off.
    pub(super) fn new(timer: TIM1, lines: S, rcc: &mut Rcc) -> Self {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode1().oc1pe().enabled();
            w.oc2m().pwm_mode1().oc2pe().enabled()
        });
        // Off is the idle level of the output, low, and not an open pin. A break turns off without a clock, and only
        // software turns on again.
        timer.bdtr().write(|w| {
            w.dtg().set(S::DEAD_TIME_CYCLES);
            if S::HAS_BREAK {
                w.bke().enabled().bkp().active_high();
            }
            // No later store disables the break, or changes dead time or idle level.
            w.lock().level1();
            w.ossi().idle_level().aoe().manual().moe().disabled_idle()
        });
        timer.cr1().write(|w| w.arpe().enabled().cen().enabled());
        let mut stage = Self { timer, lines, modulation: None, period_counts: 0 };
        if let Some(mode) = S::MODES.first() {
            stage.select(*mode, 20_000);
        }
        stage.timer.egr().write(|w| w.ug().update());
        stage
    }

    /// Selects outputs and frequency, while the outputs are off. Those that the mode doesn't use are not driven.
    fn select(&mut self, mode: StageMode, frequency_hz: u32) {
        let cycles = TIMER_HZ / frequency_hz.max(1);
        let prescaler = cycles / u32::from(u16::MAX);
        // Both fit in 16 bits from 1 Hz on.
        self.period_counts = (cycles / (prescaler + 1)) as u16;
        self.timer.psc().write(|w| w.psc().set(prescaler as u16));
        self.timer.arr().write(|w| w.arr().set(self.period_counts - 1));
        let has_second = mode != StageMode::Amplifier;
        let has_complements = mode == StageMode::Complementary;
        self.timer.ccer().write(|w| {
            w.cc1e().set_bit().cc2e().bit(has_second);
            w.cc1ne().bit(has_complements).cc2ne().bit(has_complements)
        });
    }

    /// Sets the high times of both channels, 0 to 1.
    fn set_channels(&self, high: [f32; 2]) {
        let [first, second] = high.map(|high| (high * f32::from(self.period_counts) + 0.5) as u16);
        // Both take effect in the same period of the modulation: an update between the two would turn one half-bridge alone.
        let before = self.timer.cnt().read().cnt().bits();
        self.timer.cr1().modify(|_, w| w.udis().disabled());
        self.timer.ccr1().write(|w| w.ccr().set(first));
        self.timer.ccr2().write(|w| w.ccr().set(second));
        self.timer.cr1().modify(|_, w| w.udis().enabled());
        // An update that was due meanwhile is lost, and a modulation at the rate of the tick could lose every one.
        if self.timer.cnt().read().cnt().bits() < before {
            self.timer.egr().write(|w| w.ug().update());
        }
    }
}

impl<S: StageLines> PowerStage for PwmStage<S> {
    fn enable(&mut self, modulation: &Modulation) {
        self.modulation = Some(*modulation);
        self.select(modulation.mode, modulation.frequency_hz);
        self.set_channels(modulation.channels(0.0));
        // From the preload to counter and comparator before the output is on.
        self.timer.egr().write(|w| w.ug().update());
        // The monitor of the tick interrupts tasks; between read and write its trip would be undone.
        cortex_m::interrupt::free(|_| self.timer.bdtr().modify(|_, w| w.moe().enabled()));
        self.lines.enable();
    }

    fn apply(&mut self, torque_nm: f32) {
        if let Some(modulation) = &self.modulation {
            self.set_channels(modulation.channels(torque_nm));
        }
    }

    fn disable(&mut self) {
        S::switch_off();
        self.modulation = None;
    }

    fn fault(&mut self) -> Option<PowerStageFault> {
        // The flag keeps a pulse of the input; the pin has the level.
        let had_break = self.timer.sr().read().bif().bit_is_set();
        if had_break {
            self.timer.sr().modify(|_, w| w.bif().clear_bit());
        }
        if had_break {
            Some(PowerStageFault::BreakInput)
        } else {
            self.lines.fault(self.modulation.is_none())
        }
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
