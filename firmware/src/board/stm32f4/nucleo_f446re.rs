//! A NUCLEO-F446RE: the pins of the bare board, all of them on its headers.
//!
//! | pin | function | connected to |
//! |---|---|---|
//! | PA2, PA3 | USART2 | the serial port of its ST-Link: link, see `link` |
//! | OSC_IN | 8 MHz | a clock of its ST-Link (MB1136 C-02 and later, as delivered) |
//! | others | as in `f405_bare` | |
//!
//! Its USB connector is that of the ST-Link; the chip's own port stays off.

use stm32f4xx_hal::pac::Interrupt;

#[allow(dead_code, reason = "name, chip and clock are others")]
#[path = "f405_bare.rs"]
mod bare;

pub use bare::{Lines, LinkPins, LinkPort, LoadEncoder, MotorEncoder, Sensor, share, start};

/// Name of the board.
pub const NAME: &str = "nucleo-f446re";

/// The chip, as probe-rs names it.
pub const CHIP: &str = "STM32F446RETx";

/// Whether OSC_IN has a clock, and not a crystal.
pub const HAS_CLOCK: bool = true;

/// Interrupt of the link.
pub const LINK: Interrupt = Interrupt::USART2;
/// Interrupt of the converters.
pub const SENSOR: Interrupt = Interrupt::ADC;
