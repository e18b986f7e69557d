//! Direction of an encoder or of a power stage, as it is wired.

use lashloop_protocol::EncoderCounts;

crate::choices! {
    /// Whether a positive number of the hardware is a positive number of the drive.
    pub enum Direction {
        /// As wired.
        Forward = "forward",
        /// With the opposite sign.
        Reverse = "reverse",
    }
}

impl Direction {
    /// A reading in this direction.
    #[must_use]
    pub const fn of_counts(self, counts: EncoderCounts) -> EncoderCounts {
        match self {
            Self::Forward => counts,
            Self::Reverse => EncoderCounts::wrapping(-(counts.get() as i64)),
        }
    }

    /// A torque in this direction.
    #[must_use]
    pub const fn of_torque(self, torque_nm: f32) -> f32 {
        match self {
            Self::Forward => torque_nm,
            Self::Reverse => -torque_nm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversed_encoder_wraps_at_the_same_range() {
        for (counts, reversed) in [(5, -5), (-1, 1), (8_388_607, -8_388_607), (-8_388_608, -8_388_608)] {
            let reading = EncoderCounts::wrapping(counts);
            assert_eq!(i64::from(Direction::Reverse.of_counts(reading).get()), reversed);
            assert_eq!(Direction::Forward.of_counts(reading), reading);
        }
    }
}
