//! The ports with pins in use, and the serial ports, for the file of a board to share out.

use stm32f4xx_hal::gpio::{GpioExt, gpioa, gpiob, gpioc, gpiod, gpioe};
use stm32f4xx_hal::pac::{
    ADC_COMMON, ADC1, GPIOA, GPIOB, GPIOC, GPIOD, GPIOE, SPI3, TIM1, TIM3, TIM4, USART2, USART3,
};
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

/// The blocks of bench mode.
#[allow(dead_code, reason = "no board uses all of them")]
pub(super) struct Blocks {
    pub(super) pwm: TIM1,
    pub(super) motor: TIM3,
    pub(super) load: TIM4,
    pub(super) spi3: SPI3,
    pub(super) adc: (ADC1, ADC_COMMON),
}
