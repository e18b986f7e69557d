//! The STM32F4 family: F405, F429 and F446.

#[allow(dead_code, reason = "a board may have a bridge without gate driver")]
mod gate_driver;

#[allow(dead_code, reason = "a board may have no sensor")]
mod adc;
mod clock_tree;
mod contacts;
mod encoder;
mod flash;
mod ports;
mod pwm;
mod serial;
mod stopwatch;
mod timers;
mod usb;
mod watchdog;

// `mod fitted`: the file of the selected board.
include!(concat!(env!("OUT_DIR"), "/fitted.rs"));

pub use stm32f4xx_hal::pac;

use pac::{IWDG, Interrupt, OTG_FS_DEVICE, Peripherals};
use stm32f4xx_hal::serial::{Rx, Tx};

use super::chip::{Bench, Chip, Started};
use super::clock_source::ClockSource;
use super::usb_port::UsbMemory;
use crate::store::Memory;
use ports::{Blocks, Ports};

/// A chip of the family on the selected board.
pub struct Stm32f4;

impl Chip for Stm32f4 {
    type Peripherals = Peripherals;
    type Interrupt = Interrupt;
    type Receiver = Rx<fitted::LinkPort>;
    type Transmitter = Tx<fitted::LinkPort>;
    type Usb = usb::Bus;
    type MotorEncoder = fitted::MotorEncoder;
    type LoadEncoder = fitted::LoadEncoder;
    type Contacts = contacts::ContactPins;
    type Pwm = pwm::Tim1;
    type StageLines = fitted::Lines;
    type Sensor = fitted::Sensor;
    type Tick = timers::Tim5;
    type Monitor = timers::Tim2;

    const STORE: &'static dyn Memory = &flash::Flash;
    const BOARD: &'static str = fitted::NAME;
    const CHIP: &'static str = fitted::CHIP;
    const LINK: Interrupt = fitted::LINK;
    const SENSOR: Interrupt = fitted::SENSOR;
    // RM0090 2.4, system memory.
    const ROM: u32 = 0x1fff_0000;
    const ROM_VECTORS: u32 = 0;

    /// QEMU has no chip identity: it reads 0, never on silicon (RM0090 38.6.1).
    fn is_emulated(device: &Peripherals) -> bool {
        device.DBGMCU.idcode().read().bits() == 0
    }

    fn take_watchdog_reset(device: &Peripherals) -> bool {
        let is_cause = device.RCC.csr().read().wdgrstf().is_reset();
        device.RCC.csr().modify(|_, w| w.rmvf().clear());
        is_cause
    }

    /// The loader takes its vectors from address 0.
    fn show_rom(device: &Peripherals) {
        // Until the clock has arrived, SYSCFG ignores a write (ES0182 2.2.13).
        device.RCC.apb2enr().modify(|_, w| w.syscfgen().enabled());
        cortex_m::asm::dsb();
        device.SYSCFG.memrmp().write(|w| w.mem_mode().system_flash());
    }

    fn start(device: Peripherals, is_emulated: bool, usb: &'static mut UsbMemory<usb::Bus>) -> Started<Self> {
        let (mut rcc, clock) = clock_tree::start(device.RCC, &device.TIM5, is_emulated);
        let gpio = (device.GPIOA, device.GPIOB, device.GPIOC, device.GPIOD, device.GPIOE);
        let ports = Ports::new(gpio, (device.USART2, device.USART3), &mut rcc);
        let (link, usb_pins, bench_pins) = fitted::share(ports);
        let link = serial::open(link, &mut rcc);
        let usb = (clock == ClockSource::Crystal)
            .then(|| {
                let core = (device.OTG_FS_GLOBAL, device.OTG_FS_DEVICE, device.OTG_FS_PWRCLK);
                usb::open(core, usb_pins, &mut rcc, usb)
            })
            .flatten();
        if is_emulated {
            return Started { clock, link, usb, bench: None };
        }
        let blocks = Blocks {
            pwm: device.TIM1,
            motor: device.TIM3,
            load: device.TIM4,
            spi3: device.SPI3,
            adc: (device.ADC1, device.ADC_COMMON),
        };
        let (motor, load, contacts, stage, sensor) = fitted::start(bench_pins, blocks, &mut rcc);
        let bench = clock.reason_against_bench_mode().is_none().then(|| {
            let tick = timers::Tim5::start(device.TIM5, &mut rcc);
            let monitor = timers::Tim2::start(device.TIM2, &mut rcc);
            watchdog::start(device.IWDG, &device.DBGMCU);
            Bench { motor, load, contacts, stage, sensor, tick, monitor }
        });
        Started { clock, link, usb, bench }
    }

    fn feed_watchdog() {
        // SAFETY: after the start this store is the only access to the registers.
        #[allow(unsafe_code)]
        let watchdog = unsafe { IWDG::steal() };
        watchdog.kr().write(|w| w.key().feed());
    }

    fn disconnect_usb() {
        // SAFETY: interrupts are off, and control never returns to the owner of the port.
        #[allow(unsafe_code)]
        let device = unsafe { OTG_FS_DEVICE::steal() };
        device.dctl().modify(|_, w| w.sdis().set_bit());
    }
}
