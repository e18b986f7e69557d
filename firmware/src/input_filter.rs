//! The filters of the inputs of an encoder: pulses that they stop are noise.

/// A filter that takes a new level after some samples of it in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputFilter {
    /// Pulses up to this length never pass, ns: they have a sample less.
    pub stops_ns: f32,
    /// Levels from this length on always pass, ns. Between the two it depends on the phase of the samples.
    pub passes_ns: f32,
}

impl InputFilter {
    const fn of(samples: u8, sample_ns: f32) -> Self {
        Self { stops_ns: (samples - 1) as f32 * sample_ns, passes_ns: samples as f32 * sample_ns }
    }
}

/// A cycle of the timers of an STM32F405, at 84 MHz.
const CYCLE_NS: f32 = 1e3 / 84.0;

/// The input filters of an STM32F405, ascending (RM0090 18.4.7).
pub const FILTERS: [InputFilter; 8] = [
    InputFilter::of(4, CYCLE_NS),
    InputFilter::of(8, CYCLE_NS),
    InputFilter::of(6, 2.0 * CYCLE_NS),
    InputFilter::of(8, 2.0 * CYCLE_NS),
    InputFilter::of(8, 4.0 * CYCLE_NS),
    InputFilter::of(8, 8.0 * CYCLE_NS),
    InputFilter::of(8, 16.0 * CYCLE_NS),
    InputFilter::of(8, 32.0 * CYCLE_NS),
];

/// Index of the shortest of these filters that stops pulses of up to this length.
#[must_use]
pub fn filter_for(filters: &[InputFilter], pulse_ns: u32) -> Option<usize> {
    filters.iter().position(|filter| filter.stops_ns >= pulse_ns as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_for_a_pulse_is_the_shortest_that_stops_it() {
        let of = |pulse_ns| filter_for(&FILTERS, pulse_ns);
        for (pulse_ns, want) in [(0, 0), (35, 0), (36, 1), (83, 1), (84, 2), (119, 2), (120, 3), (2666, 7)] {
            assert_eq!(of(pulse_ns), Some(want), "{pulse_ns}");
        }
        assert_eq!(of(2667), None);
    }

    #[test]
    fn a_level_that_passes_is_one_sample_longer_than_a_pulse_that_does_not() {
        let samples = FILTERS.map(|it| (it.passes_ns / (it.passes_ns - it.stops_ns)).round());
        assert_eq!(samples, [4.0, 8.0, 6.0, 8.0, 8.0, 8.0, 8.0, 8.0]);
    }
}
