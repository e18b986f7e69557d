//! Which pin carries what: the pin map of a board.

use std::fmt;

use crate::quadrature::Channel;

/// What a pin is configured as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Connected to a block by this alternate function.
    Alternate(u8),
    /// Input of the software.
    Input,
    /// Output of the software.
    Output,
}

/// Resistor inside the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pull {
    /// None.
    Open,
    /// To the supply.
    Up,
    /// To ground.
    Down,
}

/// A pin with its configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pin {
    /// Port, from 0 for port A.
    pub port: usize,
    /// Number in the port.
    pub pin: u8,
    /// What the pin is.
    pub mode: Mode,
    /// Its resistor.
    pub pull: Pull,
}

impl Pin {
    const fn of(port: usize, pin: u8, mode: Mode, pull: Pull) -> Self {
        Self { port, pin, mode, pull }
    }

    const fn alternate(port: usize, pin: u8, function: u8) -> Self {
        Self::of(port, pin, Mode::Alternate(function), Pull::Open)
    }

    const fn pulled_down(port: usize, pin: u8, function: u8) -> Self {
        Self::of(port, pin, Mode::Alternate(function), Pull::Down)
    }

    const fn pulled_up(port: usize, pin: u8, function: u8) -> Self {
        Self::of(port, pin, Mode::Alternate(function), Pull::Up)
    }

    const fn output(port: usize, pin: u8) -> Self {
        Self::of(port, pin, Mode::Output, Pull::Open)
    }

