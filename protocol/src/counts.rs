//! Encoder counts on the wire: 24 bits with wraparound.

use crate::layout::FieldType;
use crate::wire::Wire;

/// Reading of an encoder, modulo 2^24: two's complement, 3 bytes on the wire.
///
/// Positions that differ by 2^24 counts give the same reading. Only the difference of two readings gives the travel of an
/// encoder, provided that it is less than 2^23 counts. The first reading after a start defines the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct EncoderCounts(i32);

impl EncoderCounts {
    /// Bits of a reading.
    pub const BITS: u32 = 24;
    /// The largest reading; one count further is [`Self::MIN`].
    pub const MAX: Self = Self((1 << (Self::BITS - 1)) - 1);
    /// The smallest reading.
    pub const MIN: Self = Self(-1 << (Self::BITS - 1));

    /// The reading at position `counts`, any number of revolutions from zero.
    #[inline]
    #[must_use]
    pub const fn wrapping(counts: i64) -> Self {
        Self::of_low_bits(counts as i32)
    }

    /// The reading as a number from -2^23 to 2^23 - 1.
    #[inline]
    #[must_use]
    pub const fn get(self) -> i32 {
        self.0
    }

    /// The reading `counts` further.
    #[inline]
    #[must_use]
    pub const fn wrapping_add(self, counts: i32) -> Self {
        Self::of_low_bits(self.0.wrapping_add(counts))
    }

    /// The shortest travel from `before` to this reading, from -2^23 to 2^23 - 1 counts.
    #[inline]
    #[must_use]
    pub const fn wrapping_sub(self, before: Self) -> i32 {
        Self::of_low_bits(self.0 - before.0).0
    }

    /// The lowest 24 bits, sign-extended.
    #[inline]
    const fn of_low_bits(bits: i32) -> Self {
        let rest = i32::BITS - Self::BITS;
        Self(bits << rest >> rest)
    }
}

impl core::fmt::Display for EncoderCounts {
    fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        self.0.fmt(out)
    }
}

impl Wire for EncoderCounts {
    const LEN: usize = 3;
    const TYPE: FieldType = FieldType::I24;

    #[inline]
    fn put(self, out: &mut [u8]) {
        let [low, middle, high, _] = self.0.to_le_bytes();
        out.copy_from_slice(&[low, middle, high]);
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        let &[low, middle, high] = bytes else { return None };
        Some(Self::of_low_bits(i32::from_le_bytes([low, middle, high, 0])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANGE: i64 = 1 << EncoderCounts::BITS;

    #[test]
    fn positions_a_whole_range_apart_read_the_same() {
        for counts in [0, 1, -1, 8_388_607, -8_388_608] {
            for turns in [0, 1, -1, 300, -300] {
                let read = EncoderCounts::wrapping(counts + turns * RANGE);
                assert_eq!(i64::from(read.get()), counts, "{turns} ranges further");
            }
        }
        assert_eq!(EncoderCounts::wrapping(8_388_608), EncoderCounts::MIN);
        assert_eq!(EncoderCounts::wrapping(-8_388_609), EncoderCounts::MAX);
        assert_eq!(EncoderCounts::wrapping(i64::MIN).get(), 0);
    }

    #[test]
    fn the_difference_of_two_readings_is_the_travel() {
        for from in [0, 8_388_600, -8_388_600, 5 * RANGE + 3] {
            for moved in [0, 1, -1, 8_388_607, -8_388_607, -8_388_608] {
                let [before, after] = [from, from + i64::from(moved)].map(EncoderCounts::wrapping);
                assert_eq!(after.wrapping_sub(before), moved, "from {from}");
                assert_eq!(before.wrapping_add(moved), after, "from {from}");
            }
        }
        assert_eq!(EncoderCounts::wrapping(0).wrapping_add(i32::MAX), EncoderCounts::wrapping(-1));
    }

    #[test]
    fn three_bytes_hold_every_reading() {
        for (counts, bytes) in [
            (0, [0, 0, 0]),
            (-2, [0xfe, 0xff, 0xff]),
            (0x0001_0203, [3, 2, 1]),
            (8_388_607, [0xff, 0xff, 0x7f]),
            (-8_388_608, [0, 0, 0x80]),
        ] {
            let reading = EncoderCounts::wrapping(counts);
            let mut put = [0x55; 3];
            reading.put(&mut put);
            assert_eq!(put, bytes);
            assert_eq!(<EncoderCounts as Wire>::get(&bytes), Some(reading));
        }
    }
}
