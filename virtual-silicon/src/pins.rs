//! The pins of the chip, as wires soldered to them.
//!
//! A timer is connected to its pins only while the image has selected its alternate function there: an image that forgets
//! one counts nothing and drives nothing, as on a board.

use std::time::Duration;

use anyhow::{Context, Result, ensure};
use rigless::device::Level;
use rigless::edge::Pulse;
use rigless::emulator::{Host, Watch};
use rigless::mcu::Mcu;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::{dbg, rcc, tim1};
use rigless::soc::stm32f427::peripherals::tim::Channel as TimerChannel;
use rigless::time::VirtualNanos;

use crate::chip::{Chip, TIM1};
use crate::gate_driver::GateDriver;
use crate::inputs::{Inputs, is_configured, is_connected, port_pin};
use crate::quadrature::{Channel, Edge, Quadrature};
use crate::serial_line::SerialLine;
use crate::wiring::{Encoder, Pin, TimerOutput, Wiring};

/// What the chip drives at the bridge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// High time of the PWM output as a fraction of its period; `None` if the output carries no pulse.
    pub duty: Option<f64>,
    /// High times of the outputs of channels 1 and 2, 0 or 1 for a level; `None` for one that its timer doesn't drive.
    pub channels: [Option<f64>; 2],
    /// Level of the enable output.
    pub is_enabled: bool,
    /// Main output enable, MOE: hardware and software clear it, only software sets it.
    pub has_main_output: bool,
    /// Whether any gate or pulse output carries a pulse or is high.
    pub has_active_gate: bool,
}

impl Bridge {
    /// Whether any switch of the bridge may conduct.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.is_enabled && self.has_active_gate
    }

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
    inputs: &'a mut Inputs,
}

impl<'a> Pins<'a> {
    pub(crate) fn new(
        session: &'a mut Session<Chip>,
        host: &'a mut dyn Host,
        at: VirtualNanos,
        wiring: &'a Wiring,
        inputs: &'a mut Inputs,
    ) -> Self {
        Self { session, host, at, wiring, inputs }
    }

    /// Device time since reset.
    #[must_use]
    pub fn now(&self) -> Duration {
        Duration::from_nanos(self.at.0)
    }

