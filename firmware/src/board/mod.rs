//! The drive on a microcontroller: all register access.
//!
//! A chip family is a folder, and each of its boards a file with its pins; a feature selects the board. [`chip`] is the seam: what a
//! family has to have. The rest is the same on each.
//!
//! The image of an STM32F405 serves QEMU's `netduinoplus2` too, which models the core, SysTick and the USARTs but neither
//! the clock tree nor the timers; the start alone distinguishes the two, at run time. On silicon the drive has pins too: encoders, a
//! power stage, and a timer as tick. The emulator has none of them, so the drive doesn't offer bench mode there.
//!
//! [`image!`](crate::image) makes a program of the board and a set of laws.

#[allow(dead_code, unused_imports, reason = "a board may have a bridge with lines of its own")]
mod amplifier;
mod bench;
mod bridge_exchange;
mod bridge_loop;
pub mod chip;
mod clock_source;
mod device_clock;
mod encoder;
mod entry;
mod fault_handlers;
mod image;
mod last_resort;
mod link;
pub mod loader;
pub mod parts;
mod pwm_stage;
mod stack_guard;
#[cfg(feature = "stm32f4")]
mod stm32f4;
#[cfg(feature = "stm32h7")]
mod stm32h7;
mod tick_monitor;
mod usb_port;

pub use cortex_m;
pub use rtic;

pub use bench::{Stage, Tick};
pub use bridge_loop::BridgeLoop;
pub use device_clock::{DeviceClock, Ticker};
pub use link::UsartInterrupt;
pub use parts::LineError;
#[cfg(feature = "stm32f4")]
pub use stm32f4::{Stm32f4 as Fitted, pac};
#[cfg(feature = "stm32h7")]
pub use stm32h7::{Stm32h7 as Fitted, pac};
pub use tick_monitor::TickMonitor;

use cortex_m::peripheral::{MPU, SYST};
use lashloop_protocol::enums::LogLevel;

use crate::drive::Drive;
use crate::law::LawSet;
use crate::store::Store;
use chip::{Bench, Chip, Started};
use clock_source::ClockSource;
use link::Transmission;

/// Driver of the USB port.
type Usb = <Fitted as Chip>::Usb;

/// The lines of the board.
pub type Lines = crate::usb::Lines<'static, link::Usart, Usb>;

/// What the lines need for as long as the firmware runs.
pub struct Memory {
    queues: link::Queues,
    usb: usb_port::UsbMemory<Usb>,
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
    /// Bench mode; `None` in the emulator.
    pub bench: Option<BenchTasks>,
    /// The clock, for the tasks that need device time.
    pub clock: DeviceClock,
    /// The counter of the clock, for the task of SysTick.
    pub ticker: Ticker,
    /// The receiver and the transmitter, for the task of its port.
    pub usart: UsartInterrupt,
    /// The lines, for the task that serves the drive.
    pub lines: Lines,
}

/// What the tasks of bench mode need.
pub struct BenchTasks {
    /// The power stage.
    pub stage: Stage,
    /// The tick, for the task of TIM5.
    pub steps: Tick,
    /// The monitor of the tick, for the task of TIM2.
    pub monitor: TickMonitor,
    /// The current loop, for the task of the bridge's sensor.
    pub bridge: BridgeLoop,
}

/// Starts the board within 0.2 s, with or without a crystal; within 2.5 s if the store has to erase a sector.
pub fn start<L: LawSet>(
    (syst, mpu): (SYST, &MPU),
    device: <Fitted as Chip>::Peripherals,
    memory: &'static mut Memory,
) -> Board<L> {
    let is_emulated = Fitted::is_emulated(&device);
    if !is_emulated {
        loader::follow_request(&device);
    }
    let by_watchdog = !is_emulated && Fitted::take_watchdog_reset(&device);
    // After the loader, whose own variables are there.
    stack_guard::start(mpu);
    // Before the watchdog starts: it may erase, for two seconds. All pins are inputs, and the power stage is off.
    let store = (!is_emulated).then(|| Store::open(Fitted::STORE));
    let Memory { queues, usb } = memory;
    let Started { clock: source, link, usb, bench } = Fitted::start(device, is_emulated, usb);
    if bench.is_some() {
        last_resort::note_start();
    }
    let transmission = if is_emulated { Transmission::Polling } else { Transmission::Interrupt };
    let (usart, uart) = link::open(link, queues, transmission);
    let lines = Lines::new(uart, usb);
    let (clock, ticker) = device_clock::start(syst);
    let (mut drive, bench) = match (source, bench) {
        (ClockSource::Emulator, _) => (Drive::with_laws("stm32f405-qemu"), None),
        (_, Some(Bench { motor, load, contacts, stage, sensor, tick, monitor })) => {
            let drive = Drive::with_pins(Fitted::BOARD, bench::HARDWARE).with_loader();
            // A drive without its pins would store a set without their parameters.
            let drive = match store {
                Some(store) => drive.with_store(store),
                None => drive,
            };
            let steps = Tick::start(tick, (motor, load, contacts), clock, drive.period());
            let (monitor, bridge) = (TickMonitor::new(monitor), BridgeLoop::start(sensor));
            (drive, Some(BenchTasks { stage: Stage::new(stage), steps, monitor, bridge }))
        }
        (source, None) => {
            let mut drive = Drive::with_laws(Fitted::BOARD).with_loader();
            if let Some(reason) = source.reason_against_bench_mode() {
                drive.log(LogLevel::Warning, &[reason]);
            }
            (drive, None)
        }
    };
    if by_watchdog {
        drive.log(LogLevel::Warning, &["the watchdog reset the drive"]);
    }
    Board { drive, bench, clock, ticker, usart, lines }
}
