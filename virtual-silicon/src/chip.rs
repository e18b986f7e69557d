//! The chip on its board: crystal, supply and the far end of the link.

use std::num::{NonZeroU32, NonZeroU64};

use anyhow::{Context, Result};
use rigless::cpu;
use rigless::device::Level;
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::generated::rcc;
use rigless::soc::stm32f427::peripherals::gpio::Pin as PortPin;
use rigless::soc::stm32f427::peripherals::spi::Select;
use rigless::time::VirtualNanos;

use crate::gate_driver::GateDriver;
use crate::serial_line::SerialLine;
use crate::wiring::Wiring;

/// Crystal on OSC_IN and OSC_OUT, Hz, unless the surroundings have another. The low-speed crystal is absent.
pub const CRYSTAL_HZ: u64 = 8_000_000;
/// Supply voltage, mV.
const SUPPLY_MV: u32 = 3_300;
/// Core clock that the image configures, Hz.
const CORE_HZ: u64 = 168_000_000;
/// One instruction per cycle. The model has a constant rate; on silicon, branches and loads take longer.
const INSTRUCTIONS_PER_SECOND: u64 = CORE_HZ;
/// SPI3 among the serial interfaces of the part.
const SPI3: usize = 2;
/// Address of RCC_CR, which enables the oscillators.
pub(crate) const CLOCK_CONTROL: u64 = 0x4002_3800;
/// TIM1 among the advanced timers of the part.
pub(crate) const TIM1: usize = 0;
const NAME: &str = "stm32f427";

/// The part with crystal and supply.
#[derive(Debug)]
pub struct Chip {
    /// The models of the part.
    pub mcu: Stm32f427,
    link_port: usize,
    has_mpu: bool,
}

impl Chip {
    /// The part with this crystal, on a board with this wiring, before its first instruction, with an idle line at its link.
    ///
    /// # Errors
    /// The tables of the part contradict each other.
    pub fn new(crystal_hz: u64, wiring: &Wiring, has_mpu: bool) -> Result<Self> {
        let mut mcu = Stm32f427::new().context("the models of the part don't fit together")?;
        mcu.rcc.attach_crystals(crystal_hz, 0);
        mcu.set_supply(SUPPLY_MV);
        mcu.usart[wiring.link_port].attach(SerialLine::default());
        if wiring.has_gate_driver {
            let pin = PortPin::new(13).expect("a port has 16 pins");
            let select = Select { port: "GPIOC", pin, active: Level::Low };
            mcu.spi[SPI3].attach_selected(GateDriver::default(), select);
        }
        Ok(Self { mcu, link_port: wiring.link_port, has_mpu })
    }

    /// Keeps a crystal that has been enabled from starting. In the model an empty pin starts as a crystal does, but an oscillator
    /// that is off by its due time doesn't.
    pub(crate) fn hold_crystal(&mut self, at: VirtualNanos) {
        self.mcu.drive_clocks(at, |_, registers, _| {
            let control = registers.get(rcc::Register::Cr);
            registers.set(rcc::Register::Cr, rcc::cr::HSEON.set(control, 0));
        });
    }

    /// The gate driver of a board that has one.
    pub fn gate_driver(&mut self) -> Option<&mut GateDriver> {
        self.mcu.spi[SPI3].chip_mut(0)
    }

    /// The far end of the link.
    ///
    /// # Panics
    /// Never: [`Self::new`] attaches it.
    pub fn serial_line(&mut self) -> &mut SerialLine {
        self.mcu.usart[self.link_port].chip_mut().expect("the line of the constructor")
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
        (target == 0).then_some(&mut self.mcu)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let lines = u32::from(Operate::cpu(&self.mcu).interrupt_lines);
        let core = armv7m::Core {
            variant: armv7m::Variant::M4,
            clock_hz: NonZeroU64::new(CORE_HZ).expect("a rate"),
            interrupt_lines: NonZeroU32::new(lines).expect("a part has interrupts"),
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("a divider"),
            instructions_per_second: NonZeroU64::new(INSTRUCTIONS_PER_SECOND).expect("a rate"),
            boot: "flash",
        };
        let windows = cpu::armv7m::windows(Mcu::bus(&self.mcu));
        let regions = if self.has_mpu { armv7m::MpuRegions::Eight } else { armv7m::MpuRegions::None };
        let core = core.spec_with_parts(&windows, armv7m::Fpu::FpV4Sp, regions);
        vec![Target::new(NAME, &mut self.mcu, core)]
    }
}
