//! A NUCLEO-H743ZI: timer A of its Zio connectors, as on a NUCLEO-F429ZI.
//!
//! | pin | Zio | function | connected to |
//! |---|---|---|---|
//! | PC6, PC7 | D16, D21 | TIM3 channels 1 and 2 | motor encoder A, B |
//! | PD12, PD13 | D29, D28 | TIM4 channels 1 and 2 | load encoder A, B |
//! | PC8 | D43 | TIM3 channel 3 | index of the motor encoder |
//! | PD14 | D10 | TIM4 channel 3 | index of the load encoder |
//! | PE9 | D6 | TIM1 channel 1 | pulse input; high side A |
//! | PE11 | D5 | TIM1 channel 2 | direction or second pulse input; high side B |
//! | PE8, PE10 | D42, D40 | TIM1 complements of both channels | low sides A and B |
//! | PE15 | D37 | TIM1 break input | power stage: low while it is ready |
//! | PE7 | D41 | output | enable input of the power stage |
//! | PE4 | D57 | input | enable contact, to ground |
//! | PE5, PE6 | D58, D59 | inputs | negative and positive limit switch, to ground |
//! | PE3 | D60 | input | home switch, to ground |
//! | PD8, PD9 | | USART3 | the serial port of its ST-Link: link, see `link` |
//! | PA11, PA12 | | USB | connector CN13 |
//! | OSC_IN | | 8 MHz | a clock of its ST-Link, as delivered |

use stm32h7xx_hal::gpio::{
    Alternate, Output, PA11, PA12, PC6, PC7, PC8, PD8, PD9, PD12, PD13, PD14, PE7, PE15, Pull, gpioe,
};
use stm32h7xx_hal::pac::{GPIOE, Interrupt, TIM3, TIM4};

use crate::board::amplifier::AmplifierLines;
use crate::board::pwm_stage::PwmStage;
use crate::board::stm32h7::contacts::ContactPins;
use crate::board::stm32h7::encoder::Encoder;
use crate::board::stm32h7::ports::{Ports, Timers};
use crate::board::stm32h7::pwm::Tim1;

/// Name of the board.
pub const NAME: &str = "nucleo-h743zi";

/// The chip, as probe-rs names it.
pub const CHIP: &str = "STM32H743ZITx";

/// Whether OSC_IN has a clock, and not a crystal.
pub const HAS_CLOCK: bool = true;

pub type MotorEncoder = Encoder<TIM3, PC6<Alternate<2>>, PC7<Alternate<2>>, 3>;
pub type LoadEncoder = Encoder<TIM4, PD12<Alternate<2>>, PD13<Alternate<2>>, 3>;

/// Interrupt of the link.
pub const LINK: Interrupt = Interrupt::USART3;
/// Interrupt of the converters, which this board doesn't use yet.
pub const SENSOR: Interrupt = Interrupt::ADC1_2;
pub type LinkPins = (PD8<Alternate<7>>, PD9<Alternate<7>>);
/// The pins of bench mode.
pub type BenchPins = ((PC6, PC7, PC8), (PD12, PD13, PD14), gpioe::Parts);

/// Pins of the link, of the USB port, and of bench mode.
pub fn share(Ports { a, c, d, e }: Ports) -> (LinkPins, (PA11, PA12), BenchPins) {
    // The pull-up holds an open input idle: without it noise is received as bytes.
    let link = (d.pd8.into_alternate(), d.pd9.into_alternate().internal_resistor(Pull::Up));
    (link, (a.pa11, a.pa12), ((c.pc6, c.pc7, c.pc8), (d.pd12, d.pd13, d.pd14), e))
}

/// The lines of the power stage.
pub struct Lines {
    /// Break input, high while the power stage isn't ready.
    not_ready: PE15<Alternate<1>>,
    /// High while the power stage may drive.
    enable: PE7<Output>,
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
        let port = unsafe { &*GPIOE::ptr() };
        port.bsrr.write(|w| w.br7().set_bit());
    }
}

/// Configures the pins, starts the counters, and the power stage with its output off.
pub fn start(
    ((motor_a, motor_b, motor_index), (load_a, load_b, load_index), e): BenchPins,
    Timers { tim1, tim3, tim4 }: Timers,
) -> (MotorEncoder, LoadEncoder, ContactPins, PwmStage<Tim1, Lines>) {
    let motor_pins = (
        motor_a.into_alternate().internal_resistor(Pull::Up),
        motor_b.into_alternate().internal_resistor(Pull::Up),
    );
    let load_pins = (
        load_a.into_alternate().internal_resistor(Pull::Up),
        load_b.into_alternate().internal_resistor(Pull::Up),
    );
    motor_index.into_alternate::<2>().set_internal_resistor(Pull::Up);
    load_index.into_alternate::<2>().set_internal_resistor(Pull::Up);
    let lines = Lines {
        not_ready: e.pe15.into_alternate().internal_resistor(Pull::Up),
        enable: e.pe7.into_push_pull_output(),
    };
    let stage = PwmStage::new(Tim1::start::<Lines>(tim1), lines);
    // After the timer has its outputs off.
    e.pe9.into_alternate::<1>().set_internal_resistor(Pull::Down);
    e.pe11.into_alternate::<1>().set_internal_resistor(Pull::Down);
    e.pe8.into_alternate::<1>().set_internal_resistor(Pull::Down);
    e.pe10.into_alternate::<1>().set_internal_resistor(Pull::Down);
    let contacts = ContactPins([e.pe4.into_pull_up_input().erase(), e.pe5.into_pull_up_input().erase(), e.pe6.into_pull_up_input().erase(), e.pe3.into_pull_up_input().erase()]);
    (Encoder::new(tim3, motor_pins), Encoder::new(tim4, load_pins), contacts, stage)
}
