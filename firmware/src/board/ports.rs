//! The pins that clock and link leave to bench mode.

use stm32f4xx_hal::gpio::{PA7, PA8, PA9, PA10, gpiob, gpioc, gpiod};

/// Pins of port A, and the other ports.
pub(super) type Ports = ((PA7, PA8, PA9, PA10), gpiob::Parts, gpioc::Parts, gpiod::Parts);
