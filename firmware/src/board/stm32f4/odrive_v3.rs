//! An ODrive v3.5 or v3.6, with a brushed motor between the phases A and B of motor connector M0.
//!
//! | pin | function | connected to |
//! |---|---|---|
//! | PB4, PB5 | TIM3 channels 1 and 2 | encoder connector M0: motor encoder A, B |
//! | PB6, PB7 | TIM4 channels 1 and 2 | encoder connector M1: load encoder A, B |
//! | PC9 | TIM3 channel 4 | encoder connector M0: index of the motor encoder |
//! | PA8, PB13 | TIM1 channel 1 and its complement | gate driver M0, phase A high and low |
//! | PA9, PB14 | TIM1 channel 2 and its complement | gate driver M0, phase B high and low |
//! | PB12 | output | EN_GATE of both gate drivers (DRV8301) |
//! | PD2 | input | nFAULT of both gate drivers |
//! | PC10, PC11, PC12 | SPI3 | clock, data out and data in of both gate drivers |
//! | PC13, PC14 | outputs | chip selects of the gate drivers of M0 and M1; that of M1 stays high |
//! | PA0 | input | GPIO1: enable contact, to ground |
//! | PA1, PC4 | inputs | GPIO2 and GPIO5: negative and positive limit switch, to ground |
//! | PB2 | input | GPIO6: home switch, to ground |
//! | PA2, PA3 | USART2 | GPIO3 and GPIO4: link, see `link` |
//! | PA11, PA12 | USB | USB connector |
//! | OSC_IN, OSC_OUT | 8 MHz crystal | |
//!
//! No break input of TIM1 is free on this board: PB12 is EN_GATE. nFAULT is read at every tick, and the gate driver is asked for
//! the cause, see `gate_driver`. EN_GATE stays high from the start, because the gate driver takes up to 10 ms to follow it, and
//! reports a fault until then. The bridge is off while TIM1 holds all gates low.

use stm32f4xx_hal::gpio::{
    Alternate, Input, PA0, PA1, PA2, PA3, PA7, PA8, PA9, PA10, PA11, PA12, PB4, PB5, PB6, PB7, PB13, PB14, PD2,
    PinState, Pull, gpiob, gpioc, gpiod,
};
use stm32f4xx_hal::pac::{Interrupt, TIM3, TIM4, USART2};
use stm32f4xx_hal::rcc::Rcc;

use crate::board::parts::{NoSensor, PwmTimer as _, StageLines};
use crate::board::pwm_stage::PwmStage;
use crate::board::stm32f4::contacts::ContactPins;
use crate::board::stm32f4::encoder::Encoder;
use crate::board::stm32f4::gate_driver::GateDriver;
use crate::board::stm32f4::ports::{Blocks, Ports};
use crate::board::stm32f4::pwm::Tim1;
use crate::power_stage::{PowerStageFault, StageMode};

/// The chip, as probe-rs names it.
pub const CHIP: &str = "STM32F405RGTx";

/// Whether OSC_IN has a clock, and not a crystal.
pub const HAS_CLOCK: bool = false;

/// Name of the board.
pub const NAME: &str = "odrive-v3";

/// The port of the link.
pub type LinkPort = USART2;
pub const LINK: Interrupt = Interrupt::USART2;
/// Interrupt of the converters.
pub const SENSOR: Interrupt = Interrupt::ADC;
pub type LinkPins = (PA2, PA3);
/// The pins of bench mode.
pub type BenchPins = ((PA0, PA1), (PA7, PA8, PA9, PA10), gpiob::Parts, gpioc::Parts, gpiod::Parts);

/// Port and pins of the link, pins of the USB port, and of bench mode.
pub fn share(Ports { a, b, c, d, usart2, .. }: Ports) -> ((LinkPort, LinkPins), (PA11, PA12), BenchPins) {
    ((usart2, (a.pa2, a.pa3)), (a.pa11, a.pa12), ((a.pa0, a.pa1), (a.pa7, a.pa8, a.pa9, a.pa10), b, c, d))
}

