//! The ports that clock and link leave to the pins of bench mode.

use stm32f4xx_hal::gpio::{PA7, PA8, PA9, PA10, gpiob, gpioc, gpiod};

pub(super) struct Ports {
    pub(super) pa7: PA7,
    pub(super) pa8: PA8,
    pub(super) pa9: PA9,
    pub(super) pa10: PA10,
    pub(super) b: gpiob::Parts,
    pub(super) c: gpioc::Parts,
    pub(super) d: gpiod::Parts,
}
