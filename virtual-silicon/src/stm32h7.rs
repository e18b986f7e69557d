//! The STM32H7: the models of an STM32H743, made from the reference manual RM0433, and what they lack.
//!
//! | lacks | here |
//! |---|---|
//! | the independent watchdog | that of the STM32F4, which has the same registers but the window (RM0433 45.4, RM0090 21.4) |
//! | the wire from the clock security system to the break of TIM1 | the timer is built with it (RM0433 38.3.16) |
//! | methods that drive inputs of timers and clocks | [`Stm32h7::drive`] |
//!
//! Of a USB core they have the reset register alone. The driver of an image doesn't know its id, and leaves USB alone.

use std::mem;

use anyhow::{Context, Result};
use rigless::chip::uart::Errors;
use rigless::device::{Device, DeviceContext, ErasedDevice, Level, RegisterFile, ResetCause};
use rigless::machine::armv7m;
use rigless::mcu::Mcu;
use rigless::soc::st::tim::{BreakInput, BreakSource, Channel};
use rigless::soc::stm32f427::peripherals::iwdg::Iwdg;
use rigless::soc::stm32h743::Stm32h743;
use rigless::soc::stm32h743::generated::iwdg;
use rigless::soc::stm32h743::peripherals::gpio::PORTS;
use rigless::soc::stm32h743::peripherals::rcc::CLOCK_FAILURE;
use rigless::soc::stm32h743::peripherals::spi::Select;
use rigless::soc::stm32h743::peripherals::tim::{ADVANCED_TIMERS, TIMER_16, TIMERS, Tim};
use rigless::soc::{Bus, Layout};
use rigless::time::{EventId, VirtualNanos};

use crate::gate_driver::GateDriver;
use crate::part::{Bits, Driven, Part, Registers, SUPPLY_MV, TIM1, channel_of, port_pin};
use crate::serial_line::SerialLine;
use crate::wiring::{Pin, Timer, TimerOutput};

const REGISTERS: Registers = Registers {
    ports: 0x5802_0000,
    clock_control: 0x5802_4400,
    // PLLSRC of RCC_PLLCKSELR.
    pll_source: Bits { address: 0x5802_4428, mask: 0b11 },
    // CC1E of TIM16_CCER.
    captures_lsi: Bits { address: 0x4001_4420, mask: 1 << 0 },
    // DBG_IWDG1 of DBGMCU_APB4FZ1, DBG_TIM1 of DBGMCU_APB2FZ1.
    watchdog_freezes: Bits { address: 0x5c00_1054, mask: 1 << 18 },
    bridge_freezes: Bits { address: 0x5c00_104c, mask: 1 << 0 },
    converter_control: None,
};
/// The low-speed oscillator among the inputs of channel 1 of TIM16 (RM0433 41.6.18, TI1SEL).
const LSI: u8 = 1;
/// Vector tables of flash and system memory, at which a low and a high BOOT0 start the core (RM0433 2.6, ST AN2606).
const FLASH: u32 = 0x0800_0000;
const SYSTEM_MEMORY: u32 = 0x1ff0_9800;

/// The part.
#[derive(Debug)]
pub(crate) struct Stm32h7 {
    part: Stm32h743,
    watchdog: Watchdog,
    watchdog_slot: usize,
}

impl Stm32h7 {
    /// The part with this crystal, or with a clock of this frequency.
    pub(crate) fn new(crystal_hz: u64) -> Result<Self> {
        let mut part = Stm32h743::new().context("the models of the part don't fit together")?;
        part.rcc.attach_crystals(crystal_hz, 0);
        part.set_supply(SUPPLY_MV);
        let watchdog_slot = part.bus().slot("IWDG")?;
        let mut it = Self { part, watchdog: Watchdog(Iwdg::new()), watchdog_slot };
        it.complete();
        Ok(it)
    }

    /// What the models lack after each reset.
    fn complete(&mut self) {
        self.watchdog = Watchdog(Iwdg::new());
        self.part.advanced[TIM1] = Tim::new(ADVANCED_TIMERS[TIM1]).breaks_on("RCC", CLOCK_FAILURE);
    }

    /// Drives an input of the model of an instance, which has a place in the part. Another model keeps the place meanwhile.
    fn drive<M>(
        &mut self,
        at: VirtualNanos,
        instance: &str,
        place: impl Fn(&mut Stm32h743) -> &mut M,
        stand_in: M,
        input: impl FnOnce(&mut M, &mut RegisterFile, &mut DeviceContext<'_>),
    ) {
        let mut model = mem::replace(place(&mut self.part), stand_in);
        let slot = self.part.bus().slot_of(instance).expect("the part has it");
        let (registers, mut context) = self.part.bus_mut().drive(at, slot);
        input(&mut model, registers, &mut context);
        *place(&mut self.part) = model;
    }
}

impl Mcu for Stm32h7 {
    fn bus(&self) -> &Bus {
        self.part.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.part.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.part.reset(at, cause);
        self.complete();
    }

