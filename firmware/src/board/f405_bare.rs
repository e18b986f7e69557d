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
//! All inputs have pull-ups: an open break input stops the amplifier, and an open channel of an encoder has no edges. The
//! amplifier needs a pull-down at its enable input, because all pins are inputs during a reset.

use stm32f4xx_hal::gpio::{Alternate, PA8, PB6, PB7, PC6, PC7, Pull, gpioa, gpiob, gpioc};
use stm32f4xx_hal::pac::{TIM1, TIM3, TIM4};
use stm32f4xx_hal::rcc::Rcc;

use super::encoder::Encoder;
use super::pwm_stage::{PwmStage, StagePins};

pub(super) use super::pwm_stage::switch_off;

/// Frequency of the crystal on OSC_IN and OSC_OUT (hertz). Change it for a board with another crystal: otherwise the
/// PLL runs at a wrong frequency.
pub(super) const CRYSTAL_HZ: u32 = 8_000_000;

pub(super) type MotorEncoder = Encoder<TIM3, PC6<Alternate<2>>, PC7<Alternate<2>>>;
pub(super) type LoadEncoder = Encoder<TIM4, PB6<Alternate<2>>, PB7<Alternate<2>>>;

/// The ports with the pins of bench mode.
pub(super) type Ports = (gpioa::PA8, gpiob::Parts, gpioc::Parts);

/// Configures the pins, starts the counters, and the power stage with its output off.
pub(super) fn start(
    (pulse, b, c): Ports,
    (pwm, motor, load): (TIM1, TIM3, TIM4),
    rcc: &mut Rcc,
) -> (MotorEncoder, LoadEncoder, PwmStage) {
    let motor_pins = (
        c.pc6.into_alternate().internal_resistor(Pull::Up),
        c.pc7.into_alternate().internal_resistor(Pull::Up),
    );
    let load_pins = (
        b.pb6.into_alternate().internal_resistor(Pull::Up),
        b.pb7.into_alternate().internal_resistor(Pull::Up),
    );
    let stage_pins = StagePins {
        not_ready: b.pb12.into_alternate().internal_resistor(Pull::Up),
        enable: b.pb0.into_push_pull_output(),
    };
    let stage = PwmStage::new(pwm, stage_pins, rcc);
    // After the timer has its output off.
    let _: PA8<Alternate<1>> = pulse.into_alternate();
    (Encoder::new(motor, motor_pins, rcc), Encoder::new(load, load_pins, rcc), stage)
}
