//! The ports with pins in use, for the file of a board to share out.

use stm32f4xx_hal::gpio::{GpioExt, gpioa, gpiob, gpioc, gpiod, gpioe};
use stm32f4xx_hal::pac::{GPIOA, GPIOB, GPIOC, GPIOD, GPIOE};
use stm32f4xx_hal::rcc::Rcc;

/// Each with its clock enabled.
#[allow(dead_code, reason = "no board has pins at all of them")]
pub(super) struct Ports {
    pub(super) a: gpioa::Parts,
    pub(super) b: gpiob::Parts,
    pub(super) c: gpioc::Parts,
    pub(super) d: gpiod::Parts,
    pub(super) e: gpioe::Parts,
}

impl Ports {
    pub(super) fn new((a, b, c, d, e): (GPIOA, GPIOB, GPIOC, GPIOD, GPIOE), rcc: &mut Rcc) -> Self {
        Self { a: a.split(rcc), b: b.split(rcc), c: c.split(rcc), d: d.split(rcc), e: e.split(rcc) }
    }
}
