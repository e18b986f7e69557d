//! The ports with pins in use and the timers at pins, for the file of a board to share out.

use stm32h7xx_hal::gpio::{gpioa, gpioc, gpiod, gpioe};
use stm32h7xx_hal::pac::{TIM1, TIM3, TIM4};
use stm32h7xx_hal::rcc::rec;

/// Each with its clock enabled.
pub(super) struct Ports {
    pub(super) a: gpioa::Parts,
    pub(super) c: gpioc::Parts,
    pub(super) d: gpiod::Parts,
    pub(super) e: gpioe::Parts,
}

/// Each with its reset and clock.
pub(super) struct Timers {
    pub(super) tim1: (TIM1, rec::Tim1),
    pub(super) tim3: (TIM3, rec::Tim3),
    pub(super) tim4: (TIM4, rec::Tim4),
}
