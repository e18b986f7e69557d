//! A bare STM32F405 board, with a servo amplifier in torque mode, or a bridge.
//!
//! | pin | function | connected to |
//! |---|---|---|
//! | PC6, PC7 | TIM3 channels 1 and 2 | motor encoder A, B |
//! | PB6, PB7 | TIM4 channels 1 and 2 | load encoder A, B |
//! | PC8 | TIM3 channel 3 | index of the motor encoder |
//! | PB8 | TIM4 channel 3 | index of the load encoder |
//! | PA8 | TIM1 channel 1 | pulse input of the amplifier; PWM, IN1, or high side A of a bridge |
//! | PA9 | TIM1 channel 2 | nothing at an amplifier; direction, IN2, or high side B of a bridge |
//! | PB13, PB14 | TIM1 complements of both channels | low sides A and B of two half-bridges |
//! | PB12 | TIM1 break input | power stage: low while it is ready |
//! | PB0 | output | enable input of the power stage |
//! | PB1 | output | switch of a brake resistor at the bus of a bridge: high while it is on |
//! | PC0 | ADC1 input 10 | current sensor of a bridge: half the supply of the chip at no current |
//! | PC1 | ADC1 input 11 | voltage of the bus, divided |
//! | PC2 | input | enable contact, to ground |
//! | PC3, PC4 | inputs | negative and positive limit switch, to ground |
//! | PC5 | input | home switch, to ground |
//! | PA2, PA3 | USART2 | link, see `link` |
//! | OSC_IN, OSC_OUT | crystal of 8, 12, 16 or 25 MHz | |
//!
//! While the outputs are off they and the enable line are low: a duty of 0, which an amplifier for 10 to 90 % takes for a
//! broken wire, and a bridge for no drive. Outputs that a mode doesn't use are pulled down and not driven.
//!
//! All inputs have pull-ups: an open break input stops the power stage, and an open channel of an encoder has no edges. The
//! power stage needs a pull-down at its enable input, because all pins are inputs during a reset.

use stm32f4xx_hal::gpio::{
    Alternate, Output, PA2, PA3, PA8, PA9, PA11, PA12, PB0, PB6, PB7, PB12, PC6, PC7, Pull, gpiob, gpioc,
};
use stm32f4xx_hal::pac::{GPIOB, Interrupt, TIM3, TIM4, USART2};
use stm32f4xx_hal::rcc::Rcc;

use crate::board::amplifier::AmplifierLines;
use crate::board::pwm_stage::PwmStage;
use crate::board::stm32f4::adc::Adc;
use crate::board::stm32f4::contacts::ContactPins;
use crate::board::stm32f4::encoder::Encoder;
use crate::board::stm32f4::ports::{Blocks, Ports};
use crate::board::stm32f4::pwm::Tim1;

/// The chip, as probe-rs names it.
pub const CHIP: &str = "STM32F405RGTx";

/// Whether OSC_IN has a clock, and not a crystal.
pub const HAS_CLOCK: bool = false;

/// Name of the board.
pub const NAME: &str = "stm32f405";

pub type MotorEncoder = Encoder<TIM3, PC6<Alternate<2>>, PC7<Alternate<2>>, 3>;
pub type LoadEncoder = Encoder<TIM4, PB6<Alternate<2>>, PB7<Alternate<2>>, 3>;
/// PC0 has the current, PC1 the bus.
pub type Sensor = Adc<10, 11>;

/// The port of the link.
pub type LinkPort = USART2;
pub const LINK: Interrupt = Interrupt::USART2;
/// Interrupt of the converters.
pub const SENSOR: Interrupt = Interrupt::ADC;
pub type LinkPins = (PA2, PA3);
/// The pins of bench mode.
pub type BenchPins = (PA8, PA9, gpiob::Parts, gpioc::Parts);

/// Port and pins of the link, pins of the USB port, and of bench mode.
pub fn share(Ports { a, b, c, usart2, .. }: Ports) -> ((LinkPort, LinkPins), (PA11, PA12), BenchPins) {
    ((usart2, (a.pa2, a.pa3)), (a.pa11, a.pa12), (a.pa8, a.pa9, b, c))
}

/// The lines of the amplifier.
pub struct Lines {
    /// Break input, high while the amplifier isn't ready.
    not_ready: PB12<Alternate<1>>,
    /// High while the amplifier may drive.
    enable: PB0<Output>,
}

impl AmplifierLines for Lines {
    type Timer = Tim1;

    fn is_broken(&self) -> bool {
        self.not_ready.is_high()
    }

    fn raise_enable(&mut self) {
        self.enable.set_high();
    }

    fn lower_enable() {
        // SAFETY: a store that only turns off; the owner never runs again, or turns on again as it would have.
        #[allow(unsafe_code)]
        let port = unsafe { GPIOB::steal() };
        port.bsrr().write(|w| w.br0().set_bit());
    }

    fn set_brake(is_high: bool) {
        // SAFETY: a store to a pin of no other owner.
        #[allow(unsafe_code)]
        let port = unsafe { GPIOB::steal() };
        port.bsrr().write(|w| w.bs1().bit(is_high).br1().bit(!is_high));
    }
}

/// Configures the pins, starts the counters, and the power stage with its output off.
pub fn start(
    (first, second, b, c): BenchPins,
    Blocks { pwm, motor, load, adc, .. }: Blocks,
    rcc: &mut Rcc,
) -> (MotorEncoder, LoadEncoder, ContactPins, PwmStage<Tim1, Lines>, Sensor) {
    let motor_pins = (
        c.pc6.into_alternate().internal_resistor(Pull::Up),
        c.pc7.into_alternate().internal_resistor(Pull::Up),
    );
    let load_pins = (
        b.pb6.into_alternate().internal_resistor(Pull::Up),
        b.pb7.into_alternate().internal_resistor(Pull::Up),
    );
    c.pc8.into_alternate::<2>().set_internal_resistor(Pull::Up);
    b.pb8.into_alternate::<2>().set_internal_resistor(Pull::Up);
    let lines = Lines {
        not_ready: b.pb12.into_alternate().internal_resistor(Pull::Up),
        enable: b.pb0.into_push_pull_output(),
    };
    let stage = PwmStage::new(Tim1::start::<Lines>(pwm, rcc), lines);
    // After the timer has its outputs off.
    first.into_alternate::<1>().set_internal_resistor(Pull::Down);
    second.into_alternate::<1>().set_internal_resistor(Pull::Down);
    b.pb13.into_alternate::<1>().set_internal_resistor(Pull::Down);
    b.pb14.into_alternate::<1>().set_internal_resistor(Pull::Down);
    b.pb1.into_push_pull_output();
    c.pc0.into_analog();
    c.pc1.into_analog();
    let contacts = ContactPins([c.pc2.into_pull_up_input().erase(), c.pc3.into_pull_up_input().erase(), c.pc4.into_pull_up_input().erase(), c.pc5.into_pull_up_input().erase()]);
    let sensor = Sensor::start(adc, rcc);
    (Encoder::new(motor, motor_pins, rcc), Encoder::new(load, load_pins, rcc), contacts, stage, sensor)
}
