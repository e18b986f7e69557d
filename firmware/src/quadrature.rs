//! A 16-bit hardware counter of quadrature edges, extended to the counts of the drive and compared with its channels.
//!
//! A counter that counts every edge of both channels is in step with them: of its two lowest bits and of the channels'
//! phase, each follows from the other, but for a constant. If both channels change at once, the counter can't know the
//! direction; from then on the constant differs by two.
//!
//! The counter follows its channels with the delay of its input filter. They are compared only if the counter stood still
//! from before the reading of the channels until that delay after it, and the channels have the same levels then: a pulse that
//! the filter stops is not taken for a level. Otherwise the comparison waits for a later reading.

use lashloop_protocol::EncoderCounts;

use crate::drive::EncoderReading;

/// Largest motion between two readings that a 16-bit counter shows without ambiguity, in counts.
pub const LARGEST_MOVE_COUNTS: u16 = i16::MAX as u16;

/// The counter of one encoder, since its first reading.
#[derive(Debug, Default)]
pub struct QuadratureCounter {
    last: Option<Last>,
    illegal_transitions: u32,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    hardware: u16,
    counts: EncoderCounts,
    /// Phase of the channels minus the count, modulo 4; `None` until the first comparison.
    offset: Option<u16>,
}

/// One reading of the hardware.
#[derive(Debug, Clone, Copy)]
pub struct Sampled {
    /// The counter.
    pub counter: u16,
    /// Levels of the channels A and B after the reading of the counter. A leads B while the count rises.
    pub levels: (bool, bool),
    /// The levels, at least the delay of the input filter later.
    pub levels_after: (bool, bool),
    /// The counter after that.
    pub counter_after: u16,
}

impl QuadratureCounter {
    /// Takes a reading.
    pub fn read(&mut self, sampled: &Sampled) -> EncoderReading {
        let hardware = sampled.counter;
        let first =
            Last { hardware, counts: EncoderCounts::wrapping(i64::from(hardware as i16)), offset: None };
        let last = self.last.unwrap_or(first);
        let moved = i32::from(hardware.wrapping_sub(last.hardware) as i16);
        let counts = last.counts.wrapping_add(moved);
        let mut offset = last.offset;
        if sampled.counter_after == hardware && sampled.levels_after == sampled.levels {
            let present = phase(sampled.levels).wrapping_sub(hardware) & 3;
            if offset.is_some_and(|offset| present.wrapping_sub(offset) & 3 == 2) {
                self.illegal_transitions = self.illegal_transitions.saturating_add(1);
            }
            offset = Some(present);
        }
        self.last = Some(Last { hardware, counts, offset });
        EncoderReading { counts, illegal_transitions: self.illegal_transitions }
    }

    /// The counts at a count of the hardware which is less than half its range from that of the last reading: at an index pulse.
    #[must_use]
    pub fn counts_at(&self, hardware: u16) -> Option<EncoderCounts> {
        let last = self.last?;
        Some(last.counts.wrapping_add(i32::from(hardware.wrapping_sub(last.hardware) as i16)))
    }
}

/// Quarter of the period of the channels, 0 to 3, rising with the count.
fn phase(levels: (bool, bool)) -> u16 {
    match levels {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ideal encoder at a position in counts.
    fn channels(position: i64) -> (bool, bool) {
        [(false, false), (true, false), (true, true), (false, true)][position.rem_euclid(4) as usize]
    }

    /// A counter that lacks `lost` counts, at rest.
    fn read(counter: &mut QuadratureCounter, position: i64, lost: i64) -> EncoderReading {
        let levels = channels(position);
        let hardware = (position - lost) as u16;
        counter.read(&Sampled { counter: hardware, levels, levels_after: levels, counter_after: hardware })
    }

    #[test]
    fn counts_go_on_through_every_wraparound_of_the_hardware() {
        let mut counter = QuadratureCounter::default();
        let there_and_back =
            (0..9_000_000_i64).step_by(32_000).chain((-9_000_000..9_000_000).rev().step_by(31_999));
        for position in there_and_back {
            let reading = read(&mut counter, position, 0);
            let want = EncoderCounts::wrapping(position);
            assert_eq!((reading.counts, reading.illegal_transitions), (want, 0), "at {position}");
        }
    }

    #[test]
    fn a_counter_below_zero_at_its_first_reading_is_negative() {
        let mut counter = QuadratureCounter::default();
        assert_eq!(read(&mut counter, -3, 0).counts.get(), -3);
    }

    #[test]
    fn both_channels_at_once_are_counted_each_time() {
        let mut counter = QuadratureCounter::default();
        for position in 0..100 {
            assert_eq!(read(&mut counter, position, 0).illegal_transitions, 0);
        }
        // The position is two counts further than the counter.
        for position in 100..200 {
            assert_eq!(read(&mut counter, position, 2).illegal_transitions, 1);
        }
        assert_eq!(read(&mut counter, 200, 4).illegal_transitions, 2);
    }

    #[test]
    fn a_counter_that_moves_during_the_reading_is_not_compared() {
        let mut counter = QuadratureCounter::default();
        read(&mut counter, 0, 0);
        // The channels are up to 5 counts ahead of the counter, which has caught up by the second reading of it.
        for (position, lag) in (0..100).zip([1, 3, 5, 2, 4].into_iter().cycle()) {
            let levels = channels(position);
            let sampled = Sampled {
                counter: (position - lag) as u16,
                levels,
                levels_after: levels,
                counter_after: position as u16,
            };
            assert_eq!(counter.read(&sampled).illegal_transitions, 0, "at {position}");
        }
        assert_eq!(read(&mut counter, 100, 0).illegal_transitions, 0);
    }

    #[test]
    fn a_pulse_on_both_channels_that_is_over_by_the_second_look_is_not_compared() {
        let mut counter = QuadratureCounter::default();
        for position in [0, 1, 2, 3] {
            read(&mut counter, position, 0);
            let (levels_after, levels) = (channels(position), channels(position + 2));
            let at = position as u16;
            let sampled = Sampled { counter: at, levels, levels_after, counter_after: at };
            assert_eq!(counter.read(&sampled).illegal_transitions, 0, "at {position}");
        }
    }

    #[test]
    fn an_index_pulse_has_the_counts_of_its_place_across_a_wrap_of_the_hardware() {
        let mut counter = QuadratureCounter::default();
        assert_eq!(counter.counts_at(5), None, "before the first reading");
        // The count of the first reading is signed.
        read(&mut counter, 65_000, 0);
        for (position, index) in [
            (66_000, 65_535),
            (97_000, 65_540),
            // Where a count of 16 bits changes its sign.
            (98_500, 98_200),
            (98_000, 98_400),
            (66_000, 96_999),
            (66_000, 66_003),
        ] {
            read(&mut counter, position, 0);
            assert_eq!(counter.counts_at(index as u16), Some(EncoderCounts::wrapping(index - 65_536)));
        }
    }

    #[test]
    fn counts_lost_in_fast_motion_are_noticed_at_the_next_comparison() {
        let mut counter = QuadratureCounter::default();
        read(&mut counter, 0, 0);
        for position in (10..1_000).step_by(10) {
            let levels = channels(position);
            let lost = 2;
            let sampled = Sampled {
                counter: (position - lost - 3) as u16,
                levels,
                levels_after: levels,
                counter_after: (position - lost) as u16,
            };
            assert_eq!(counter.read(&sampled).illegal_transitions, 0);
        }
        assert_eq!(read(&mut counter, 1_000, 2).illegal_transitions, 1);
    }
}