    /// The far end of the link.
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
        self.drive_pin(self.wiring.encoder(encoder).pin(channel), Some(is_high));
    }

    /// Cuts the wire of one channel of an encoder.
    pub fn open_encoder(&mut self, encoder: Encoder, channel: Channel) {
        self.drive_pin(self.wiring.encoder(encoder).pin(channel), None);
    }

    /// Drives the break input high or low, or cuts its wire with `None`. A board may have none.
    pub fn drive_break(&mut self, is_high: Option<bool>) {
        if let Some(pin) = self.wiring.break_input {
            self.drive_pin(pin, is_high);
        }
    }

    /// Stops the crystal.
    pub fn stop_crystal(&mut self) {
        let chip = self.session.board_mut();
        chip.mcu.drive_clocks(self.at, |rcc, registers, context| rcc.fail_hse(registers, context));
    }

    /// Whether the clock tree runs from the oscillator inside the chip, with the crystal off.
    pub fn clocks_are_internal(&mut self) -> bool {
        let clocks = Mcu::bus(&self.session.board_mut().mcu).registers("RCC").expect("the part has it");
        !rcc::cr::HSEON.is_set(clocks.get(rcc::Register::Cr))
            && rcc::pllcfgr::PLLSRC.get(clocks.get(rcc::Register::Pllcfgr)) == 0
    }

    /// What a core that a debugger halts does not stop: the independent watchdog, and what it stops: TIM1.
    pub fn halted_by_debugger(&mut self) -> (bool, bool) {
        let debug = Mcu::bus(&self.session.board_mut().mcu).registers("DBG").expect("the part has it");
        let is_set = |register, bit: u32| debug.get(register) >> bit & 1 == 1;
        (!is_set(dbg::Register::DbgmcuApb1Fz, 12), is_set(dbg::Register::DbgmcuApb2Fz, 0))
    }

    /// The gate driver; a board may have none.
    pub fn gate_driver(&mut self) -> Option<&mut GateDriver> {
        self.session.board_mut().gate_driver()
    }

    /// Drives the fault line of the gate driver high or low. A board may have none.
    pub fn drive_fault_line(&mut self, is_high: bool) {
        if let Some(pin) = self.wiring.fault_line {
            self.drive_pin(pin, Some(is_high));
        }
    }

    /// High times of both gates of each half-bridge as fractions of the period; `None` for a gate without a pulse.
    pub fn half_bridges(&mut self) -> Vec<(Option<f64>, Option<f64>)> {
        let gates = self.wiring.half_bridges.iter();
        gates.map(|(channel, high, low)| self.half_bridge(*channel, *high, *low)).collect()
    }

    fn half_bridge(&mut self, channel: u8, high: Pin, low: Pin) -> (Option<f64>, Option<f64>) {
        let chip = self.session.board_mut();
        let are_connected = (is_connected(chip, high), is_connected(chip, low));
        let (timer, registers) = chip.mcu.advanced_timer(TIM1);
        let channel = TimerChannel::new(channel).expect("a timer has channels 1 to 4");
        let pulses = (timer.pulse(channel, registers), timer.complementary_pulse(channel, registers));
        let duty = |pulse: Pulse| pulse.width.0 as f64 / pulse.period.0 as f64;
        (pulses.0.filter(|_| are_connected.0).map(duty), pulses.1.filter(|_| are_connected.1).map(duty))
    }

    /// Period of the modulation; `None` if its output carries no pulse.
    pub fn modulation_period(&mut self) -> Option<Duration> {
        let (timer, registers) = self.session.board_mut().mcu.advanced_timer(TIM1);
        let pulse = timer.pulse(TimerChannel::new(1).expect("channel 1"), registers)?;
        Some(Duration::from_nanos(pulse.period.0))
    }

    /// Level of a pin.
    pub fn is_high(&mut self, pin: Pin) -> bool {
        let (gpio, registers) = self.session.board_mut().mcu.port(pin.port);
        gpio.level(port_pin(pin), registers) == Level::High
    }

    /// Duty of a bridge that drives its motor, as [`Bridge::driving`], without the rest.
    pub fn driving(&mut self) -> Option<f64> {
        let chip = self.session.board_mut();
        let (gpio, registers) = chip.mcu.port(self.wiring.enable.port);
        let is_driven = gpio.level(port_pin(self.wiring.enable), registers) == Level::High
            && is_connected(chip, self.wiring.pwm);
        let (timer, registers) = chip.mcu.advanced_timer(TIM1);
        let pulse = timer.pulse(TimerChannel::new(1).expect("channel 1"), registers).filter(|_| is_driven)?;
        Some(pulse.width.0 as f64 / pulse.period.0 as f64)
    }

    /// What the chip drives at the bridge.
    pub fn bridge(&mut self) -> Bridge {
        let chip = self.session.board_mut();
        let (wiring, is_connected) = (self.wiring, is_connected(chip, self.wiring.pwm));
        let mut channels = [None; 2];
        for (have, (channel, pin, _)) in channels.iter_mut().zip(wiring.half_bridges) {
            *have = high_time(chip, *pin, *channel);
        }
        let has_active_gate = wiring.gates().any(|(pin, output)| is_active(chip, pin, output));
        let mcu = &mut chip.mcu;
        let (gpio, registers) = mcu.port(self.wiring.enable.port);
        let is_enabled = gpio.level(port_pin(self.wiring.enable), registers) == Level::High;
        let (timer, registers) = mcu.advanced_timer(TIM1);
        let channel = TimerChannel::new(1).expect("channel 1");
        let pulse = timer.pulse(channel, registers).filter(|_| is_connected);
        Bridge {
            duty: pulse.map(|pulse| pulse.width.0 as f64 / pulse.period.0 as f64),
            channels,
            is_enabled,
            has_main_output: tim1::bdtr::MOE.is_set(registers.get(tim1::Register::Bdtr)),
            has_active_gate,
        }
    }

    /// Levels of PWM output and enable output; `None` for a PWM output that the timer doesn't drive.
    pub fn output_levels(&mut self) -> (Option<bool>, bool) {
        let is_enabled = self.bridge().is_enabled;
        let (timer, registers) = self.session.board_mut().mcu.advanced_timer(TIM1);
        let level = timer.output(TimerChannel::new(1).expect("channel 1"), registers);
        (level.map(|level| level == Level::High), is_enabled)
    }

    /// Pins of timers whose alternate function the image has not selected, one phrase each.
    pub fn unconnected(&mut self) -> Vec<String> {
        let chip = self.session.board_mut();
        let pins = self.wiring.pins().into_iter().filter(|pin| !self.wiring.link.contains(pin));
        pins.filter(|pin| !is_connected(chip, *pin)).map(|pin| pin.to_string()).collect()
    }

    /// Pins that the image has configured otherwise than they are wired, with what each has to be.
    pub fn misconfigured(&mut self) -> Vec<String> {
        let chip = self.session.board_mut();
        let pins = self.wiring.pins().into_iter().filter(|pin| !is_configured(chip, *pin));
        pins.map(|pin| pin.to_string()).collect()
    }

    /// A word of the chip's memory.
    ///
    /// # Errors
    /// No memory is there.
    pub fn word(&mut self, address: u64) -> Result<u32> {
        let word =
            self.host.read(address, Width::W32).with_context(|| format!("no memory at {address:#010x}"))?;
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

    /// Reports every arrival of the core at this instruction to [`Surroundings::arrived`].
    ///
    /// # Errors
    /// The core can't watch a further instruction.
    ///
    /// [`Surroundings::arrived`]: crate::surroundings::Surroundings::arrived
    pub fn watch(&mut self, address: u64) -> Result<()> {
        ensure!(self.host.watch(Watch::Instruction(address)), "{address:#010x} can't be watched");
        Ok(())
    }

    /// Pulls the reset pin low and releases it. Memory keeps its contents.
    pub fn reset(&mut self) {
        // The count of instructions is part of the report alone.
        self.session.reset_by_pin(self.at, 0, self.host);
        self.serial_line().clear();
    }

    /// Resets of the chip after power-up.
    #[must_use]
    pub fn resets(&self) -> usize {
        self.session.resets().len()
    }

    fn drive_pin(&mut self, pin: Pin, is_high: Option<bool>) {
        let chip = self.session.board_mut();
        let level = is_high.map(|is_high| if is_high { Level::High } else { Level::Low });
        chip.mcu.drive_port(self.at, pin.port, |gpio, registers, context| {
            gpio.drive(port_pin(pin), level, registers, context);
        });
        self.inputs.settle(chip, self.wiring, self.at);
    }
}

