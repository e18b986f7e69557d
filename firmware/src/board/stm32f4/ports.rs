//! The ports with pins in use, and the serial ports, for the file of a board to share out.

use stm32f4xx_hal::gpio::{GpioExt, gpioa, gpiob, gpioc, gpiod, gpioe};
use stm32f4xx_hal::pac::{GPIOA, GPIOB, GPIOC, GPIOD, GPIOE, USART2, USART3};
use stm32f4xx_hal::rcc::Rcc;

/// Each port of pins with its clock enabled.
#[allow(dead_code, reason = "no board has pins at all of them")]
pub(super) struct Ports {
    pub(super) a: gpioa::Parts,
    pub(super) b: gpiob::Parts,
    pub(super) c: gpioc::Parts,
    pub(super) d: gpiod::Parts,
    pub(super) e: gpioe::Parts,
    pub(super) usart2: USART2,
    pub(super) usart3: USART3,
}

impl Ports {
    pub(super) fn new(
        (a, b, c, d, e): (GPIOA, GPIOB, GPIOC, GPIOD, GPIOE),
        (usart2, usart3): (USART2, USART3),
        rcc: &mut Rcc,
    ) -> Self {
        Self {
            a: a.split(rcc),
            b: b.split(rcc),
            c: c.split(rcc),
            d: d.split(rcc),
            e: e.split(rcc),
            usart2,
            usart3,
        }
    }
}
