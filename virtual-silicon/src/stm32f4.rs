//! The STM32F4: the models of an STM32F427, which has every block of the STM32F405, F429 and F446 that the images use.
//!
//! They are made from the reference manual RM0090.

use anyhow::{Context, Result};
use rigless::chip::uart::Errors;
use rigless::device::{ErasedDevice, Level, ResetCause};
use rigless::machine::armv7m;
use rigless::mcu::Mcu;
use rigless::soc::Bus;
use rigless::soc::st::tim::Channel;
use rigless::soc::stm32f427::peripherals::adc;
use rigless::soc::stm32f427::peripherals::spi::Select;
use rigless::soc::stm32f427::{PORTS, Stm32f427};
use rigless::time::VirtualNanos;

use crate::gate_driver::GateDriver;
use crate::part::{Bits, Driven, Part, Registers, SUPPLY_MV, TIM1, channel_of, port_pin};
use crate::serial_line::SerialLine;
use crate::wiring::{Pin, Timer, TimerOutput};

/// The last code of a converter.
const LAST_CODE: u32 = 4095;

const REGISTERS: Registers = Registers {
    ports: 0x4002_0000,
    clock_control: 0x4002_3800,
    // PLLSRC of RCC_PLLCFGR.
    pll_source: Bits { address: 0x4002_3804, mask: 1 << 22 },
    // CC4E of TIM5_CCER.
    captures_lsi: Bits { address: 0x4000_0c20, mask: 1 << 12 },
    // DBG_IWDG_STOP of DBGMCU_APB1_FZ, DBG_TIM1_STOP of DBGMCU_APB2_FZ.
    watchdog_freezes: Bits { address: 0xe004_2008, mask: 1 << 12 },
    bridge_freezes: Bits { address: 0xe004_200c, mask: 1 << 0 },
    converter_control: Some(0x4001_2008),
};

/// Instances of the serial ports, in the order of the models.
const SERIAL_PORTS: [&str; 8] = ["USART1", "USART2", "USART3", "UART4", "UART5", "USART6", "UART7", "UART8"];

/// The part.
#[derive(Debug)]
pub(crate) struct Stm32f4 {
    part: Stm32f427,
    /// The serial port of the link, and its slot.
    link: Option<(usize, usize)>,
}

impl Stm32f4 {
    /// The part with this crystal.
    pub(crate) fn new(crystal_hz: u64) -> Result<Self> {
        let mut part = Stm32f427::new().context("the models of the part don't fit together")?;
        part.rcc.attach_crystals(crystal_hz, 0);
        part.set_supply(SUPPLY_MV);
        Ok(Self { part, link: None })
    }
}

impl Mcu for Stm32f4 {
    fn bus(&self) -> &Bus {
        self.part.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.part.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.part.reset(at, cause);
    }

    /// As the part does, which looks at all its serial ports at each stop, tens of thousands of times per second: the only one with a
    /// line, and only if that has a byte.
    fn poll(&mut self, now: VirtualNanos) {
        let Some((port, slot)) = self.link else { return };
        let line = self.part.usart[port].chip_mut::<SerialLine>();
        if line.is_some_and(|line| line.unsent() > 0)
            && let (bus, Some(model)) = self.part.split(slot)
        {
            let (registers, mut context) = bus.drive(now, slot);
            model.poll(registers, &mut context);
        }
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        self.part.split(slot)
    }
}

impl Part for Stm32f4 {
    fn registers(&self) -> &'static Registers {
        &REGISTERS
    }

    fn mcu(&mut self) -> &mut dyn Mcu {
        self
    }

    fn describe(&self, config: &mut armv7m::Config, starts_in_rom: bool) {
        if starts_in_rom {
            config.core.boot = "system";
        }
    }

    fn attach_line(&mut self, port: usize) {
        self.part.usart[port].attach(SerialLine::default());
        self.link = self.part.bus().slot_of(SERIAL_PORTS[port]).map(|slot| (port, slot));
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

    /// Inputs 0 to 7 of ADC1 are at port A, 8 and 9 at port B, 10 to 15 at port C.
    fn drive_analog(&mut self, pin: Pin, code: u16) {
        let first = [0, 8, 10][pin.port.min(2)];
        if let Some(channel) = adc::Channel::new(first + pin.pin) {
            // In whole millivolts of 3300 a fifth of the codes would have no voltage.
            self.part.adc[0].set_reference(LAST_CODE);
            self.part.adc[0].set_input(channel, code.into());
        }
    }

    fn drive_timer(&mut self, at: VirtualNanos, timer: Timer, channel: Channel, level: Level) {
        self.part.drive_timer(at, timer as usize, |timer, registers, context| {
            timer.drive_input(channel, level, registers, context);
        });
    }

    /// Channel 4 of TIM5. The models lack the wire to it (RM0090 18.4.20, TI4_RMP).
    fn drive_lsi(&mut self, at: VirtualNanos, level: Level) {
        Part::drive_timer(self, at, Timer::Tim5, channel_of(4), level);
    }

    fn drive_break(&mut self, at: VirtualNanos, level: Level) {
        self.part.drive_advanced_timer(at, TIM1, |timer, registers, context| {
            timer.drive_break(level, registers, context);
        });
    }

    fn output(&mut self, output: TimerOutput) -> Driven {
        let (timer, registers) = self.part.advanced_timer(TIM1);
        Driven::of(timer, registers, output)
    }

    fn stop_crystal(&mut self, at: VirtualNanos) {
        self.part.drive_clocks(at, |clocks, registers, context| clocks.fail_hse(registers, context));
    }
}
