//! The pins of the chip, as wires soldered to them.
//!
//! A timer is connected to its pins only while the image has selected its alternate function there: an image that forgets
//! one counts nothing and drives nothing, as on a board.

use std::time::Duration;

use anyhow::{Context, Result, ensure};
use rigless::chip::uart::Rate;
use rigless::device::Level;
use rigless::emulator::{Host, Watch};
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use crate::centred_pulse::CentredPeriod;
use crate::chip::Chip;
use crate::gate_driver::GateDriver;
use crate::inputs::{self, Inputs, is_configured, is_connected};
use crate::part::Driven;
use crate::quadrature::{Channel, Edge, Quadrature};
use crate::serial_line::SerialLine;
use crate::wiring::{ContactPins, Encoder, Pin, TimerOutput, Wiring};

/// Codes of a converter.
const CODES: f64 = 4096.0;
/// ADON of ADC_CR2.
const CONVERTERS_ON: u64 = 1 << 0;
/// The output that carries the duty.
const PWM: TimerOutput = TimerOutput { channel: 1, is_complementary: false };

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
    samples: bool,
}

impl<'a> Pins<'a> {
    pub(crate) fn new(
        session: &'a mut Session<Chip>,
        host: &'a mut dyn Host,
        at: VirtualNanos,
        wiring: &'a Wiring,
        inputs: &'a mut Inputs,
    ) -> Self {
        Self { session, host, at, wiring, inputs, samples: false }
    }

