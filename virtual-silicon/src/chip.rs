//! The chip on its board: crystal, supply, and what is connected to it.

use std::num::{NonZeroU32, NonZeroU64};

use anyhow::Result;
use rigless::cpu;
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use crate::gate_driver::GateDriver;
use crate::part::{Bits, Part, Registers};
use crate::serial_line::SerialLine;
use crate::stm32f4::Stm32f4;
use crate::stm32h7::Stm32h7;
use crate::wiring::{Family, Pin, Wiring};

/// Crystal on OSC_IN and OSC_OUT, Hz, unless the surroundings have another. The low-speed crystal is absent.
pub const CRYSTAL_HZ: u64 = 8_000_000;
/// Core clock that the images configure, Hz.
const CORE_HZ: u64 = 168_000_000;
/// One instruction per cycle. The model has a constant rate; on silicon, branches and loads take longer.
const INSTRUCTIONS_PER_SECOND: u64 = CORE_HZ;
/// From one port to the next.
const PORT_BYTES: u64 = 0x400;
/// HSEON of RCC_CR.
const CRYSTAL_ON: u64 = 1 << 16;
/// MOE of TIM1_BDTR.
const MAIN_OUTPUT: Bits = Bits { address: 0x4001_0044, mask: 1 << 15 };
const NAME: &str = "chip";

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
            Family::Stm32f4 => Box::new(Stm32f4::new(crystal_hz)?),
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
            self.write_register(accessed, control, at);
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

    /// A register as a debugger reads it, which doesn't depend on time.
    fn register(&mut self, address: u64) -> u64 {
        self.register_at(address, VirtualNanos(0))
    }

    /// A register as a debugger reads it.
    pub(crate) fn register_at(&mut self, address: u64, at: VirtualNanos) -> u64 {
        self.part.mcu().peek(at, address, Width::W32).expect("the register exists")
    }

    /// Writes a register, as what the models lack would do.
    pub(crate) fn write_register(&mut self, address: u64, value: u64, at: VirtualNanos) {
        self.part.mcu().write(at, address, Width::W32, value).expect("the register exists");
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
