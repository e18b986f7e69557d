//! From the wires to the timers: which level each timer input has.
//!
//! The models take the level of a timer's input from outside, independent of the configuration of the pin. Here a timer sees its pin
//! only while the image has selected the alternate function, and an open pin has the level of its pull resistor.

use rigless::device::Level;
use rigless::soc::stm32f427::generated::gpioa;
use rigless::soc::stm32f427::peripherals::gpio::{Gpio, Pin as PortPin};
use rigless::soc::stm32f427::peripherals::tim::Channel as TimerChannel;
use rigless::time::VirtualNanos;

use crate::chip::{Chip, TIM1};
use crate::wiring::{Mode, Pin, Pull, TimerInput, Wiring};

/// The levels that the timers have been given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inputs([Level; Wiring::INPUTS]);

impl Default for Inputs {
    /// After a reset every input of the models rests low.
    fn default() -> Self {
        Self([Level::Low; Wiring::INPUTS])
    }
}

impl Inputs {
    /// Gives the timers the levels of their pins at an instant.
    pub(crate) fn settle(&mut self, chip: &mut Chip, wiring: &Wiring, at: VirtualNanos) {
        for ((pin, input), known) in wiring.inputs().zip(&mut self.0) {
            if !is_connected(chip, pin) {
                continue;
            }
            let (gpio, registers) = chip.mcu.port(pin.port);
            let level = gpio.level(port_pin(pin), registers);
            if std::mem::replace(known, level) == level {
                continue;
            }
            match input {
                TimerInput::Channel { timer, channel } => {
                    let channel = TimerChannel::new(channel).expect("a timer has channels 1 to 4");
                    chip.mcu.drive_timer(at, timer, |timer, registers, context| {
                        timer.drive_input(channel, level, registers, context);
                    });
                }
                TimerInput::Break => {
                    chip.mcu.drive_advanced_timer(at, TIM1, |timer, registers, context| {
                        timer.drive_break(level, registers, context);
                    });
                }
            }
        }
    }
}

/// Whether the image has selected the alternate function of a pin; true for a pin without one.
pub(crate) fn is_connected(chip: &mut Chip, pin: Pin) -> bool {
    let Mode::Alternate(function) = pin.mode else { return true };
    let (_, registers) = chip.mcu.port(pin.port);
    Gpio::function(port_pin(pin), registers) == Some(function)
}

/// Whether the registers of the port have the mode and the resistor of a pin.
pub(crate) fn is_configured(chip: &mut Chip, pin: Pin) -> bool {
    let (_, registers) = chip.mcu.port(pin.port);
    let bits = |register| registers.get(register) >> (2 * pin.pin) & 0b11;
    let mode = match pin.mode {
        Mode::Input => 0b00,
        Mode::Output => 0b01,
        Mode::Alternate(_) => 0b10,
    };
    let pull = match pin.pull {
        Pull::Open => 0b00,
        Pull::Up => 0b01,
        Pull::Down => 0b10,
    };
    let have = [bits(gpioa::Register::Moder), bits(gpioa::Register::Pupdr)];
    have == [mode, pull] && is_connected(chip, pin)
}

pub(crate) fn port_pin(pin: Pin) -> PortPin {
    PortPin::new(pin.pin).expect("a port has 16 pins")
}
