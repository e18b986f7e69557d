//! A 16-bit hardware counter of quadrature edges, extended to the counts of the drive and compared with its channels.
//!
//! A counter that counts every edge of both channels is in step with them: of its two lowest bits and of the channels'
//! phase, each follows from the other, but for a constant. If both channels change at once, the counter can't know the
//! direction; from then on the constant differs by two. An edge between the reading of the counter and that of the channels
//! makes a difference of one, which we ignore.

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
    /// Phase of the channels less the count, modulo 4.
    offset: u16,
}

impl QuadratureCounter {
    /// Takes a reading of the counter and of the levels of both channels. A leads B while the count rises.
    pub fn read(&mut self, hardware: u16, a: bool, b: bool) -> EncoderReading {
        let offset = phase(a, b).wrapping_sub(hardware) & 3;
        let last = self.last.unwrap_or(Last {
            hardware,
            counts: EncoderCounts::wrapping(i64::from(hardware as i16)),
            offset,
        });
        let moved = i32::from(hardware.wrapping_sub(last.hardware) as i16);
        let counts = last.counts.wrapping_add(moved);
        let slipped = offset.wrapping_sub(last.offset) & 3 == 2;
        if slipped {
            self.illegal_transitions = self.illegal_transitions.saturating_add(1);
        }
        let offset = if slipped { offset } else { last.offset };
        self.last = Some(Last { hardware, counts, offset });
        EncoderReading { counts, illegal_transitions: self.illegal_transitions }
    }
}

/// Quarter of the period of the channels, 0 to 3, rising with the count.
fn phase(a: bool, b: bool) -> u16 {
    match (a, b) {
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

    fn read(counter: &mut QuadratureCounter, position: i64, lag: i64) -> EncoderReading {
        let (a, b) = channels(position);
        counter.read((position - lag) as u16, a, b)
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
    fn an_edge_between_the_two_readings_is_no_illegal_transition() {
        let mut counter = QuadratureCounter::default();
        for (position, lag) in (0..100).zip([0, 1, -1, 0, 1].into_iter().cycle()) {
            assert_eq!(read(&mut counter, position, lag).illegal_transitions, 0, "at {position}");
        }
    }
}
