//! The STM32H7 family: H743.
//!
//! The core could run at 480 MHz. It runs at 168 MHz, and so do the timers at their rates on an STM32F405, so that every time of the
//! drive is the same.

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

pub use stm32h7xx_hal::pac;

use pac::{IWDG, Interrupt, OTG2_HS_DEVICE, Peripherals, USART3};
use stm32h7xx_hal::gpio::GpioExt as _;
use stm32h7xx_hal::serial::{Rx, Tx};

use super::chip::{Bench, Chip, Started};
use super::clock_source::ClockSource;
use super::parts::NoSensor;
use super::usb_port::UsbMemory;
use crate::store::Memory;
use ports::{Ports, Timers};

/// A chip of the family on the selected board.
pub struct Stm32h7;

impl Chip for Stm32h7 {
    type Peripherals = Peripherals;
    type Interrupt = Interrupt;
    type Receiver = Rx<USART3>;
    type Transmitter = Tx<USART3>;
    type Usb = usb::Bus;
    type MotorEncoder = fitted::MotorEncoder;
    type LoadEncoder = fitted::LoadEncoder;
    type Contacts = contacts::ContactPins;
    type Pwm = pwm::Tim1;
    type StageLines = fitted::Lines;
    type Sensor = NoSensor;
    type Tick = timers::Tim5;
    type Monitor = timers::Tim2;

    const STORE: &'static dyn Memory = &flash::Flash;
    const BOARD: &'static str = fitted::NAME;
    const CHIP: &'static str = fitted::CHIP;
    const LINK: Interrupt = fitted::LINK;
    const SENSOR: Interrupt = fitted::SENSOR;
    const ROM: u32 = 0x1ff0_9800;
    // Nothing maps the ROM to address 0, where the loader of another family has its vectors.
    const ROM_VECTORS: u32 = Self::ROM;

    fn is_emulated(_device: &Peripherals) -> bool {
        false
    }

    fn take_watchdog_reset(device: &Peripherals) -> bool {
        let is_cause = device.RCC.rsr.read().iwdg1rstf().bit_is_set();
        device.RCC.rsr.modify(|_, w| w.rmvf().set_bit());
        is_cause
    }

    fn show_rom(_device: &Peripherals) {}

    fn start(device: Peripherals, _: bool, usb: &'static mut UsbMemory<usb::Bus>) -> Started<Self> {
        // SAFETY: nothing else uses the register, and no task has run.
        #[allow(unsafe_code)]
        let mut processor = unsafe { cortex_m::Peripherals::steal() };
        // The flash has wait states. Variables are in memory that needs no cache.
        processor.SCB.enable_icache();
        let Peripherals { RCC, PWR, SYSCFG, TIM16, GPIOA, GPIOC, GPIOD, GPIOE, USART3, .. } = device;
        let (tree, clock) = clock_tree::start(RCC, PWR, &SYSCFG, &TIM16);
        let (clocks, blocks) = (tree.clocks, tree.peripheral);
        let ports = Ports {
            a: GPIOA.split(blocks.GPIOA),
            c: GPIOC.split(blocks.GPIOC),
            d: GPIOD.split(blocks.GPIOD),
            e: GPIOE.split(blocks.GPIOE),
        };
        let (link_pins, usb_pins, bench_pins) = fitted::share(ports);
        let link = serial::open((USART3, blocks.USART3), link_pins, &clocks);
        let usb = (clock == ClockSource::Crystal)
            .then(|| {
                let core = (device.OTG2_HS_GLOBAL, device.OTG2_HS_DEVICE, device.OTG2_HS_PWRCLK);
                usb::open(core, blocks.USB2OTG, usb_pins, &clocks, usb)
            })
            .flatten();
        let timers = Timers {
            tim1: (device.TIM1, blocks.TIM1),
            tim3: (device.TIM3, blocks.TIM3),
            tim4: (device.TIM4, blocks.TIM4),
        };
        let (motor, load, contacts, stage) = fitted::start(bench_pins, timers);
        let bench = clock.reason_against_bench_mode().is_none().then(|| {
            let tick = timers::Tim5::start(device.TIM5, blocks.TIM5);
            let monitor = timers::Tim2::start(device.TIM2, blocks.TIM2);
            watchdog::start(&device.IWDG, &device.DBGMCU);
            Bench { motor, load, contacts, stage, sensor: NoSensor, tick, monitor }
        });
        Started { clock, link, usb, bench }
    }

    fn feed_watchdog() {
        // SAFETY: after the start this store is the only access to the registers.
        #[allow(unsafe_code)]
        let watchdog = unsafe { &*IWDG::ptr() };
        watchdog.kr.write(|w| w.key().reset());
    }

    fn disconnect_usb() {
        // SAFETY: interrupts are off, and control never returns to the owner of the port.
        #[allow(unsafe_code)]
        let device = unsafe { &*OTG2_HS_DEVICE::ptr() };
        device.dctl.modify(|_, w| w.sdis().set_bit());
    }
}
