//! From the wires to the timers: which level each timer input has.
//!
//! The models take the level of a timer's input from outside, independent of the configuration of the pin. Here a timer sees its pin
//! only while the image has selected the alternate function, and an open pin has the level of its pull resistor.

use rigless::device::Level;
use rigless::time::VirtualNanos;

use crate::chip::Chip;
use crate::part::channel_of;
use crate::wiring::{Mode, Pin, Pull, TimerInput, Wiring};

/// Registers of a port, by their offsets. AFRH follows AFRL.
const MODER: u64 = 0x00;
const PUPDR: u64 = 0x0c;
const IDR: u64 = 0x10;
const AFRL: u64 = 0x20;
/// From the first port on: the ports and the block that can reset them, RCC, in both families.
const PORTS_AND_CLOCKS: u64 = 0x4800;

/// What the timers have been given.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Inputs {
    inputs: [Input; Wiring::INPUTS],
    /// Whether the outputs of TIM1 are connected to their pins: those of channels 1 and 2.
    outputs: [bool; 2],
    /// Whether the image has written nothing to the ports since.
    is_settled: bool,
}

/// One input of a timer.
#[derive(Debug, Clone, Copy, Default)]
struct Input {
    is_connected: bool,
    /// Its level; `None` after a reset.
    level: Option<Level>,
}

impl Inputs {
    /// The image has written to a register: to one of a port, it may have connected a pin, or changed its resistor.
    pub(crate) fn note_write(&mut self, ports: u64, address: u64) {
        self.is_settled &= address.wrapping_sub(ports) >= PORTS_AND_CLOCKS;
    }

    /// Whether the outputs of channels 1 and 2 of TIM1 are connected to their pins.
    pub(crate) fn outputs(&mut self, chip: &mut Chip, wiring: &Wiring, at: VirtualNanos) -> [bool; 2] {
        self.settle(chip, wiring, at);
        self.outputs
    }

    /// Gives the timers the levels of their pins at an instant, if the image may have changed them.
    pub(crate) fn settle(&mut self, chip: &mut Chip, wiring: &Wiring, at: VirtualNanos) {
        if std::mem::replace(&mut self.is_settled, true) {
            return;
        }
        for ((pin, timer), input) in wiring.inputs().zip(&mut self.inputs) {
            input.is_connected = is_connected(chip, pin);
            let level = Level::from(is_high(chip, pin));
            input.take(level, chip, timer, at);
        }
        self.outputs = wiring.bridge.outputs.map(|pin| is_connected(chip, pin));
    }

    /// Gives a timer the level to which the board drives its pin; `None` for a pin that it has released.
    pub(crate) fn follow(
        &mut self,
        chip: &mut Chip,
        wiring: &Wiring,
        (driven, level): (Pin, Option<Level>),
        at: VirtualNanos,
    ) {
        self.settle(chip, wiring, at);
        for ((pin, timer), input) in wiring.inputs().zip(&mut self.inputs) {
            if pin == driven {
                let level = level.unwrap_or_else(|| Level::from(is_high(chip, pin)));
                input.take(level, chip, timer, at);
            }
        }
    }
}

impl Input {
    fn take(&mut self, level: Level, chip: &mut Chip, timer: TimerInput, at: VirtualNanos) {
        if !self.is_connected || self.level.replace(level) == Some(level) {
            return;
        }
        match timer {
            TimerInput::Channel { timer, channel } => {
                chip.part.drive_timer(at, timer, channel_of(channel), level);
            }
            TimerInput::Break => chip.part.drive_break(at, level),
        }
    }
}

/// Level of a pin.
pub(crate) fn is_high(chip: &mut Chip, pin: Pin) -> bool {
    chip.port_register(pin, IDR) >> pin.pin & 1 == 1
}

/// Whether the image has selected the alternate function of a pin; true for a pin without one.
pub(crate) fn is_connected(chip: &mut Chip, pin: Pin) -> bool {
    let Mode::Alternate(function) = pin.mode else { return true };
    let selected = chip.port_register(pin, AFRL + u64::from(pin.pin / 8 * 4)) >> (4 * (pin.pin % 8)) & 0b1111;
    two_bits(chip, pin, MODER) == 0b10 && selected == u64::from(function)
}

/// Whether the registers of the port have the mode and the resistor of a pin.
pub(crate) fn is_configured(chip: &mut Chip, pin: Pin) -> bool {
    let mode = match pin.mode {
        Mode::Input => 0b00,
        Mode::Output => 0b01,
        Mode::Alternate(_) => 0b10,
        Mode::Analog => 0b11,
    };
    let pull = match pin.pull {
        Pull::Open => 0b00,
        Pull::Up => 0b01,
        Pull::Down => 0b10,
    };
    [MODER, PUPDR].map(|register| two_bits(chip, pin, register)) == [mode, pull] && is_connected(chip, pin)
}

/// The bits of a pin in a register that has two for each.
fn two_bits(chip: &mut Chip, pin: Pin, register: u64) -> u64 {
    chip.port_register(pin, register) >> (2 * pin.pin) & 0b11
}
