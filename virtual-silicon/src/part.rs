//! A chip as the models of its family: what virtual silicon needs of them, besides registers at known addresses.

use std::fmt;

use rigless::chip::uart::Errors;
use rigless::device::{Level, RegisterFile};
use rigless::edge::Pulse;
use rigless::machine::armv7m;
use rigless::mcu::Mcu;
use rigless::soc::st::gpio::Pin as PortPin;
use rigless::soc::st::tim::{self, Channel, Tim};
use rigless::time::VirtualNanos;

use crate::gate_driver::GateDriver;
use crate::serial_line::SerialLine;
use crate::wiring::{Pin, Timer, TimerOutput};

/// Supply voltage, mV.
pub(crate) const SUPPLY_MV: u32 = 3_300;
/// TIM1 among the advanced timers of a part.
pub(crate) const TIM1: usize = 0;

/// Bits of a register.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bits {
    pub(crate) address: u64,
    pub(crate) mask: u64,
}

/// Where a family has the registers that are otherwise those of every family.
#[derive(Debug)]
pub(crate) struct Registers {
    /// GPIOA.
    pub(crate) ports: u64,
    /// RCC_CR, which enables the oscillators.
    pub(crate) clock_control: u64,
    /// Source of the PLL: the oscillator inside the chip if they are clear.
    pub(crate) pll_source: Bits,
    /// The capture of the low-speed oscillator is enabled.
    pub(crate) captures_lsi: Bits,
    /// A halted core stops the independent watchdog.
    pub(crate) watchdog_freezes: Bits,
    /// A halted core stops TIM1.
    pub(crate) bridge_freezes: Bits,
    /// ADC_CR2 of the converters that TIM1 starts; `None` for a family without them.
    pub(crate) converter_control: Option<u64>,
}

/// What virtual silicon needs of the models of a family. Registers are read by their addresses.
pub(crate) trait Part: fmt::Debug + Send {
    fn registers(&self) -> &'static Registers;

    fn mcu(&mut self) -> &mut dyn Mcu;

    /// Completes the description of the core, which is that of a Cortex-M4 which boots from its flash.
    fn describe(&self, core: &mut armv7m::Config, starts_in_rom: bool);

    /// Connects the far end of the link to a serial port.
    fn attach_line(&mut self, port: usize);

    fn line(&mut self, port: usize) -> Option<&mut SerialLine>;

    /// Errors of the bytes that arrive at a serial port.
    fn line_errors(&mut self, port: usize) -> &mut Errors;

    /// Connects the gate driver to a serial interface, selected by a low pin.
    fn attach_gate_driver(&mut self, interface: usize, select: Pin);

    fn gate_driver(&mut self, interface: usize) -> Option<&mut GateDriver>;

    /// Drives a pin from outside, or releases it.
    fn drive_pin(&mut self, at: VirtualNanos, pin: Pin, level: Option<Level>);

    /// Puts the voltage of a code on an analog pin of the converters that TIM1 starts.
    fn drive_analog(&mut self, _pin: Pin, _code: u16) {}

    /// Drives the input of a channel of a general-purpose timer.
    fn drive_timer(&mut self, at: VirtualNanos, timer: Timer, channel: Channel, level: Level);

    /// Drives the input of a timer that measures the low-speed oscillator. No pin of a board leads to it.
    fn drive_lsi(&mut self, at: VirtualNanos, level: Level);

    /// Drives the break input of TIM1.
    fn drive_break(&mut self, at: VirtualNanos, level: Level);

    fn output(&mut self, output: TimerOutput) -> Driven;

    /// Stops the crystal.
    fn stop_crystal(&mut self, at: VirtualNanos);
}

/// What a timer drives at an output.
pub(crate) struct Driven {
    /// `None` if it doesn't drive the output.
    pub(crate) level: Option<Level>,
    /// `None` for an output that carries no pulse.
    pub(crate) pulse: Option<Pulse>,
}

impl Driven {
    pub(crate) fn of<F: tim::Family>(
        timer: &Tim<F>,
        registers: &RegisterFile,
        TimerOutput { channel, is_complementary }: TimerOutput,
    ) -> Self {
        let channel = channel_of(channel);
        if is_complementary {
            let level = timer.complementary_output(channel, registers);
            Self { level, pulse: timer.complementary_pulse(channel, registers) }
        } else {
            Self { level: timer.output(channel, registers), pulse: timer.pulse(channel, registers) }
        }
    }

    /// High time as a fraction of the period; `None` for an output that carries no pulse.
    pub(crate) fn duty(&self) -> Option<f64> {
        self.pulse.map(|pulse| pulse.width.0 as f64 / pulse.period.0 as f64)
    }
}

pub(crate) fn channel_of(number: u8) -> Channel {
    Channel::new(number).expect("a timer has channels 1 to 4")
}

pub(crate) fn port_pin(pin: Pin) -> PortPin {
    PortPin::new(pin.pin).expect("a port has 16 pins")
}
