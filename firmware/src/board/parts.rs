//! The parts of a chip that the drive uses, each a trait, and what all of them share.

use crate::contact::Contacts;
use crate::input_filter::FILTERS;
use crate::power_stage::{PowerStageFault, StageMode};

/// Core clock of every family, Hz: the maximum of the STM32F405, and the rate of SysTick in QEMU. So every time of the drive is
/// the same on each.
pub const CORE_HZ: u32 = 168_000_000;

/// Bits per second, the default of hosts. The divider gives 913,043 (42 MHz by 46), common USB adapters give 923,077
/// (3 MHz by 3.25): the difference is 1.1 %, and the receiver tolerates 3.3 % (RM0090 30.3.5).
pub const BAUD: u32 = 921_600;

/// Longest time between two restarts of the independent watchdog, at the nominal 32 kHz of the oscillator, which is 17 to 47 kHz: 3.4 to
/// 9.4 ms. SysTick feeds every millisecond.
pub const WATCHDOG_MS: u32 = 5;

/// Polls until a new reload value is in force: five cycles of the oscillator, 0.3 ms at 17 kHz. A poll takes at least 8 cycles
/// of the core.
pub const WATCHDOG_POLLS: u32 = 20_000;

/// The filters of [`FILTERS`] in ICxF: 4 and 8 samples at the timer's 84 MHz, 6 and 8 at half of it, then 8 at a 4th, an 8th, a
/// 16th and a 32nd.
pub const ENCODER_FILTERS: [u8; FILTERS.len()] =
    [0b0010, 0b0011, 0b0100, 0b0101, 0b0111, 0b1001, 0b1100, 0b1111];

/// A received byte was lost: overrun of the port or the queue, framing error or noise.
pub struct LineError;

/// What a board has between timer and motor.
pub trait StageLines: Send + 'static {
    /// What channels 1 and 2 of the timer, and their complements, can be to the power stage; first what they are by default.
    const MODES: &'static [StageMode];

    /// Time in which both switches of a half-bridge are off, in cycles of the timer, up to 127.
    const DEAD_TIME_CYCLES: u8;

    /// Whether a break input switches the outputs off without software while it is high.
    const HAS_BREAK: bool;

    /// Lets the amplifier or the bridge drive.
    fn enable(&mut self);

    /// The fault that the lines show. To be called once per tick, with whether the outputs are off.
    fn fault(&mut self, is_off: bool) -> Option<PowerStageFault>;

    /// Switches a brake resistor at the bus on or off, from any code. A board may have none.
    fn set_brake(_is_on: bool) {}

    /// Switches the stage off, from any code: the main output of the timer, and the board's own lines. Not inlined: tests on virtual
    /// silicon remove this function from the image, and then every cause has to fail.
    fn switch_off();
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

/// A quadrature encoder: a counter of every edge of both channels, 16 bits, its pins, and its index pulse.
pub trait EncoderInput: Send + 'static {
    /// Selects the filter of both channels by its index in [`FILTERS`].
    fn set_filter(&mut self, filter: usize);

    /// The count.
    fn count(&self) -> u16;

    /// Sets the count.
    fn set_count(&mut self, count: u16);

    /// Levels of channels A and B at the pins.
    fn levels(&self) -> (bool, bool);

    /// Whether a further channel of the timer captures the count at the rising edge of an index pulse.
    const HAS_INDEX: bool;

    /// The count at the latest index pulse since the last call.
    fn take_index(&mut self) -> Option<u16>;
}

/// Inputs with pull-ups, each to be closed to ground: enable, both limit switches, home switch.
pub trait ContactInputs: Send + 'static {
    /// The contacts that are closed.
    fn closed(&self) -> Contacts;
}

/// Converters of a bridge's current and of the voltage of its bus, which the timer of the modulation starts in the middle of each
/// period. Their interrupt is that of the task `sample`.
pub trait BridgeSensor: Send + 'static {
    /// Whether the board has them.
    const EXISTS: bool;

    /// Takes the readings, 12 bits each: current, with no current in the middle, and bus. Clears what raised the interrupt.
    fn take(&mut self) -> [u16; 2];

    /// Lets the timer start conversions, or stops it, from any code.
    fn listen(does: bool);
}

/// A board that measures neither.
#[allow(dead_code, reason = "a board may have converters")]
pub struct NoSensor;

impl BridgeSensor for NoSensor {
    const EXISTS: bool = false;

    fn take(&mut self) -> [u16; 2] {
        [0; 2]
    }

    fn listen(_: bool) {}
}

/// Pulse-width modulation with two channels, their complements, and a break input: a timer at [`CORE_HZ`]. While the main output is
/// off, its outputs are driven to their idle level, low; a break turns off without a clock, and only software turns on
/// again.
pub trait PwmTimer: Send + 'static {
    /// Selects the period in counts and cycles per count, and which outputs are driven, while the main output is off. A centred
    /// period counts up and down again: its high times are in the middle, and the bridge's sensor is started halfway between two.
    fn select(&mut self, cycles_per_count: u16, counts: u16, is_centred: bool, outputs: Outputs);

    /// The count.
    fn count(&self) -> u16;

    /// Sets the high times of both channels in counts. Both take effect at one update, and none comes in between.
    fn set_high(&mut self, first: u16, second: u16);

    /// Sets the high times of both channels in counts, from any code. They take effect at the next update, of which none may come in
    /// between.
    fn set_high_from_any_code(first: u16, second: u16);

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
    /// Counts from 0 to a new period of at least 1 us. Raises no interrupt by itself.
    fn restart(&mut self, period_us: u32);

    /// Microseconds since the last period, or restart.
    fn count_us(&self) -> u32;

    /// Whether a period has ended since the last [`Self::clear`].
    fn has_ended(&self) -> bool;

    /// Clears what raised the interrupt.
    fn clear(&mut self);
}
