//! The chip on its board: crystal, supply, and what is connected to it. A family of chips is a [`Part`].

use std::fmt;
use std::num::{NonZeroU32, NonZeroU64};

use anyhow::Result;
use rigless::cpu;
use rigless::device::{Level, RegisterFile};
use rigless::edge::Pulse;
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::Width;
use rigless::soc::st::gpio::Pin as PortPin;
use rigless::soc::st::tim::{self, Channel, Tim};
use rigless::time::VirtualNanos;
use serde::Deserialize;

use crate::gate_driver::GateDriver;
use crate::serial_line::SerialLine;
use crate::stm32f4;
use crate::stm32h7::Stm32h7;
use crate::wiring::{Pin, Timer, TimerOutput, Wiring};

/// Crystal on OSC_IN and OSC_OUT, Hz, unless the surroundings have another. The low-speed crystal is absent.
pub const CRYSTAL_HZ: u64 = 8_000_000;
/// Supply voltage, mV.
pub(crate) const SUPPLY_MV: u32 = 3_300;
/// Core clock that the images configure, Hz.
const CORE_HZ: u64 = 168_000_000;
/// One instruction per cycle. The model has a constant rate; on silicon, branches and loads take longer.
const INSTRUCTIONS_PER_SECOND: u64 = CORE_HZ;
/// TIM1 among the advanced timers of a part.
pub(crate) const TIM1: usize = 0;
/// From one port to the next.
const PORT_BYTES: u64 = 0x400;
/// HSEON of RCC_CR.
const CRYSTAL_ON: u64 = 1 << 16;
/// MOE of TIM1_BDTR.
const MAIN_OUTPUT: Bits = Bits { address: 0x4001_0044, mask: 1 << 15 };
const NAME: &str = "chip";

/// A family of chips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// See [`stm32f4`].
    Stm32f4,
    /// See [`stm32h7`](crate::stm32h7).
    Stm32h7,
}

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

    /// Connects the gate driver to a serial interface, selected by a low pin.
    fn attach_gate_driver(&mut self, interface: usize, select: Pin);

    fn gate_driver(&mut self, interface: usize) -> Option<&mut GateDriver>;

    /// Drives a pin from outside, or releases it.
    fn drive_pin(&mut self, at: VirtualNanos, pin: Pin, level: Option<Level>);

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

/// The part with crystal and supply.
#[derive(Debug)]
pub struct Chip {
    pub(crate) part: Box<dyn Part>,
    wiring: Wiring,
    has_mpu: bool,
    /// Whether the chip starts in its system memory, as with a high BOOT0, and not in its flash.
    pub starts_in_rom: bool,
}

impl Chip {
    /// The part with this crystal, on a board with this wiring, before its first instruction, with an idle line at its link.
    ///
    /// # Errors
    /// The tables of the part contradict each other.
    pub fn new(wiring: &Wiring, crystal_hz: u64, has_mpu: bool) -> Result<Self> {
        let mut part: Box<dyn Part> = match wiring.chip {
            Family::Stm32f4 => Box::new(stm32f4::part(crystal_hz)?),
            Family::Stm32h7 => Box::new(Stm32h7::new(crystal_hz)?),
        };
        part.attach_line(wiring.link.port as usize);
        if let Some(driver) = &wiring.gate_driver {
            part.attach_gate_driver(driver.port as usize, driver.select);
        }
        Ok(Self { part, wiring: wiring.clone(), has_mpu, starts_in_rom: false })
    }

    /// Keeps a crystal from starting if an access has just enabled it, which is one to RCC_CR. In the models an empty pin starts as
    /// a crystal does, but an oscillator that is off by its due time doesn't.
    ///
    /// # Panics
    /// Never: a part has clocks.
    pub fn hold_crystal(&mut self, at: VirtualNanos, accessed: u64) {
        if accessed == self.part.registers().clock_control {
            let control = self.register(accessed) & !CRYSTAL_ON;
            self.part.mcu().write(at, accessed, Width::W32, control).expect("the register exists");
        }
    }

    /// Whether the clock tree runs from the oscillator inside the chip, with the crystal off.
    pub(crate) fn clocks_are_internal(&mut self) -> bool {
        let Registers { clock_control: address, pll_source, .. } = self.part.registers();
        !self.is_set(&Bits { address: *address, mask: CRYSTAL_ON }) && !self.is_set(pll_source)
    }

    /// Main output enable of TIM1.
    pub(crate) fn has_main_output(&mut self) -> bool {
        self.is_set(&MAIN_OUTPUT)
    }

    /// A register as a debugger reads it. None of those that are asked for depends on time.
    fn register(&mut self, address: u64) -> u64 {
        self.part.mcu().peek(VirtualNanos(0), address, Width::W32).expect("the register exists")
    }

    /// A register of the port of a pin, by its offset.
    pub(crate) fn port_register(&mut self, pin: Pin, offset: u64) -> u64 {
        self.register(self.part.registers().ports + PORT_BYTES * pin.port as u64 + offset)
    }

    /// Whether any of these bits is set.
    pub(crate) fn is_set(&mut self, bits: &Bits) -> bool {
        self.register(bits.address) & bits.mask != 0
    }

    /// The gate driver of a board that has one.
    pub fn gate_driver(&mut self) -> Option<&mut GateDriver> {
        self.part.gate_driver(self.wiring.gate_driver.as_ref()?.port as usize)
    }

    /// The far end of the link.
    ///
    /// # Panics
    /// Never: [`Self::new`] attaches it.
    pub fn serial_line(&mut self) -> &mut SerialLine {
        self.part.line(self.wiring.link.port as usize).expect("the line of the constructor")
    }
}

// Snapshots are not used.
impl Store for Chip {}

impl Board for Chip {
    fn name(&self) -> &'static str {
        "lashloop drive"
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec![NAME]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then(|| self.part.mcu())
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let mcu = self.part.mcu();
        let core = armv7m::Core {
            variant: armv7m::Variant::M4,
            clock_hz: NonZeroU64::new(CORE_HZ).expect("a rate"),
            interrupt_lines: NonZeroU32::new(mcu.cpu().interrupt_lines.into())
                .expect("a part has interrupts"),
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("a divider"),
            instructions_per_second: NonZeroU64::new(INSTRUCTIONS_PER_SECOND).expect("a rate"),
            boot: "flash",
        };
        let mut config = armv7m::Config::new(core, &cpu::armv7m::windows(mcu.bus()));
        self.part.describe(&mut config, self.starts_in_rom);
        if !self.has_mpu {
            config.mpu_regions = armv7m::MpuRegions::None;
        }
        vec![Target::new(NAME, self.part.mcu(), config.spec())]
    }
}
