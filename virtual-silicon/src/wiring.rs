//! Which pin carries what: the pin map of a board.

use std::fmt;

use crate::quadrature::Channel;

/// A pin, and the alternate function that connects it to its block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pin {
    /// Port, from 0 for port A.
    pub port: usize,
    /// Number in the port.
    pub pin: u8,
    /// Alternate function; `None` for a plain output.
    pub function: Option<u8>,
}

impl Pin {
    const fn alternate(port: usize, pin: u8, function: u8) -> Self {
        Self { port, pin, function: Some(function) }
    }

    const fn plain(port: usize, pin: u8) -> Self {
        Self { port, pin, function: None }
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let port = char::from(b'A' + self.port as u8);
        match self.function {
            Some(function) => write!(out, "P{port}{} as alternate function {function}", self.pin),
            None => write!(out, "P{port}{} as an output", self.pin),
        }
    }
}

/// One of the two encoders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoder {
    /// At the motor.
    Motor,
    /// At the load.
    Load,
}

/// An input of a timer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimerInput {
    /// A channel of a general-purpose timer.
    Channel {
        /// The timer, from 0 for TIM2.
        timer: usize,
        /// The channel, from 1.
        channel: u8,
    },
    /// The break input of TIM1.
    Break,
}

/// The inputs of an encoder: channels 1 and 2 of a timer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EncoderInputs {
    /// The timer, from 0 for TIM2.
    pub timer: usize,
    /// Channel A, at the timer's channel 1.
    pub a: Pin,
    /// Channel B, at the timer's channel 2.
    pub b: Pin,
}

impl EncoderInputs {
    /// The pin of a channel.
    #[must_use]
    pub fn pin(&self, channel: Channel) -> Pin {
        match channel {
            Channel::A => self.a,
            Channel::B => self.b,
        }
    }
}

/// The pin map of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wiring {
    /// The encoder at the motor.
    pub motor: EncoderInputs,
    /// The encoder at the load.
    pub load: EncoderInputs,
    /// PWM output, channel 1 of TIM1.
    pub pwm: Pin,
    /// Break input of TIM1, if it is connected.
    pub break_input: Option<Pin>,
    /// Fault output of a gate driver, active low, at a plain input.
    pub fault_line: Option<Pin>,
    /// Enable output of the bridge, active high.
    pub enable: Pin,
    /// Gates of half-bridges: the channel of TIM1, high side, low side.
    pub half_bridges: &'static [(u8, Pin, Pin)],
    /// Outputs that stay high.
    pub high: &'static [Pin],
    /// Gates that stay off: inputs with pull-downs.
    pub unused_gates: &'static [Pin],
}

const A: usize = 0;
const B: usize = 1;
const C: usize = 2;
const D: usize = 3;

impl Wiring {
    /// The boards, by the names that their drives report.
    pub const BOARDS: [(&'static str, Self); 2] =
        [("stm32f405", Self::F405_BARE), ("odrive-v3", Self::ODRIVE_V3)];

    /// The bare STM32F405 board of `docs/bench-drive.md`. Alternate functions are those of the data sheet, table 9.
    pub const F405_BARE: Self = Self {
        motor: EncoderInputs { timer: 1, a: Pin::alternate(C, 6, 2), b: Pin::alternate(C, 7, 2) },
        load: EncoderInputs { timer: 2, a: Pin::alternate(B, 6, 2), b: Pin::alternate(B, 7, 2) },
        pwm: Pin::alternate(A, 8, 1),
        break_input: Some(Pin::alternate(B, 12, 1)),
        fault_line: None,
        enable: Pin::plain(B, 0),
        half_bridges: &[],
        high: &[],
        unused_gates: &[],
    };
    /// An ODrive v3.5 or v3.6, phases A and B of M0, after the pin names of the board's own firmware.
    pub const ODRIVE_V3: Self = Self {
        motor: EncoderInputs { timer: 1, a: Pin::alternate(B, 4, 2), b: Pin::alternate(B, 5, 2) },
        load: EncoderInputs { timer: 2, a: Pin::alternate(B, 6, 2), b: Pin::alternate(B, 7, 2) },
        pwm: Pin::alternate(A, 8, 1),
        break_input: None,
        fault_line: Some(Pin::plain(D, 2)),
        enable: Pin::plain(B, 12),
        half_bridges: &[
            (1, Pin::alternate(A, 8, 1), Pin::alternate(B, 13, 1)),
            (2, Pin::alternate(A, 9, 1), Pin::alternate(B, 14, 1)),
        ],
        high: &[Pin::plain(C, 13), Pin::plain(C, 14)],
        unused_gates: &[
            Pin::plain(A, 10),
            Pin::plain(B, 15),
            Pin::plain(A, 7),
            Pin::plain(B, 0),
            Pin::plain(B, 1),
            Pin::plain(C, 6),
            Pin::plain(C, 7),
            Pin::plain(C, 8),
            Pin::plain(B, 10),
            Pin::plain(B, 11),
        ],
    };

    /// The board of this name.
    #[must_use]
    pub fn of_board(name: &str) -> Option<Self> {
        Self::BOARDS.iter().find(|(board, _)| *board == name).map(|(_, wiring)| *wiring)
    }

    /// Most inputs.
    pub(crate) const INPUTS: usize = 5;

    /// All inputs with their pins.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = (Pin, TimerInput)> + use<> {
        let channel = |timer, channel| TimerInput::Channel { timer, channel };
        let encoders: [_; Self::INPUTS - 1] = [
            (self.motor.a, channel(self.motor.timer, 1)),
            (self.motor.b, channel(self.motor.timer, 2)),
            (self.load.a, channel(self.load.timer, 1)),
            (self.load.b, channel(self.load.timer, 2)),
        ];
        encoders.into_iter().chain(self.break_input.map(|pin| (pin, TimerInput::Break)))
    }

    /// The inputs of an encoder.
    #[must_use]
    pub fn encoder(&self, encoder: Encoder) -> &EncoderInputs {
        match encoder {
            Encoder::Motor => &self.motor,
            Encoder::Load => &self.load,
        }
    }

    /// All pins that a timer uses.
    #[must_use]
    pub fn alternate_pins(&self) -> Vec<Pin> {
        let gates = self.half_bridges.iter().flat_map(|(_, high, low)| [*high, *low]);
        self.inputs().map(|(pin, _)| pin).chain([self.pwm]).chain(gates).collect()
    }
}
