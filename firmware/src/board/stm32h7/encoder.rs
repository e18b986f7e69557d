//! A quadrature encoder on a general-purpose timer in encoder mode.

use core::convert::Infallible;
use core::ops::Deref;

use stm32h7xx_hal::hal::digital::v2::InputPin;
use stm32h7xx_hal::pac::tim3::RegisterBlock;
use stm32h7xx_hal::rcc::ResetEnable;

use crate::board::parts::{ENCODER_FILTERS, EncoderInput};

/// The timer of an encoder and the pins of both channels. `INDEX` is the channel of the index pulse, 3 or 4, or 0 without one.
pub struct Encoder<T, A, B, const INDEX: u8 = 0> {
    timer: T,
    a: A,
    b: B,
}

impl<T, A, B, const INDEX: u8> Encoder<T, A, B, INDEX>
where
    T: Deref<Target = RegisterBlock> + Send + 'static,
    A: InputPin<Error = Infallible> + Send + 'static,
    B: InputPin<Error = Infallible> + Send + 'static,
{
    /// Counts every edge of both channels (RM0433 39.3.16). `a` and `b` are connected to channels 1 and 2 of the timer.
    pub(super) fn new((timer, block): (T, impl ResetEnable), (a, b): (A, B)) -> Self {
        let _ = block.enable().reset();
        let mut encoder = Self { timer, a, b };
        encoder.set_filter(0);
        let timer = &encoder.timer;
        timer.ccer.write(|w| {
            w.cc1e().set_bit().cc2e().set_bit();
            w.cc3e().bit(INDEX == 3).cc4e().bit(INDEX == 4)
        });
        timer.smcr.write(|w| w.sms().encoder_mode_3());
        timer.arr.write(|w| w.arr().bits(u16::MAX));
        timer.cr1.write(|w| w.cen().enabled());
        encoder
    }
}

impl<T, A, B, const INDEX: u8> EncoderInput for Encoder<T, A, B, INDEX>
where
    T: Deref<Target = RegisterBlock> + Send + 'static,
    A: InputPin<Error = Infallible> + Send + 'static,
    B: InputPin<Error = Infallible> + Send + 'static,
{
    fn set_filter(&mut self, filter: usize) {
        let Some(code) = ENCODER_FILTERS.get(filter) else { return };
        self.timer.ccmr1_input().write(|w| {
            w.cc1s().ti1().ic1f().bits(*code);
            w.cc2s().ti2().ic2f().bits(*code)
        });
        // The same delay as that of the count, or the pulse would find an older one.
        self.timer.ccmr2_input().write(|w| {
            w.cc3s().ti3().ic3f().bits(*code);
            w.cc4s().ti4().ic4f().bits(*code)
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
    const HAS_INDEX: bool = INDEX != 0;

    fn take_index(&mut self) -> Option<u16> {
        let has_come = match INDEX {
            3 => self.timer.sr.read().cc3if().bit_is_set(),
            4 => self.timer.sr.read().cc4if().bit_is_set(),
            _ => false,
        };
        // Its reading clears the flag.
        has_come.then(|| match INDEX {
            3 => self.timer.ccr3().read().ccr().bits(),
            _ => self.timer.ccr4().read().ccr().bits(),
        })
    }
}
