//! A quadrature encoder on a general-purpose timer in encoder mode.

use core::ops::Deref;

use stm32f4xx_hal::gpio::ReadPin;
use stm32f4xx_hal::pac::tim3::RegisterBlock;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::drive::EncoderReading;
use crate::input_filter::{FILTERS_NS, filter_for};
use crate::quadrature::{QuadratureCounter, Sampled};

/// The filters of [`FILTERS_NS`] in ICxF: 4 and 8 samples at the timer's 84 MHz, 6 and 8 at half of it, then 8 at a 4th, an 8th, a
/// 16th and a 32nd.
const FILTERS: [u8; FILTERS_NS.len()] = [0b0010, 0b0011, 0b0100, 0b0101, 0b0111, 0b1001, 0b1100, 0b1111];

/// One encoder: its timer and the pins of both channels.
pub(super) struct Encoder<T, A, B> {
    timer: T,
    a: A,
    b: B,
    counter: QuadratureCounter,
    /// Index of the filter in force.
    filter: usize,
    /// Core cycles from a level at a pin to its count, or more.
    pin_to_count_cycles: u32,
}

impl<T: Deref<Target = RegisterBlock> + Enable + Reset, A: ReadPin, B: ReadPin> Encoder<T, A, B> {
    /// Counts every edge of both channels (RM0090 18.3.12). `a` and `b` are connected to channels 1 and 2 of the timer.
    pub(super) fn new(timer: T, (a, b): (A, B), rcc: &mut Rcc) -> Self {
        T::enable(rcc);
        T::reset(rcc);
        let mut encoder =
            Self { timer, a, b, counter: QuadratureCounter::default(), filter: 0, pin_to_count_cycles: 0 };
        encoder.configure(0);
        let timer = &encoder.timer;
        timer.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit());
        timer.smcr().write(|w| w.sms().encoder_mode_3());
        timer.arr().write(|w| w.arr().set(u16::MAX));
        timer.cr1().write(|w| w.cen().enabled());
        encoder
    }

    /// Sets the shortest filter that stops pulses of this length; without one the drive doesn't arm. The count of an encoder at rest
    /// stays.
    pub(super) fn set_filter(&mut self, pulse_ns: u32) {
        if let Some(filter) = filter_for(&FILTERS_NS, pulse_ns)
            && filter != self.filter
        {
            let count = self.count();
            self.configure(filter);
            // A filter starts at low levels; it takes what follows for a motion.
            cortex_m::asm::delay(self.pin_to_count_cycles);
            self.timer.cnt().write(|w| w.cnt().set(count));
        }
    }

    fn configure(&mut self, filter: usize) {
        let (Some(code), Some(filter_ns)) = (FILTERS.get(filter), FILTERS_NS.get(filter)) else { return };
        self.timer.ccmr1_input().write(|w| {
            w.cc1s().ti1().ic1f().set(*code);
            w.cc2s().ti2().ic2f().set(*code)
        });
        // The filter at 168 MHz, a quarter of it for the phase of its samples, and the synchronisation.
        self.pin_to_count_cycles = (filter_ns * (0.168 * 1.25)) as u32 + 10;
        self.filter = filter;
    }

    pub(super) fn read(&mut self) -> EncoderReading {
        let counter = self.count();
        let levels = self.levels();
        cortex_m::asm::delay(self.pin_to_count_cycles);
        let levels_after = self.levels();
        self.counter.read(&Sampled { counter, levels, levels_after, counter_after: self.count() })
    }

    fn levels(&self) -> (bool, bool) {
        (self.a.is_high(), self.b.is_high())
    }

    fn count(&self) -> u16 {
        self.timer.cnt().read().cnt().bits()
    }
}
