//! A bare STM32F405 board, with a servo amplifier in torque mode.
//!
//! | pin | function | connected to |
//! |---|---|---|
//! | PC6, PC7 | TIM3 channels 1 and 2 | motor encoder A, B |
//! | PB6, PB7 | TIM4 channels 1 and 2 | load encoder A, B |
//! | PA8 | TIM1 channel 1 | pulse input of the amplifier |
//! | PB12 | TIM1 break input | amplifier: low while it is ready |
//! | PB0 | output | enable input of the amplifier |
//! | PA2, PA3 | USART2 | link, see `link` |
//! | OSC_IN, OSC_OUT | 8 MHz crystal | |
//!
//! While the outputs are off the pulse output is low and the enable line is low: a duty of 0, which an amplifier for 10 to
//! 90 % takes for a broken wire.
//!
//! All inputs have pull-ups: an open break input stops the amplifier, and an open channel of an encoder has no edges. The
//! amplifier needs a pull-down at its enable input, because all pins are inputs during a reset.

use stm32f4xx_hal::gpio::{Alternate, Output, PA8, PB0, PB6, PB7, PB12, PC6, PC7, Pull};
use stm32f4xx_hal::pac::{GPIOB, TIM1, TIM3, TIM4};
use stm32f4xx_hal::rcc::Rcc;

use super::encoder::Encoder;
use super::ports::Ports;
use super::pwm_stage::{PwmStage, StageLines, clear_main_output};
use crate::power_stage::PowerStageFault;

/// Name of the board.
pub(super) const NAME: &str = "stm32f405";

/// Frequency of the crystal on OSC_IN and OSC_OUT (hertz). Change it for a board with another crystal: otherwise the
/// PLL runs at a wrong frequency.
pub(super) const CRYSTAL_HZ: u32 = 8_000_000;

pub(super) type MotorEncoder = Encoder<TIM3, PC6<Alternate<2>>, PC7<Alternate<2>>>;
pub(super) type LoadEncoder = Encoder<TIM4, PB6<Alternate<2>>, PB7<Alternate<2>>>;

/// The lines of the amplifier.
pub struct Lines {
    /// Break input, high while the amplifier isn't ready.
    not_ready: PB12<Alternate<1>>,
    /// High while the amplifier may drive.
    enable: PB0<Output>,
}

impl StageLines for Lines {
    const DEAD_TIME_CYCLES: Option<u8> = None;

    fn enable(&mut self) {
        self.enable.set_high();
    }

    fn fault(&self) -> Option<PowerStageFault> {
        self.not_ready.is_high().then_some(PowerStageFault::BreakInput)
    }

    #[inline(never)]
    fn switch_off() {
        clear_main_output();
        // SAFETY: a store that only turns off; the owner never runs again, or turns on again as it would have.
        #[allow(unsafe_code)]
        let port = unsafe { GPIOB::steal() };
        port.bsrr().write(|w| w.br0().set_bit());
    }
}

/// Configures the pins, starts the counters, and the power stage with its output off.
pub(super) fn start(
    ((_, pulse, ..), b, c, _): Ports,
    (pwm, motor, load): (TIM1, TIM3, TIM4),
    rcc: &mut Rcc,
) -> (MotorEncoder, LoadEncoder, PwmStage<Lines>) {
    let motor_pins = (
        c.pc6.into_alternate().internal_resistor(Pull::Up),
        c.pc7.into_alternate().internal_resistor(Pull::Up),
    );
    let load_pins = (
        b.pb6.into_alternate().internal_resistor(Pull::Up),
        b.pb7.into_alternate().internal_resistor(Pull::Up),
    );
    let lines = Lines {
        not_ready: b.pb12.into_alternate().internal_resistor(Pull::Up),
        enable: b.pb0.into_push_pull_output(),
    };
    let stage = PwmStage::new(pwm, lines, rcc);
    // After the timer has its output off.
    let _: PA8<Alternate<1>> = pulse.into_alternate();
    (Encoder::new(motor, motor_pins, rcc), Encoder::new(load, load_pins, rcc), stage)
}