    /// The same instant, at which the converters start.
    pub(crate) fn at_sample(self, samples: bool) -> Self {
        Self { samples, ..self }
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

    /// Makes every byte from here on arrive with a framing error and other bits, or none.
    pub fn garble_line(&mut self, does: bool) {
        let errors = self.session.board_mut().part.line_errors(self.wiring.link.port as usize);
        errors.framing.per_million = if does { Rate::EVERY_WORD } else { 0 };
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

    /// Drives the index of an encoder. A board may have no input for it.
    pub fn drive_index(&mut self, encoder: Encoder, is_high: bool) {
        if let Some(index) = self.wiring.encoder(encoder).index {
            self.drive_pin(index.pin, Some(is_high));
        }
    }

    /// Cuts the wire of one channel of an encoder.
    pub fn open_encoder(&mut self, encoder: Encoder, channel: Channel) {
        self.drive_pin(self.wiring.encoder(encoder).pin(channel), None);
    }

    /// Drives the break input high or low, or cuts its wire with `None`. A board may have none.
    pub fn drive_break(&mut self, is_high: Option<bool>) {
        if let Some(pin) = self.wiring.bridge.break_input {
            self.drive_pin(pin, is_high);
        }
    }

    /// Pins of the contacts.
    #[must_use]
    pub fn contacts(&self) -> &ContactPins {
        &self.wiring.contacts
    }

    /// Closes a contact of [`Wiring::contacts`], or opens it.
    pub fn close_contact(&mut self, pin: Pin, does: bool) {
        self.drive_pin(pin, does.then_some(false));
    }

    /// Puts voltages on the pins of the current sensor and of the divided bus, as fractions of the converters' range. A board may have
    /// neither.
    pub fn drive_bridge_sensor(&mut self, current: f64, bus: f64) {
        let bridge = &self.wiring.bridge;
        for (pin, fraction) in [(bridge.current, current), (bridge.bus, bus)] {
            if let Some(pin) = pin {
                let code = (CODES * fraction).clamp(0.0, CODES - 1.0) as u16;
                self.session.board_mut().part.drive_analog(pin, code);
            }
        }
    }

    /// Powers the converters down, as a fault of theirs would. A chip may have none that TIM1 starts.
    pub fn stop_converters(&mut self) {
        let chip = self.session.board_mut();
        if let Some(control) = chip.part.registers().converter_control {
            let running = chip.register_at(control, self.at);
            chip.write_register(control, running & !CONVERTERS_ON, self.at);
        }
    }

    /// Whether the converters start at this instant.
    #[must_use]
    pub fn samples(&self) -> bool {
        self.samples
    }

    /// Stops the crystal.
    pub fn stop_crystal(&mut self) {
        self.session.board_mut().part.stop_crystal(self.at);
    }

    /// Whether the clock tree runs from the oscillator inside the chip, with the crystal off.
    pub fn clocks_are_internal(&mut self) -> bool {
        self.session.board_mut().clocks_are_internal()
    }

    /// What a core that a debugger halts does not stop: the independent watchdog, and what it stops: TIM1.
    pub fn halted_by_debugger(&mut self) -> (bool, bool) {
        let chip = self.session.board_mut();
        let registers = chip.part.registers();
        (!chip.is_set(&registers.watchdog_freezes), chip.is_set(&registers.bridge_freezes))
    }

    /// The gate driver; a board may have none.
    pub fn gate_driver(&mut self) -> Option<&mut GateDriver> {
        self.session.board_mut().gate_driver()
    }

    /// Drives the fault line of the gate driver high or low. A board may have none.
    pub fn drive_fault_line(&mut self, is_high: bool) {
        if let Some(driver) = &self.wiring.gate_driver {
            self.drive_pin(driver.fault_line, Some(is_high));
        }
    }

    /// High times of both gates of each half-bridge as fractions of the period; `None` for a gate without a pulse.
    pub fn half_bridges(&mut self) -> Vec<[Option<f64>; 2]> {
        let chip = self.session.board_mut();
        let both = |gates: [(Pin, TimerOutput); 2]| {
            gates.map(|(pin, output)| connected(chip, pin, output).and_then(|driven| driven.duty()))
        };
        self.wiring.half_bridges().map(both).collect()
    }

    /// Period of the modulation; `None` if its output carries no pulse.
    pub fn modulation_period(&mut self) -> Option<Duration> {
        let pulse = self.session.board_mut().part.output(PWM).pulse?;
        Some(Duration::from_nanos(pulse.period.0))
    }

    /// Level of a pin.
    pub fn is_high(&mut self, pin: Pin) -> bool {
        inputs::is_high(self.session.board_mut(), pin)
    }

    /// Duty of a bridge that drives its motor, as [`Bridge::driving`], without the rest.
    pub fn driving(&mut self) -> Option<f64> {
        let is_enabled = self.is_high(self.wiring.bridge.enable);
        let chip = self.session.board_mut();
        let [is_connected, _] = self.inputs.outputs(chip, self.wiring, self.at);
        let period = CentredPeriod::of(chip);
        (is_enabled && is_connected).then(|| driven(chip, PWM, period))?.duty()
    }

    /// High times of both channels of a bridge that is on, as [`Bridge::channels`], without the rest.
    pub fn driving_channels(&mut self) -> Option<[f64; 2]> {
        let is_enabled = self.is_high(self.wiring.bridge.enable);
        let chip = self.session.board_mut();
        let are_connected = self.inputs.outputs(chip, self.wiring, self.at) == [true; 2];
        if !is_enabled || !are_connected || !chip.has_main_output() {
            return None;
        }
        let period = CentredPeriod::of(chip);
        let [first, second] = [1, 2].map(|channel| {
            high_time(&driven(chip, TimerOutput { channel, is_complementary: false }, period))
        });
        Some([first?, second?])
    }

    /// What the chip drives at the bridge.
    pub fn bridge(&mut self) -> Bridge {
        let is_enabled = self.is_high(self.wiring.bridge.enable);
        let chip = self.session.board_mut();
        let mut duty = None;
        let mut channels = [None; 2];
        let mut has_active_gate = false;
        for (channel, gates) in channels.iter_mut().zip(self.wiring.half_bridges()) {
            for (pin, output) in gates {
                let driven = connected(chip, pin, output);
                has_active_gate |= match &driven {
                    Some(driven) => driven.pulse.is_some() || driven.level == Some(Level::High),
                    // A gate that isn't connected to its timer has the level of its port.
                    None => inputs::is_high(chip, pin),
                };
                if output == PWM {
                    duty = driven.as_ref().and_then(Driven::duty);
                }
                if !output.is_complementary {
                    *channel = driven.and_then(|driven| high_time(&driven));
                }
            }
        }
        has_active_gate |= self.wiring.bridge.unused_gates.iter().any(|pin| inputs::is_high(chip, *pin));
        Bridge { duty, channels, is_enabled, has_main_output: chip.has_main_output(), has_active_gate }
    }

    /// Levels of PWM output and enable output; `None` for a PWM output that the timer doesn't drive.
    pub fn output_levels(&mut self) -> (Option<bool>, bool) {
        let is_enabled = self.is_high(self.wiring.bridge.enable);
        let level = self.session.board_mut().part.output(PWM).level;
        (level.map(|level| level == Level::High), is_enabled)
    }

    /// Pins of timers whose alternate function the image has not selected, one phrase each.
    pub fn unconnected(&mut self) -> Vec<String> {
        let chip = self.session.board_mut();
        let uses = self.wiring.uses().into_iter().filter(|(key, ..)| !key.starts_with("link."));
        let pins = uses.map(|(_, pin, _)| pin).filter(|pin| !is_connected(chip, *pin));
        pins.map(|pin| pin.to_string()).collect()
    }

    /// Pins that the image has configured otherwise than they are wired, with what each has to be.
    pub fn misconfigured(&mut self) -> Vec<String> {
        let chip = self.session.board_mut();
        let pins = self.wiring.uses().into_iter().map(|(_, pin, _)| pin);
        pins.filter(|pin| !is_configured(chip, *pin)).map(|pin| pin.to_string()).collect()
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
        *self.inputs = Inputs::default();
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
        chip.part.drive_pin(self.at, pin, level);
        self.inputs.follow(chip, self.wiring, (pin, level), self.at);
    }
}

/// What TIM1 drives at a pin; `None` if the image has not connected them.
fn connected(chip: &mut Chip, pin: Pin, output: TimerOutput) -> Option<Driven> {
    is_connected(chip, pin).then(|| {
        let period = CentredPeriod::of(chip);
        driven(chip, output, period)
    })
}

/// What TIM1 drives at an output.
fn driven(chip: &mut Chip, output: TimerOutput, period: Option<CentredPeriod>) -> Driven {
    let mut driven = chip.part.output(output);
    if let Some(period) = period.filter(|_| driven.level.is_some() && driven.pulse.is_none())
        && chip.has_main_output()
    {
        driven.pulse = period.pulse(chip, output);
    }
    driven
}

/// High time of an output, 0 or 1 for a level; `None` if its timer doesn't drive it.
fn high_time(driven: &Driven) -> Option<f64> {
    let level = if driven.level? == Level::High { 1.0 } else { 0.0 };
    Some(driven.duty().unwrap_or(level))
}
