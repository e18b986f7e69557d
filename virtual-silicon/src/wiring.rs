//! Which pin carries what: the pin map of a board, as its file has it.

use std::fmt;

use serde::Deserialize;

pub use crate::blocks::{SerialInterface, SerialPort, Timer};
use crate::quadrature::Channel;

/// A family of chips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// STM32F405, F429 and F446, with the models of an STM32F427.
    Stm32f4,
    /// STM32H743.
    Stm32h7,
}

/// What a pin is configured as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Connected to a block by this alternate function.
    Alternate(u8),
    /// Input of the software.
    Input,
    /// Output of the software.
    Output,
    /// Input of a converter.
    Analog,
}

impl Mode {
    /// The kind of pin, as messages name it.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::Alternate(_) => "an alternate function",
            Self::Input => "an input",
            Self::Output => "an output",
            Self::Analog => "analog",
        }
    }
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
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

/// A text that isn't a pin.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} isn't a pin: write PA0 to PK15, then input, output, analog or AF0 to AF15, then pull-up, pull-down or nothing"
)]
pub struct WrongPin(String);

impl TryFrom<String> for Pin {
    type Error = WrongPin;

    fn try_from(text: String) -> Result<Self, WrongPin> {
        read_pin(&text).ok_or(WrongPin(text))
    }
}

fn read_pin(text: &str) -> Option<Pin> {
    let number = |text: &str| (0..16).find(|number| number.to_string() == text);
    let words: Vec<_> = text.split(' ').collect();
    let [name, mode, pull @ ..] = &words[..] else { return None };
    let (port, pin) = name.strip_prefix('P')?.split_at_checked(1)?;
    let mode = match *mode {
        "input" => Mode::Input,
        "output" => Mode::Output,
        "analog" => Mode::Analog,
        function => Mode::Alternate(number(function.strip_prefix("AF")?)?),
    };
    let pull = match pull {
        [] => Pull::Open,
        ["pull-up"] => Pull::Up,
        ["pull-down"] => Pull::Down,
        _ => return None,
    };
    Some(Pin { port: "ABCDEFGHIJK".find(port)?, pin: number(pin)?, mode, pull })
}

impl Pin {
    /// The pin without its configuration, as data sheets name it.
    pub(crate) fn name(&self) -> String {
        format!("P{}{}", char::from(b'A' + self.port as u8), self.pin)
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} as ", self.name())?;
        match self.mode {
            Mode::Alternate(function) => write!(out, "alternate function {function}")?,
            mode => out.write_str(mode.kind())?,
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
        /// The timer.
        timer: Timer,
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

/// The serial port of the link, with its pins.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkPins {
    /// The port.
    pub port: SerialPort,
    /// Output of the chip.
    pub output: Pin,
    /// Input of the chip.
    pub input: Pin,
}

/// The inputs of an encoder: channels 1 and 2 of a timer.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderPins {
    /// The timer.
    pub timer: Timer,
    /// Channel A, at the timer's channel 1.
    pub a: Pin,
    /// Channel B, at the timer's channel 2.
    pub b: Pin,
    /// Index, with its channel of the timer, 3 or 4; a board may lack it.
    pub index: Option<IndexPin>,
}

/// The index input of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndexPin {
    /// The pin.
    pub pin: Pin,
    /// The channel of the encoder's timer that it leads to.
    pub channel: u8,
}

impl EncoderPins {
    /// The pin of a channel.
    #[must_use]
    pub fn pin(&self, channel: Channel) -> Pin {
        match channel {
            Channel::A => self.a,
            Channel::B => self.b,
        }
    }
}

/// The lines of the power stage.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgePins {
    /// Outputs of channels 1 and 2 of TIM1: PWM outputs or high sides.
    pub outputs: [Pin; 2],
    /// Their complements: low sides.
    pub complements: [Pin; 2],
    /// Break input of TIM1, if it is connected.
    pub break_input: Option<Pin>,
    /// Enable output, active high.
    pub enable: Pin,
    /// Sensor of the motor's current; a board may have none.
    pub current: Option<Pin>,
    /// Voltage of the bus, divided.
    pub bus: Option<Pin>,
    /// Switch of a brake resistor; a board may have none.
    pub brake: Option<Pin>,
    /// Gates that stay off.
    #[serde(default)]
    pub unused_gates: Vec<Pin>,
}

/// Inputs for contacts to ground.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactPins {
    /// Enable contact.
    pub enable: Pin,
    /// Limit switch towards negative positions.
    pub negative_limit: Pin,
    /// Limit switch towards positive positions.
    pub positive_limit: Pin,
    /// Home switch.
    pub home: Pin,
}

/// A gate driver at a serial interface.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GateDriverPins {
    /// The interface.
    pub port: SerialInterface,
    /// Select output, active low.
    pub select: Pin,
    /// Clock output.
    pub clock: Pin,
    /// Data input of the chip.
    pub input: Pin,
    /// Data output of the chip.
    pub output: Pin,
    /// Fault output of the gate driver, active low, at a plain input.
    pub fault_line: Pin,
}

/// The pin map of a board.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wiring {
    /// Family of the chip.
    pub chip: Family,
    /// Outputs that stay high.
    #[serde(default)]
    pub high: Vec<Pin>,
    /// The link.
    pub link: LinkPins,
    /// The encoder at the motor.
    pub motor: EncoderPins,
    /// The encoder at the load.
    pub load: EncoderPins,
    /// The power stage.
    pub bridge: BridgePins,
    /// Inputs for contacts.
    pub contacts: ContactPins,
    /// The gate driver; a board may have none.
    pub gate_driver: Option<GateDriverPins>,
}

