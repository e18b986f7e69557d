//! A quadrature encoder on a general-purpose timer in encoder mode.

use core::convert::Infallible;
use core::ops::Deref;

use stm32h7xx_hal::hal::digital::v2::InputPin;
use stm32h7xx_hal::pac::tim3::RegisterBlock;
use stm32h7xx_hal::rcc::ResetEnable;

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

impl<T: Deref<Target = RegisterBlock>, A, B> Encoder<T, A, B> {
    /// Counts every edge of both channels (RM0433 39.3.16). `a` and `b` are connected to channels 1 and 2 of the timer.
    pub(super) fn new((timer, block): (T, impl ResetEnable), (a, b): (A, B)) -> Self {
        let _ = block.enable().reset();
        timer.ccmr1_input().write(|w| w.cc1s().ti1().cc2s().ti2());
        timer.ccer.write(|w| w.cc1e().set_bit().cc2e().set_bit());
        timer.smcr.write(|w| w.sms().encoder_mode_3());
        timer.arr.write(|w| w.arr().bits(u16::MAX));
        timer.cr1.write(|w| w.cen().enabled());
        Self { timer, a, b }
    }
}

impl<T, A, B> EncoderInput for Encoder<T, A, B>
where
    T: Deref<Target = RegisterBlock> + Send + 'static,
    A: InputPin<Error = Infallible> + Send + 'static,
    B: InputPin<Error = Infallible> + Send + 'static,
{
    fn set_filter(&mut self, filter: usize) {
        let Some(code) = FILTERS.get(filter) else { return };
        self.timer.ccmr1_input().write(|w| {
            w.cc1s().ti1().ic1f().bits(*code);
            w.cc2s().ti2().ic2f().bits(*code)
        });
    }

    fn count(&self) -> u16 {
        self.timer.cnt.read().cnt().bits()
    }

    fn set_count(&mut self, count: u16) {
        self.timer.cnt.write(|w| w.cnt().bits(count));
    }

    fn levels(&self) -> (bool, bool) {
        let (Ok(a), Ok(b)) = (self.a.is_high(), self.b.is_high());
        (a, b)
    }
}
