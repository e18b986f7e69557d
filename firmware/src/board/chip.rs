//! The seam between the drive and a chip: what a chip family has to have. Everything else of the board is the same on each.
//!
//! The interrupts TIM2, TIM5, EXTI0 and OTG_FS have these names in every family: `image!` binds tasks to them.
//!
//! A family is a folder: an implementation of [`Chip`] with its [`parts`](super::parts), and a file per board with its pins. The folder
//! of the fitted board is the only code with registers of peripherals; the processor's own are used outside too.

use cortex_m::interrupt::InterruptNumber;
use usb_device::bus::UsbBus;

use super::clock_source::ClockSource;
use super::parts::{
    BridgeSensor, ContactInputs, EncoderInput, PeriodTimer, PwmTimer, Receiver, StageLines, Transmitter,
};
use super::pwm_stage::PwmStage;
use super::usb_port::UsbMemory;
use crate::store::Memory;
use crate::usb::UsbLine;

/// A chip family, with the board that is fitted.
pub trait Chip: Sized + 'static {
    /// All peripherals.
    type Peripherals;
    /// Interrupts of the chip.
    type Interrupt: InterruptNumber;
    /// Receiver of the link.
    type Receiver: Receiver;
    /// Transmitter of the link.
    type Transmitter: Transmitter;
    /// Driver of the USB port.
    type Usb: UsbBus;
    /// Counter of the motor encoder.
    type MotorEncoder: EncoderInput;
    /// Counter of the load encoder.
    type LoadEncoder: EncoderInput;
    /// Inputs for contacts.
    type Contacts: ContactInputs;
    /// Timer of the power stage.
    type Pwm: PwmTimer;
    /// The board's lines to its power stage.
    type StageLines: StageLines;
    /// The board's sensor of the current of a bridge, and of its bus.
    type Sensor: BridgeSensor;
    /// Timer of the tick; its interrupt is TIM5.
    type Tick: PeriodTimer;
    /// Timer of the monitor; its interrupt is TIM2.
    type Monitor: PeriodTimer;

    /// The memory of the store.
    const STORE: &'static dyn Memory;
    /// Name of the board.
    const BOARD: &'static str;
    /// The chip, as probe-rs names it.
    const CHIP: &'static str;
    /// Interrupt of the link.
    const LINK: Self::Interrupt;
    /// Interrupt of the bridge's sensor.
    const SENSOR: Self::Interrupt;
    /// Start of the boot loader in ROM (ST AN2606).
    const ROM: u32;
    /// Where the loader's interrupt vectors are once [`Self::show_rom`] has been called.
    const ROM_VECTORS: u32;

    /// Whether this is QEMU, with neither clock tree nor timers.
    fn is_emulated(device: &Self::Peripherals) -> bool;

    /// Whether the independent watchdog caused the last reset. The chip forgets the cause, which it would otherwise keep until power
    /// goes.
    fn take_watchdog_reset(device: &Self::Peripherals) -> bool;

    /// Maps the ROM to where the loader expects it.
    fn show_rom(device: &Self::Peripherals);

    /// Starts the chip within 0.2 s, with or without a crystal: clocks, link, pins with the power stage off, and where the clock
    /// allows bench mode its timers and the independent watchdog.
    fn start(
        device: Self::Peripherals,
        is_emulated: bool,
        usb: &'static mut UsbMemory<Self::Usb>,
    ) -> Started<Self>;

    /// Restarts the timeout of the independent watchdog, which has to run.
    fn feed_watchdog();

    /// Disconnects the device from the USB, whose port has to be open, from any code.
    fn disconnect_usb();
}

/// A started chip.
pub struct Started<C: Chip> {
    /// Source of its clock.
    pub clock: ClockSource,
    /// The link, which receives.
    pub link: (C::Receiver, C::Transmitter),
    /// The USB port, if the chip's core is known and its clock exact.
    pub usb: Option<UsbLine<'static, C::Usb>>,
    /// Bench mode; `None` without an exact clock.
    pub bench: Option<Bench<C>>,
}

/// Pins and timers of bench mode, and a running watchdog.
pub struct Bench<C: Chip> {
    /// Counter of the motor encoder.
    pub motor: C::MotorEncoder,
    /// Counter of the load encoder.
    pub load: C::LoadEncoder,
    /// Inputs for contacts.
    pub contacts: C::Contacts,
    /// The power stage, off.
    pub stage: PwmStage<C::Pwm, C::StageLines>,
    /// The sensor of the bridge.
    pub sensor: C::Sensor,
    /// The timer of the tick.
    pub tick: C::Tick,
    /// The timer of the monitor.
    pub monitor: C::Monitor,
}
