//! The STM32F405: all register access.
//!
//! One image serves the chip and QEMU's `netduinoplus2`, which models the core, SysTick and the USARTs but neither
//! the clock tree nor the timers. [`start`] alone distinguishes the two, at run time.
//!
//! The image outputs its torque over the link only. It configures no pin of a power stage: the gate inputs keep their
//! high impedance after reset, and a panic has no output to switch off.
//!
//! [`image!`](crate::image) makes a program of the board and a set of laws.

mod clock_tree;
mod device_clock;
mod fault_handlers;
mod image;
mod link;

pub use cortex_m;
pub use rtic;
pub use stm32f4xx_hal::pac;

pub use device_clock::{DeviceClock, Ticker};
pub use link::{Inbox, LineError, Outbox, Queue, Receiver};

use lashloop_protocol::enums::LogLevel;
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{DBGMCU, Peripherals, RCC};

use clock_tree::Source;

/// The started board: clocks run, the link receives.
pub struct Board {
    /// Name of the board in the identity.
    pub name: &'static str,
    /// Log line about the start for the host.
    pub notice: Option<(LogLevel, &'static str)>,
    /// The clock, for the task that serves the drive.
    pub clock: DeviceClock,
    /// The counter of the clock, for the task of SysTick.
    pub ticker: Ticker,
    /// The receiver, for the task of USART2.
    pub receiver: Receiver,
    /// The received bytes, for the task that serves the drive.
    pub inbox: Inbox,
    /// The transmitter, for the task that serves the drive.
    pub outbox: Outbox,
}

/// Starts the board within 0.2 s, with or without a crystal.
pub fn start(syst: cortex_m::peripheral::SYST, device: Peripherals, queue: &'static mut Queue) -> Board {
    let emulated = is_emulated(&device.RCC, &device.DBGMCU);
    let (mut rcc, source) = clock_tree::start(device.RCC, emulated);
    let gpioa = device.GPIOA.split(&mut rcc);
    let (receiver, inbox, outbox) = link::open(device.USART2, (gpioa.pa2, gpioa.pa3), &mut rcc, queue);
    let (name, notice) = match source {
        Source::Emulator => ("stm32f405-qemu", None),
        Source::Crystal => ("stm32f405", None),
        Source::InternalOscillator => ("stm32f405", Some((LogLevel::Warning, "no crystal, clock is 1% RC"))),
    };
    let (clock, ticker) = device_clock::start(syst);
    Board { name, notice, clock, ticker, receiver, inbox, outbox }
}

/// Whether this is QEMU, where clock control and chip identity read 0. On silicon the first has the internal
/// oscillator's bits set from reset (RM0090 7.3.1) and the second is never 0 (RM0090 38.6.1).
fn is_emulated(rcc: &RCC, dbgmcu: &DBGMCU) -> bool {
    rcc.cr().read().bits() == 0 && dbgmcu.idcode().read().bits() == 0
}