impl Wiring {
    /// Most inputs.
    pub(crate) const INPUTS: usize = 7;

    /// All inputs with their pins.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = (Pin, TimerInput)> + use<> {
        let channel = |timer, channel| TimerInput::Channel { timer, channel };
        let encoders = [
            (self.motor.a, channel(self.motor.timer, 1)),
            (self.motor.b, channel(self.motor.timer, 2)),
            (self.load.a, channel(self.load.timer, 1)),
            (self.load.b, channel(self.load.timer, 2)),
        ];
        let index = |it: &EncoderPins| {
            let timer = it.timer;
            it.index.map(|index| (index.pin, channel(timer, index.channel)))
        };
        let indices = index(&self.motor).into_iter().chain(index(&self.load));
        encoders.into_iter().chain(indices).chain(self.bridge.break_input.map(|pin| (pin, TimerInput::Break)))
    }

    /// Both half-bridges: the output of TIM1 with its complement.
    pub(crate) fn half_bridges(&self) -> impl Iterator<Item = [(Pin, TimerOutput); 2]> + use<> {
        let BridgePins { outputs: [first, second], complements: [low, other_low], .. } = self.bridge;
        [(1, first, low), (2, second, other_low)].into_iter().map(|(channel, high, low)| {
            let output = |is_complementary| TimerOutput { channel, is_complementary };
            [(high, output(false)), (low, output(true))]
        })
    }

    /// The inputs of an encoder.
    #[must_use]
    pub fn encoder(&self, encoder: Encoder) -> &EncoderPins {
        match encoder {
            Encoder::Motor => &self.motor,
            Encoder::Load => &self.load,
        }
    }

    /// All pins with a use: the key of the file, the pin, and the kind of pin that the use needs.
    pub(crate) fn uses(&self) -> Vec<(&'static str, Pin, &'static str)> {
        const ALTERNATE: Mode = Mode::Alternate(0);
        let bridge = &self.bridge;
        let mut uses = vec![
            ("link.output", self.link.output, ALTERNATE),
            ("link.input", self.link.input, ALTERNATE),
            ("motor.a", self.motor.a, ALTERNATE),
            ("motor.b", self.motor.b, ALTERNATE),
            ("load.a", self.load.a, ALTERNATE),
            ("load.b", self.load.b, ALTERNATE),
            ("bridge.enable", bridge.enable, Mode::Output),
            ("contacts.enable", self.contacts.enable, Mode::Input),
            ("contacts.negative_limit", self.contacts.negative_limit, Mode::Input),
            ("contacts.positive_limit", self.contacts.positive_limit, Mode::Input),
            ("contacts.home", self.contacts.home, Mode::Input),
        ];
        uses.extend(self.motor.index.map(|index| ("motor.index", index.pin, ALTERNATE)));
        uses.extend(self.load.index.map(|index| ("load.index", index.pin, ALTERNATE)));
        uses.extend(bridge.outputs.map(|pin| ("bridge.outputs", pin, ALTERNATE)));
        uses.extend(bridge.complements.map(|pin| ("bridge.complements", pin, ALTERNATE)));
        uses.extend(bridge.current.map(|pin| ("bridge.current", pin, Mode::Analog)));
        uses.extend(bridge.bus.map(|pin| ("bridge.bus", pin, Mode::Analog)));
        uses.extend(bridge.brake.map(|pin| ("bridge.brake", pin, Mode::Output)));
        uses.extend(bridge.break_input.map(|pin| ("bridge.break_input", pin, ALTERNATE)));
        uses.extend(bridge.unused_gates.iter().map(|pin| ("bridge.unused_gates", *pin, Mode::Input)));
        uses.extend(self.high.iter().map(|pin| ("high", *pin, Mode::Output)));
        if let Some(driver) = &self.gate_driver {
            uses.extend([
                ("gate_driver.select", driver.select, Mode::Output),
                ("gate_driver.clock", driver.clock, ALTERNATE),
                ("gate_driver.input", driver.input, ALTERNATE),
                ("gate_driver.output", driver.output, ALTERNATE),
                ("gate_driver.fault_line", driver.fault_line, Mode::Input),
            ]);
        }
        uses.into_iter().map(|(key, pin, mode)| (key, pin, mode.kind())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pin_is_a_name_a_mode_and_a_resistor() {
        let read = |text: &str| Pin::try_from(text.to_owned());
        let pin = Pin { port: 2, pin: 6, mode: Mode::Alternate(2), pull: Pull::Up };
        assert_eq!(read("PC6 AF2 pull-up"), Ok(pin));
        assert_eq!(read("PK15 output").map(|pin| pin.to_string()), Ok("PK15 as an output".into()));
        for wrong in ["", "PC6", "C6 AF2", "PL0 input", "PC16 input", "PC06 input", "PC+6 input", "Pé1 input"]
        {
            assert_eq!(read(wrong), Err(WrongPin(wrong.to_owned())));
        }
        for wrong in ["PC6 AF16", "PC6 analogue", "PC6 AF2 up", "PC6 AF2 pull-up pull-up", "PC6  AF2", "P"] {
            assert_eq!(read(wrong), Err(WrongPin(wrong.to_owned())));
        }
    }
}
