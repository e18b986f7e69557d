//! A quadrature encoder on a general-purpose timer in encoder mode.

use core::ops::Deref;

use stm32f4xx_hal::gpio::ReadPin;
use stm32f4xx_hal::pac::tim3::RegisterBlock;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::board::parts::EncoderInput;
use crate::input_filter::FILTERS_NS;

/// The filters of [`FILTERS_NS`] in ICxF: 4 and 8 samples at the timer's 84 MHz, 6 and 8 at half of it, then 8 at a 4th, an 8th, a
/// 16th and a 32nd.
const FILTERS: [u8; FILTERS_NS.len()] = [0b0010, 0b0011, 0b0100, 0b0101, 0b0111, 0b1001, 0b1100, 0b1111];

/// The timer of an encoder and the pins of both channels.
pub struct Encoder<T, A, B> {
    timer: T,
    a: A,
    b: B,
}

impl<T: Deref<Target = RegisterBlock> + Enable + Reset, A, B> Encoder<T, A, B> {
    /// Counts every edge of both channels (RM0090 18.3.12). `a` and `b` are connected to channels 1 and 2 of the timer.
    pub(super) fn new(timer: T, (a, b): (A, B), rcc: &mut Rcc) -> Self {
        T::enable(rcc);
        T::reset(rcc);
        timer.ccmr1_input().write(|w| w.cc1s().ti1().cc2s().ti2());
        timer.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit());
        timer.smcr().write(|w| w.sms().encoder_mode_3());
        timer.arr().write(|w| w.arr().set(u16::MAX));
        timer.cr1().write(|w| w.cen().enabled());
        Self { timer, a, b }
    }
}

impl<T, A, B> EncoderInput for Encoder<T, A, B>
where
    T: Deref<Target = RegisterBlock> + Send + 'static,
    A: ReadPin + Send + 'static,
    B: ReadPin + Send + 'static,
{
    fn set_filter(&mut self, filter: usize) {
        let Some(code) = FILTERS.get(filter) else { return };
        self.timer.ccmr1_input().write(|w| {
            w.cc1s().ti1().ic1f().set(*code);
            w.cc2s().ti2().ic2f().set(*code)
        });
    }

    fn count(&self) -> u16 {
        self.timer.cnt().read().cnt().bits()
    }

    fn set_count(&mut self, count: u16) {
        self.timer.cnt().write(|w| w.cnt().set(count));
    }

    fn levels(&self) -> (bool, bool) {
        (self.a.is_high(), self.b.is_high())
    }
}
