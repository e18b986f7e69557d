//! The pins of the chip, as wires soldered to them.
//!
//! A timer is connected to its pins only while the image has selected its alternate function there: an image that forgets
//! one counts nothing and drives nothing, as on a board.

use std::time::Duration;

use anyhow::{Context, Result};
use rigless::device::Level;
use rigless::emulator::Host;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::tim1;
use rigless::soc::stm32f427::peripherals::gpio::{Gpio, Pin as PortPin};
use rigless::soc::stm32f427::peripherals::tim::Channel as TimerChannel;
use rigless::time::VirtualNanos;

use crate::chip::Chip;
use crate::quadrature::{Channel, Edge, Quadrature};
use crate::serial_line::SerialLine;
use crate::wiring::{Encoder, Pin, Wiring};

/// TIM1 among the advanced timers of the part.
const TIM1: usize = 0;

/// What the chip drives at the bridge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// High time of the PWM output as a fraction of its period; `None` if the output carries no pulse.
    pub duty: Option<f64>,
    /// Level of the enable output.
    pub is_enabled: bool,
    /// Main output enable, MOE: hardware and software clear it, only software sets it.
    pub has_main_output: bool,
}

impl Bridge {
    /// Duty of a bridge that drives its motor; `None` for one that is off.
    #[must_use]
    pub fn driving(&self) -> Option<f64> {
        self.duty.filter(|_| self.is_enabled)
    }
}

/// The chip at an instant between two instructions.
pub struct Pins<'a> {
    session: &'a mut Session<Chip>,
    host: &'a mut dyn Host,
    at: VirtualNanos,
    wiring: &'a Wiring,
}

impl<'a> Pins<'a> {
    pub(crate) fn new(
        session: &'a mut Session<Chip>,
        host: &'a mut dyn Host,
        at: VirtualNanos,
        wiring: &'a Wiring,
    ) -> Self {
        Self { session, host, at, wiring }
    }

    /// Device time since reset.
    #[must_use]
    pub fn now(&self) -> Duration {
        Duration::from_nanos(self.at.0)
    }

    /// The far end of USART2.
    pub fn serial_line(&mut self) -> &mut SerialLine {
        self.session.board_mut().serial_line()
    }

    /// Drives both channels of an encoder to the levels of its count.
    pub fn set_encoder(&mut self, encoder: Encoder, quadrature: Quadrature) {
        for channel in [Channel::A, Channel::B] {
            self.drive_encoder(encoder, Edge { channel, is_high: quadrature.is_high(channel) });
        }
    }

    /// Drives one channel of an encoder.
    pub fn drive_encoder(&mut self, encoder: Encoder, Edge { channel, is_high }: Edge) {
        let inputs = self.wiring.encoder(encoder);
        let (pin, number) = match channel {
            Channel::A => (inputs.a, 1),
            Channel::B => (inputs.b, 2),
        };
        let level = if is_high { Level::High } else { Level::Low };
        self.drive_pin(pin, level);
        if self.is_connected(pin) {
            let channel = TimerChannel::new(number).expect("channel 1 or 2");
            self.session.board_mut().mcu.drive_timer(self.at, inputs.timer, |timer, registers, context| {
                timer.drive_input(channel, level, registers, context);
            });
        }
    }

    /// Drives the break input: active is high.
    pub fn set_break(&mut self, is_active: bool) {
        let pin = self.wiring.break_input;
        let level = if is_active { Level::High } else { Level::Low };
        self.drive_pin(pin, level);
        if self.is_connected(pin) {
            self.session.board_mut().mcu.drive_advanced_timer(self.at, TIM1, |timer, registers, context| {
                timer.drive_break(level, registers, context);
            });
        }
    }

    /// What the chip drives at the bridge.
    pub fn bridge(&mut self) -> Bridge {
        let is_connected = self.is_connected(self.wiring.pwm);
        let Pin { port, pin, .. } = self.wiring.enable;
        let mcu = &mut self.session.board_mut().mcu;
        let (gpio, registers) = mcu.port(port);
        let is_enabled = gpio.level(port_pin(pin), registers) == Level::High;
        let (timer, registers) = mcu.advanced_timer(TIM1);
        let channel = TimerChannel::new(1).expect("channel 1");
        let pulse = timer.pulse(channel, registers).filter(|_| is_connected);
        Bridge {
            duty: pulse.map(|pulse| pulse.width.0 as f64 / pulse.period.0 as f64),
            is_enabled,
            has_main_output: tim1::bdtr::MOE.is_set(registers.get(tim1::Register::Bdtr)),
        }
    }

    /// Pins whose alternate function the image has not selected, one sentence each.
    pub fn unconnected(&mut self) -> Vec<String> {
        let wiring = self.wiring;
        let pins = wiring.alternate_pins().into_iter().filter(|pin| !self.is_connected(*pin));
        pins.map(|pin| pin.to_string()).collect()
    }

    /// A word of the chip's memory.
    ///
    /// # Errors
    /// No memory is there.
    pub fn word(&mut self, address: u64) -> Result<u32> {
        let word = self.host.read(address, Width::W32).with_context(|| format!("no memory at {address:#010x}"))?;
        Ok(word as u32)
    }

    /// Writes a word of the chip's memory.
    ///
    /// # Errors
    /// No memory is there.
    pub fn set_word(&mut self, address: u64, word: u32) -> Result<()> {
        let written = self.host.write(address, Width::W32, word.into());
        written.with_context(|| format!("no memory at {address:#010x}"))
    }

    fn drive_pin(&mut self, Pin { port, pin, .. }: Pin, level: Level) {
        self.session.board_mut().mcu.drive_port(self.at, port, |gpio, registers, context| {
            gpio.drive(port_pin(pin), Some(level), registers, context);
        });
    }

    fn is_connected(&mut self, Pin { port, pin, function }: Pin) -> bool {
        let (_, registers) = self.session.board_mut().mcu.port(port);
        function.is_none() || Gpio::function(port_pin(pin), registers) == function
    }
}

fn port_pin(pin: u8) -> PortPin {
    PortPin::new(pin).expect("a port has 16 pins")
}