    const fn unused_gate(port: usize, pin: u8) -> Self {
        Self::of(port, pin, Mode::Input, Pull::Down)
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let port = char::from(b'A' + self.port as u8);
        write!(out, "P{port}{} as ", self.pin)?;
        match self.mode {
            Mode::Alternate(function) => write!(out, "alternate function {function}")?,
            Mode::Input => out.write_str("an input")?,
            Mode::Output => out.write_str("an output")?,
        }
        out.write_str(match self.pull {
            Pull::Open => "",
            Pull::Up => " with a pull-up",
            Pull::Down => " with a pull-down",
        })
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

/// An output of TIM1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TimerOutput {
    /// The channel, from 1.
    pub(crate) channel: u8,
    /// Whether it is the channel's complement.
    pub(crate) is_complementary: bool,
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
    /// The serial port of the link among those of the part, from 0 for USART1.
    pub link_port: usize,
    /// Output and input of the link.
    pub link: [Pin; 2],
    /// PWM output, channel 1 of TIM1.
    pub pwm: Pin,
    /// Break input of TIM1, if it is connected.
    pub break_input: Option<Pin>,
    /// Fault output of a gate driver, active low, at a plain input.
    pub fault_line: Option<Pin>,
    /// Enable output of the bridge, active high.
    pub enable: Pin,
    /// Outputs of channels with their complements: the channel of TIM1, its output or high side, its complement or low side.
    pub half_bridges: &'static [(u8, Pin, Pin)],
    /// Outputs that stay high.
    pub high: &'static [Pin],
    /// Gates that stay off.
    pub unused_gates: &'static [Pin],
    /// Pins of a serial interface.
    pub spi: &'static [Pin],
    /// Whether a gate driver is at SPI3, selected by PC13.
    pub has_gate_driver: bool,
}

const A: usize = 0;
const B: usize = 1;
const C: usize = 2;
const D: usize = 3;
const E: usize = 4;
const USART2: usize = 1;
const USART3: usize = 2;
/// PA2 and PA3, of USART2.
const LINK: [Pin; 2] = [Pin::alternate(A, 2, 7), Pin::pulled_up(A, 3, 7)];

impl Wiring {
    /// The boards, by the names that their drives report.
    pub const BOARDS: [(&'static str, Self); 4] = [
        ("stm32f405", Self::F405_BARE),
        ("odrive-v3", Self::ODRIVE_V3),
        ("nucleo-f429zi", Self::NUCLEO_F429ZI),
        // Its headers have the pins of the bare board.
        ("nucleo-f446re", Self::F405_BARE),
    ];

    /// The bare STM32F405 board of `docs/hardware/bare-stm32f405.md`. Alternate functions are those of the data sheet, table 9.
    pub const F405_BARE: Self = Self {
        motor: EncoderInputs { timer: 1, a: Pin::pulled_up(C, 6, 2), b: Pin::pulled_up(C, 7, 2) },
        load: EncoderInputs { timer: 2, a: Pin::pulled_up(B, 6, 2), b: Pin::pulled_up(B, 7, 2) },
        link_port: USART2,
        link: LINK,
        pwm: Pin::pulled_down(A, 8, 1),
        break_input: Some(Pin::pulled_up(B, 12, 1)),
        fault_line: None,
        enable: Pin::output(B, 0),
        half_bridges: &[
            (1, Pin::pulled_down(A, 8, 1), Pin::pulled_down(B, 13, 1)),
            (2, Pin::pulled_down(A, 9, 1), Pin::pulled_down(B, 14, 1)),
        ],
        high: &[],
        unused_gates: &[],
        spi: &[],
        has_gate_driver: false,
    };
    /// A NUCLEO-F429ZI: pins of its Zio connectors, and the serial port of its ST-Link (ST UM1974).
    pub const NUCLEO_F429ZI: Self = Self {
        load: EncoderInputs { timer: 2, a: Pin::pulled_up(D, 12, 2), b: Pin::pulled_up(D, 13, 2) },
        link_port: USART3,
        link: [Pin::alternate(D, 8, 7), Pin::pulled_up(D, 9, 7)],
        pwm: Pin::pulled_down(E, 9, 1),
        break_input: Some(Pin::pulled_up(E, 15, 1)),
        enable: Pin::output(E, 7),
        half_bridges: &[
            (1, Pin::pulled_down(E, 9, 1), Pin::pulled_down(E, 8, 1)),
            (2, Pin::pulled_down(E, 11, 1), Pin::pulled_down(E, 10, 1)),
        ],
        ..Self::F405_BARE
    };
    /// An ODrive v3.5 or v3.6, phases A and B of M0, after the pin names of the board's own firmware.
    pub const ODRIVE_V3: Self = Self {
        motor: EncoderInputs { timer: 1, a: Pin::pulled_up(B, 4, 2), b: Pin::pulled_up(B, 5, 2) },
        load: EncoderInputs { timer: 2, a: Pin::pulled_up(B, 6, 2), b: Pin::pulled_up(B, 7, 2) },
        link_port: USART2,
        link: LINK,
        pwm: Pin::alternate(A, 8, 1),
        break_input: None,
        fault_line: Some(Pin::of(D, 2, Mode::Input, Pull::Up)),
        enable: Pin::output(B, 12),
        half_bridges: &[
            (1, Pin::alternate(A, 8, 1), Pin::alternate(B, 13, 1)),
            (2, Pin::alternate(A, 9, 1), Pin::alternate(B, 14, 1)),
        ],
        high: &[Pin::output(C, 13), Pin::output(C, 14)],
        unused_gates: &[
            Pin::unused_gate(A, 10),
            Pin::unused_gate(B, 15),
            Pin::unused_gate(A, 7),
            Pin::unused_gate(B, 0),
            Pin::unused_gate(B, 1),
            Pin::unused_gate(C, 6),
            Pin::unused_gate(C, 7),
            Pin::unused_gate(C, 8),
            Pin::unused_gate(B, 10),
            Pin::unused_gate(B, 11),
        ],
        spi: &[Pin::alternate(C, 10, 6), Pin::pulled_up(C, 11, 6), Pin::alternate(C, 12, 6)],
        has_gate_driver: true,
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

    /// All outputs that let a switch conduct, each with its output of TIM1; gates that stay off have none.
    pub(crate) fn gates(&self) -> impl Iterator<Item = (Pin, Option<TimerOutput>)> + use<> {
        let output = |channel, is_complementary| Some(TimerOutput { channel, is_complementary });
        let half_bridges = self.half_bridges.iter();
        let both = half_bridges.flat_map(move |(channel, high, low)| {
            [(*high, output(*channel, false)), (*low, output(*channel, true))]
        });
        [(self.pwm, output(1, false))]
            .into_iter()
            .chain(both)
            .chain(self.unused_gates.iter().map(|pin| (*pin, None)))
    }

    /// The inputs of an encoder.
    #[must_use]
    pub fn encoder(&self, encoder: Encoder) -> &EncoderInputs {
        match encoder {
            Encoder::Motor => &self.motor,
            Encoder::Load => &self.load,
        }
    }

    /// All pins with a use.
    #[must_use]
    pub fn pins(&self) -> Vec<Pin> {
        let gates = self.half_bridges.iter().flat_map(|(_, high, low)| [*high, *low]);
        let inputs = self.inputs().map(|(pin, _)| pin).chain(self.fault_line);
        let outputs = [self.pwm, self.enable].into_iter().chain(self.high.iter().copied());
        let unused = self.unused_gates.iter().copied();
        let spi = self.spi.iter().copied();
        self.link.into_iter().chain(inputs).chain(outputs).chain(gates).chain(unused).chain(spi).collect()
    }
}