/// High time of the output of a channel; `None` if its timer doesn't drive it.
fn high_time(chip: &mut Chip, pin: Pin, channel: u8) -> Option<f64> {
    if !is_connected(chip, pin) {
        return None;
    }
    let (timer, registers) = chip.mcu.advanced_timer(TIM1);
    let channel = TimerChannel::new(channel).expect("a timer has channels 1 to 4");
    let level = timer.output(channel, registers)?;
    let pulse = timer.pulse(channel, registers);
    let level = if level == Level::High { 1.0 } else { 0.0 };
    Some(pulse.map_or(level, |pulse| pulse.width.0 as f64 / pulse.period.0 as f64))
}

/// Whether a gate carries a pulse or is high. A gate that is not connected to its timer has the level of its port.
fn is_active(chip: &mut Chip, pin: Pin, output: Option<TimerOutput>) -> bool {
    let Some(TimerOutput { channel, is_complementary }) = output.filter(|_| is_connected(chip, pin)) else {
        let (gpio, registers) = chip.mcu.port(pin.port);
        return gpio.level(port_pin(pin), registers) == Level::High;
    };
    let (timer, registers) = chip.mcu.advanced_timer(TIM1);
    let channel = TimerChannel::new(channel).expect("a timer has channels 1 to 4");
    let (pulse, level) = if is_complementary {
        (timer.complementary_pulse(channel, registers), timer.complementary_output(channel, registers))
    } else {
        (timer.pulse(channel, registers), timer.output(channel, registers))
    };
    pulse.is_some() || level == Some(Level::High)
}
