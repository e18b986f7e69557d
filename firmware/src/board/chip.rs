//! The seam between the drive and a chip: what a chip family has to have. Everything else of the board is the same on each.
//!
//! A family is a folder: an implementation of [`Chip`], and a file per board with its pins. The folder of the fitted board is the
//! only code with registers of peripherals; the processor's own are used outside too.

use cortex_m::interrupt::InterruptNumber;
use usb_device::bus::UsbBus;

use super::clock_source::ClockSource;
use super::link::LineError;
use super::pwm_stage::{PwmStage, StageLines};
use super::usb_port::UsbMemory;
use crate::usb::UsbLine;

/// Core clock of every family, Hz: the maximum of the STM32F405, and the rate of SysTick in QEMU. So every time of the drive is
/// the same on each.
pub const CORE_HZ: u32 = 168_000_000;

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
    /// Timer of the power stage.
    type Pwm: PwmTimer;
    /// The board's lines to its power stage.
    type StageLines: StageLines;
    /// Timer of the tick; its interrupt is TIM5.
    type Tick: PeriodTimer;
    /// Timer of the monitor; its interrupt is TIM2.
    type Monitor: PeriodTimer;

    /// Name of the board.
    const BOARD: &'static str;
    /// The chip, as probe-rs names it.
    const CHIP: &'static str;
    /// Interrupt of the link.
    const LINK: Self::Interrupt;
    /// Interrupt of the task that serves the drive: that of the USB port.
    const SERVE: Self::Interrupt;
    /// Start of the boot loader in ROM (ST AN2606).
    const ROM: u32;
    /// Where the loader's interrupt vectors are once [`Self::show_rom`] has been called.
    const ROM_VECTORS: u32;

    /// Whether this is QEMU, with neither clock tree nor timers.
    fn is_emulated(device: &Self::Peripherals) -> bool;

    /// Maps the ROM to where the loader expects it.
    fn show_rom(device: &Self::Peripherals);

    /// Starts the chip within 0.2 s, with or without a crystal: clocks, link, pins with the power stage off, and where the clock
    /// allows bench mode its timers and the independent watchdog.
    fn start(
        device: Self::Peripherals,
        is_emulated: bool,
        usb: &'static mut UsbMemory<Self::Usb>,
    ) -> Started<Self>;

    /// Restarts the independent watchdog once it runs.
    fn feed_watchdog();

    /// Disconnects the device from the USB, from any code.
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
    /// The power stage, off.
    pub stage: PwmStage<C::Pwm, C::StageLines>,
    /// The timer of the tick.
    pub tick: C::Tick,
    /// The timer of the monitor.
    pub monitor: C::Monitor,
}

/// Takes bytes from the line, 8N1.
pub trait Receiver: Send + 'static {
    /// The byte that has come, if one has. Clears what raised the interrupt.
    ///
    /// # Errors
    /// A byte was lost: overrun, framing error or noise.
    fn read(&mut self) -> Result<Option<u8>, LineError>;
}

/// Puts bytes on the line, 8N1.
pub trait Transmitter: Send + 'static {
    /// Whether a byte can be written.
    fn is_empty(&self) -> bool;

    /// Writes a byte, while [`Self::is_empty`].
    fn write(&mut self, byte: u8);

    /// Raises the interrupt while a byte can be written, or stops doing so.
    fn interrupt_when_empty(&mut self, does: bool);

    /// Writes a byte from any code, if one can be written. Returns whether it has.
    fn write_from_any_code(byte: u8) -> bool;
}

/// A quadrature encoder: a counter of every edge of both channels, 16 bits, and its pins.
pub trait EncoderInput: Send + 'static {
    /// Selects the filter of both channels by its index in [`FILTERS_NS`](crate::input_filter::FILTERS_NS).
    fn set_filter(&mut self, filter: usize);

    /// The count.
    fn count(&self) -> u16;

    /// Sets the count.
    fn set_count(&mut self, count: u16);

    /// Levels of channels A and B at the pins.
    fn levels(&self) -> (bool, bool);
}

/// Pulse-width modulation with two channels, their complements, and a break input: a timer at [`CORE_HZ`]. While the main output is
/// off, outputs have their idle level, low, and are no open pins; a break turns off without a clock, and only software turns on
/// again.
pub trait PwmTimer: Send + 'static {
    /// Selects the period in counts and cycles per count, and which outputs are driven, while the main output is off.
    fn select(&mut self, cycles_per_count: u16, counts: u16, outputs: Outputs);

    /// The count.
    fn count(&self) -> u16;

    /// Sets the high times of both channels in counts. Both take effect at one update, and none comes in between.
    fn set_high(&mut self, first: u16, second: u16);

    /// Makes what has been set take effect at once, in a new period.
    fn update(&mut self);

    /// Turns the main output on. To be called with interrupts masked.
    fn enable_outputs(&mut self);

    /// Whether a break has come since the last call.
    fn take_break(&mut self) -> bool;

    /// Turns the main output off, from any code. Before the start of the timer it is off, and this has no effect.
    fn disable_outputs();
}

/// Which outputs of the modulation are driven, besides channel 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outputs {
    /// Channel 2.
    pub has_second: bool,
    /// The complements of both channels.
    pub has_complements: bool,
}

/// A timer that counts microseconds and raises its interrupt after each period.
pub trait PeriodTimer: Send + 'static {
    /// Counts from 0 to a new period, us. Raises no interrupt by itself.
    fn restart(&mut self, period_us: u32);

    /// Microseconds since the last period, or restart.
    fn count_us(&self) -> u32;

    /// Whether a period has ended since the last [`Self::clear`].
    fn has_ended(&self) -> bool;

    /// Clears what raised the interrupt.
    fn clear(&mut self);
}
