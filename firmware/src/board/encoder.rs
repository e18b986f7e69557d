//! A quadrature encoder: its counter between two readings of the levels at its pins.

use lashloop_protocol::EncoderCounts;

use super::parts::{CORE_HZ, EncoderInput};
use crate::drive::EncoderReading;
use crate::input_filter::{FILTERS, InputFilter, filter_for};
use crate::quadrature::{QuadratureCounter, Sampled};

/// One encoder.
pub(super) struct Encoder<I> {
    input: I,
    counter: QuadratureCounter,
    /// Index of the filter in force.
    filter: usize,
    /// Core cycles from a level at a pin to its count, or more.
    pin_to_count_cycles: u32,
}

impl<I: EncoderInput> Encoder<I> {
    pub(super) fn new(input: I) -> Self {
        let mut encoder =
            Self { input, counter: QuadratureCounter::default(), filter: 0, pin_to_count_cycles: 0 };
        encoder.configure(0);
        encoder
    }

    /// Sets the shortest filter that stops pulses of this length; without one the drive doesn't arm. The count of an encoder at rest
    /// stays.
    pub(super) fn set_filter(&mut self, pulse_ns: u32) {
        if let Some(filter) = filter_for(&FILTERS, pulse_ns)
            && filter != self.filter
        {
            let count = self.input.count();
            self.configure(filter);
            // A filter starts at low levels; it takes what follows for a motion.
            cortex_m::asm::delay(self.pin_to_count_cycles);
            self.input.set_count(count);
        }
    }

    fn configure(&mut self, filter: usize) {
        let Some(InputFilter { passes_ns, .. }) = FILTERS.get(filter) else { return };
        self.input.set_filter(filter);
        // The filter, a quarter more as a margin, and the synchronisation.
        self.pin_to_count_cycles = (passes_ns * (CORE_HZ as f32 * 1e-9 * 1.25)) as u32 + 10;
        self.filter = filter;
    }

    pub(super) fn read(&mut self) -> EncoderReading {
        let counter = self.input.count();
        let levels = self.input.levels();
        cortex_m::asm::delay(self.pin_to_count_cycles);
        let levels_after = self.input.levels();
        self.counter.read(&Sampled { counter, levels, levels_after, counter_after: self.input.count() })
    }

    /// The counts at the latest index pulse since the last call. To be called after [`Self::read`].
    pub(super) fn take_index(&mut self) -> Option<EncoderCounts> {
        let at = self.input.take_index()?;
        self.counter.counts_at(at)
    }
}