    fn poll(&mut self, now: VirtualNanos) {
        self.part.poll(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        let (bus, model) = self.part.split(slot);
        (bus, if slot == self.watchdog_slot { Some(&mut self.watchdog) } else { model })
    }
}

impl Part for Stm32h7 {
    fn registers(&self) -> &'static Registers {
        &REGISTERS
    }

    fn mcu(&mut self) -> &mut dyn Mcu {
        self
    }

    /// A Cortex-M7 r1p1 with two caches of 16 KiB (ES0392 2.1, DS12110 3.1; PM0253 tables 52, 77 and 81).
    fn describe(&self, config: &mut armv7m::Config, starts_in_rom: bool) {
        config.core.variant = armv7m::Variant::M7;
        config.fpu = armv7m::Fpu::FpV5Dp;
        config.mpu_regions = armv7m::MpuRegions::Sixteen;
        config.cpuid = 0x411f_c271;
        let ccsidr = &[0xf00f_e019, 0xf01f_e009];
        config.caches = Some(armv7m::Caches { clidr: 0x0900_0003, ctr: 0x8303_c003, ccsidr });
        config.branch_prediction = armv7m::BranchPrediction::Always;
        config.vector_table = Some(if starts_in_rom { SYSTEM_MEMORY } else { FLASH });
    }

    fn attach_line(&mut self, port: usize) {
        self.part.usart[port].attach(SerialLine::default());
    }

    fn line(&mut self, port: usize) -> Option<&mut SerialLine> {
        self.part.usart[port].chip_mut()
    }

    fn line_errors(&mut self, port: usize) -> &mut Errors {
        self.part.usart[port].errors_mut()
    }

    fn attach_gate_driver(&mut self, interface: usize, select: Pin) {
        let select = Select { port: PORTS[select.port], pin: port_pin(select), active: Level::Low };
        self.part.spi[interface].attach_selected(GateDriver::default(), select);
    }

    fn gate_driver(&mut self, interface: usize) -> Option<&mut GateDriver> {
        self.part.spi[interface].chip_mut(0)
    }

    fn drive_pin(&mut self, at: VirtualNanos, pin: Pin, level: Option<Level>) {
        self.part.drive_port(at, pin.port, |port, registers, context| {
            port.drive(port_pin(pin), level, registers, context);
        });
    }

    fn drive_timer(&mut self, at: VirtualNanos, timer: Timer, channel: Channel, level: Level) {
        let (place, row) = (timer as usize, TIMERS[timer as usize]);
        let input = |timer: &mut Tim<_>, registers: &mut _, context: &mut DeviceContext<'_>| {
            timer.drive_input(channel, level, registers, context);
        };
        self.drive(at, row.instance, |part| &mut part.tim[place], Tim::new(row), input);
    }

    fn drive_lsi(&mut self, at: VirtualNanos, level: Level) {
        self.drive(
            at,
            TIMER_16.instance,
            |part| &mut part.tim16,
            Tim::new(TIMER_16),
            |timer, registers, context| {
                timer.drive_input_source(channel_of(1), LSI, level, registers, context);
            },
        );
    }

    fn drive_break(&mut self, at: VirtualNanos, level: Level) {
        let row = ADVANCED_TIMERS[TIM1];
        self.drive(
            at,
            row.instance,
            |part| &mut part.advanced[TIM1],
            Tim::new(row),
            |timer, registers, context| {
                timer.drive_break(BreakInput::First, BreakSource::Pin, level, registers, context);
            },
        );
    }

    fn output(&mut self, output: TimerOutput) -> Driven {
        let (timer, registers) = self.part.advanced_timer(TIM1);
        Driven::of(timer, registers, output)
    }

    fn stop_crystal(&mut self, at: VirtualNanos) {
        self.drive(
            at,
            "RCC",
            |part| &mut part.rcc,
            Default::default(),
            |clocks, registers, context| {
                clocks.fail_hse(registers, context);
            },
        );
    }
}

/// The independent watchdog of another family behind the registers of this one. It has no window.
#[derive(Debug)]
struct Watchdog(Iwdg);

/// A register of the other family at the same offset.
fn other(register: iwdg::Register) -> Option<<Iwdg as Device>::Register> {
    <Iwdg as Device>::Register::from_index(register.index())
}

impl Device for Watchdog {
    type Register = iwdg::Register;

    fn read(
        &mut self,
        register: iwdg::Register,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        Device::read(&mut self.0, other(register)?, registers, context)
    }

    fn write(
        &mut self,
        register: iwdg::Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        match other(register) {
            Some(register) => Device::write(&mut self.0, register, value, registers, context),
            None => context.tell("WINR", "the model of the watchdog has no window"),
        }
    }

    fn on_event(&mut self, event: EventId, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        Device::on_event(&mut self.0, event, registers, context);
    }

    fn on_clock(&mut self, hz: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        Device::on_clock(&mut self.0, hz, registers, context);
    }
}
