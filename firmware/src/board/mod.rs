//! The STM32F405 and its relatives: all register access.
//!
//! One image serves the chip and QEMU's `netduinoplus2`, which models the core, SysTick and the USARTs but neither
//! the clock tree nor the timers. [`start`] alone distinguishes the two, at run time.
//!
//! On silicon the drive has pins too: encoders, a power stage, and a timer as tick. The emulator has none of them, so the
//! drive doesn't offer bench mode there. Each board has a file with its pins; a feature selects it, in `fitted`.
//!
//! [`image!`](crate::image) makes a program of the board and a set of laws.

#[cfg(not(feature = "board-odrive-v3"))]
mod amplifier;
mod bench;
mod clock_tree;
mod crystal;
mod device_clock;
mod encoder;
mod entry;
#[cfg(not(any(feature = "board-odrive-v3", feature = "board-nucleo-f429zi")))]
mod f405_bare;
mod fault_handlers;
mod fitted;
#[cfg(feature = "board-odrive-v3")]
mod gate_driver;
mod image;
mod last_resort;
mod link;
pub mod loader;
#[cfg(feature = "board-nucleo-f429zi")]
mod nucleo_f429zi;
#[cfg(feature = "board-nucleo-f446re")]
mod nucleo_f446re;
#[cfg(feature = "board-odrive-v3")]
mod odrive_v3;
mod ports;
mod pwm_stage;
mod stack_guard;
mod tick_monitor;
mod usb_port;

pub use cortex_m;
pub use rtic;
pub use stm32f4xx_hal::pac;

pub use bench::{Stage, Tick};
pub use device_clock::{DeviceClock, Ticker};
pub use link::{LineError, UsartInterrupt};
pub use tick_monitor::TickMonitor;

use cortex_m::peripheral::{MPU, SYST};
use lashloop_protocol::enums::LogLevel;
use stm32f4xx_hal::pac::{DBGMCU, Peripherals};

use crate::drive::Drive;
use crate::law::LawSet;
use clock_tree::Source;
use link::Transmission;
use ports::Ports;
use stm32f4xx_hal::timer::TimerExt;

/// The lines of the board.
pub type Lines = crate::usb::Lines<'static, link::Usart, usb_port::Bus>;

/// What the lines need for as long as the firmware runs.
pub struct Memory {
    queues: link::Queues,
    usb: usb_port::UsbMemory,
}

impl Memory {
    /// Before the start.
    #[must_use]
    pub const fn new() -> Self {
        Self { queues: link::Queues::new(), usb: usb_port::UsbMemory::new() }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

/// The started board: clocks run, the link receives.
pub struct Board<L: LawSet> {
    /// The drive, as after power-up.
    pub drive: Drive<L>,
    /// The power stage, the tick for the task of TIM5, and its monitor for that of TIM2; `None` in the emulator.
    pub bench: Option<(Stage, (Tick, TickMonitor))>,
    /// The clock, for the tasks that need device time.
    pub clock: DeviceClock,
    /// The counter of the clock, for the task of SysTick.
    pub ticker: Ticker,
    /// The receiver and the transmitter, for the task of its port.
    pub usart: UsartInterrupt,
    /// The lines, for the task that serves the drive.
    pub lines: Lines,
}

/// Starts the board within 0.2 s, with or without a crystal.
pub fn start<L: LawSet>(
    (syst, mpu): (SYST, &MPU),
    device: Peripherals,
    memory: &'static mut Memory,
) -> Board<L> {
    let emulated = is_emulated(&device.DBGMCU);
    if !emulated {
        loader::follow_request(&device.RCC, &device.SYSCFG);
    }
    // After the loader, whose own variables are there.
    stack_guard::start(mpu);
    let (mut rcc, source) = clock_tree::start(device.RCC, &device.TIM5, emulated);
    let ports = Ports::new((device.GPIOA, device.GPIOB, device.GPIOC, device.GPIOD, device.GPIOE), &mut rcc);
    let (link, usb_pins, bench_pins) = fitted::share(ports, (device.USART2, device.USART3));
    let Memory { queues, usb } = memory;
    let transmission = if emulated { Transmission::Polling } else { Transmission::Interrupt };
    let (usart, uart) = link::open(link, &mut rcc, queues, transmission);
    let usb = match source {
        Source::Crystal => {
            let core = (device.OTG_FS_GLOBAL, device.OTG_FS_DEVICE, device.OTG_FS_PWRCLK);
            usb_port::open(core, usb_pins, &mut rcc, usb)
        }
        Source::Emulator | Source::InternalOscillator(_) => None,
    };
    let lines = Lines::new(uart, usb);
    let (clock, ticker) = device_clock::start(syst);
    let (drive, bench) = match source {
        Source::Emulator => (Drive::with_laws("stm32f405-qemu"), None),
        Source::Crystal | Source::InternalOscillator(_) => {
            let timers = (device.TIM1, device.TIM3, device.TIM4, device.SPI3);
            let (motor, load, stage) = fitted::start(bench_pins, timers, &mut rcc);
            let reason = match source {
                // Its periods are too inaccurate for a motor, and nothing would notice that it drifts.
                Source::InternalOscillator(why) => Some(why.text()),
                // A core that waits at a breakpoint turns no motor off in time.
                _ if cfg!(feature = "debug") => Some("image for a debugger: no bench mode"),
                _ => None,
            };
            if let Some(reason) = reason {
                let mut drive = Drive::with_laws(fitted::NAME).with_loader();
                drive.log(LogLevel::Warning, &[reason]);
                (drive, None)
            } else {
                let drive = Drive::with_pins(fitted::NAME, bench::HARDWARE).with_loader();
                let timer = device.TIM5.counter(&mut rcc);
                let tick = Tick::start(timer, (motor, load), clock, drive.period());
                let monitor = TickMonitor::start(device.TIM2, &mut rcc);
                last_resort::start(device.IWDG, &device.DBGMCU);
                (drive, Some((Stage::new(stage), (tick, monitor))))
            }
        }
    };
    Board { drive, bench, clock, ticker, usart, lines }
}

/// Whether this is QEMU, which has no chip identity: it reads 0, never on silicon (RM0090 38.6.1).
fn is_emulated(dbgmcu: &DBGMCU) -> bool {
    dbgmcu.idcode().read().bits() == 0
}