pub type MotorEncoder = Encoder<TIM3, PB4<Alternate<2>>, PB5<Alternate<2>>, 4>;
/// The index of connector M1 is PC15, to which no timer leads.
pub type LoadEncoder = Encoder<TIM4, PB6<Alternate<2>>, PB7<Alternate<2>>>;
/// The board's own shunts are not read yet.
pub type Sensor = NoSensor;

/// The lines of the gate drivers.
pub struct Lines {
    not_fault: PD2<Input>,
    driver: GateDriver,
}

impl StageLines for Lines {
    const MODES: &'static [StageMode] = &[StageMode::Complementary];
    // 119 ns, as in the board's own firmware.
    const DEAD_TIME_CYCLES: u8 = 20;
    const HAS_BREAK: bool = false;

    /// The gate driver is enabled from the start.
    fn enable(&mut self) {}

    fn fault(&mut self, is_off: bool) -> Option<PowerStageFault> {
        let is_line_low = self.not_fault.is_low();
        if is_line_low {
            // The driver takes 30 us to tell the cause.
            Self::switch_off();
        }
        self.driver.fault(is_line_low, is_off)
    }

    #[inline(never)]
    fn switch_off() {
        Tim1::disable_outputs();
    }
}

/// Configures the pins, starts the counters, and the power stage with its output off.
pub fn start(
    ((pa0, pa1), (pa7, pa8, pa9, pa10), b, c, d): BenchPins,
    Blocks { pwm, motor, load, spi3: spi, .. }: Blocks,
    rcc: &mut Rcc,
) -> (MotorEncoder, LoadEncoder, ContactPins, PwmStage<Tim1, Lines>, Sensor) {
    // The gates of phase C and of M1 stay off.
    pa10.into_pull_down_input();
    b.pb15.into_pull_down_input();
    pa7.into_pull_down_input();
    b.pb0.into_pull_down_input();
    b.pb1.into_pull_down_input();
    c.pc6.into_pull_down_input();
    c.pc7.into_pull_down_input();
    c.pc8.into_pull_down_input();
    // The half-bridge of AUX.
    b.pb10.into_pull_down_input();
    b.pb11.into_pull_down_input();
    let motor_pins = (
        b.pb4.into_alternate().internal_resistor(Pull::Up),
        b.pb5.into_alternate().internal_resistor(Pull::Up),
    );
    let load_pins = (
        b.pb6.into_alternate().internal_resistor(Pull::Up),
        b.pb7.into_alternate().internal_resistor(Pull::Up),
    );
    c.pc9.into_alternate::<2>().set_internal_resistor(Pull::Up);
    let select = c.pc13.into_push_pull_output_in_state(PinState::High);
    let driver = GateDriver::new(spi, (c.pc10, c.pc11, c.pc12), select, rcc);
    c.pc14.into_push_pull_output_in_state(PinState::High);
    // The timer's outputs are open until then, and the gate drivers disabled by their pull-downs.
    let mut gate_enable = b.pb12.into_push_pull_output();
    let lines = Lines { not_fault: d.pd2.into_pull_up_input(), driver };
    let stage = PwmStage::new(Tim1::start::<Lines>(pwm, rcc), lines);
    // After the timer has its outputs off.
    let _: (PA8<Alternate<1>>, PB13<Alternate<1>>) = (pa8.into_alternate(), b.pb13.into_alternate());
    let _: (PA9<Alternate<1>>, PB14<Alternate<1>>) = (pa9.into_alternate(), b.pb14.into_alternate());
    gate_enable.set_high();
    let contacts = ContactPins([pa0.into_pull_up_input().erase(), pa1.into_pull_up_input().erase(), c.pc4.into_pull_up_input().erase(), b.pb2.into_pull_up_input().erase()]);
    (Encoder::new(motor, motor_pins, rcc), Encoder::new(load, load_pins, rcc), contacts, stage, NoSensor)
}
