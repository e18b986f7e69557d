//! A quadrature encoder on a general-purpose timer in encoder mode.

use core::ops::Deref;

use stm32f4xx_hal::gpio::ReadPin;
use stm32f4xx_hal::pac::tim3::RegisterBlock;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::drive::EncoderReading;
use crate::quadrature::{QuadratureCounter, Sampled};

/// Core cycles from a level at a pin to its count: the 4 samples of the filter and the synchronisation, some 7 cycles of
/// the timer's 84 MHz.
const PIN_TO_COUNT_CYCLES: u32 = 16;

/// Fastest motion that the filter passes: 4 samples are 47.6 ns, and a level of a channel lasts two counts. A 16-bit counter
/// would take more at periods below 0.8 ms.
pub(super) const LARGEST_COUNTS_PER_S: u32 = 41_000_000;

/// One encoder: its timer and the pins of both channels.
pub(super) struct Encoder<T, A, B> {
    timer: T,
    a: A,
    b: B,
    counter: QuadratureCounter,
}

impl<T: Deref<Target = RegisterBlock> + Enable + Reset, A: ReadPin, B: ReadPin> Encoder<T, A, B> {
    /// Counts every edge of both channels (RM0090 18.3.12). `a` and `b` are connected to channels 1 and 2 of the timer.
    pub(super) fn new(timer: T, (a, b): (A, B), rcc: &mut Rcc) -> Self {
        T::enable(rcc);
        T::reset(rcc);
        // 4 samples at the timer's 84 MHz: pulses below 48 ns are noise.
        timer.ccmr1_input().write(|w| {
            w.cc1s().ti1().ic1f().fck_int_n4();
            w.cc2s().ti2().ic2f().fck_int_n4()
        });
        timer.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit());
        timer.smcr().write(|w| w.sms().encoder_mode_3());
        timer.arr().write(|w| w.arr().set(u16::MAX));
        timer.cr1().write(|w| w.cen().enabled());
        Self { timer, a, b, counter: QuadratureCounter::default() }
    }

    pub(super) fn read(&mut self) -> EncoderReading {
        let counter = self.count();
        let (a, b) = (self.a.is_high(), self.b.is_high());
        cortex_m::asm::delay(PIN_TO_COUNT_CYCLES);
        self.counter.read(&Sampled { counter, a, b, counter_after: self.count() })
    }

    fn count(&self) -> u16 {
        self.timer.cnt().read().cnt().bits()
    }
}
