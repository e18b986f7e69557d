//! Sequence numbers: the control period since `Start`, modulo 2^16, in a sample and in every message that belongs to it.
//!
//! A host counts steps without wraparound and maps a received sequence to its step by [`nearest_step`]. The mapping is unique,
//! because no host continues for more than [`LONGEST_GAP`] periods without an answer.

/// Longest gap between two samples that a drive accepts, in control periods. A drive rejects a sample beyond it as a stray
/// frame; a host without an answer for longer has to restart the drive.
pub const LONGEST_GAP: u16 = 1000;

/// The sequence of a control period, counted from 0 at the `Start`.
#[inline]
#[must_use]
pub const fn of_step(step: u32) -> u16 {
    step as u16
}

/// The step nearest to `step` that has this sequence, from 2^15 before it to 2^15 - 1 after it; `None` if that step is before
/// the `Start`.
#[inline]
#[must_use]
pub const fn nearest_step(sequence: u16, step: u32) -> Option<u32> {
    let ahead = sequence.wrapping_sub(of_step(step)).cast_signed();
    step.checked_add_signed(ahead as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_recovered_from_its_sequence() {
        for step in [32_768, 65_535, 65_536, 65_537, 1_000_000_000, u32::MAX - 32_767] {
            for ahead in [0, 1, -1, 1000, -1000, 32_767, -32_768] {
                let meant = step.checked_add_signed(ahead).expect("a step");
                assert_eq!(nearest_step(of_step(meant), step), Some(meant), "{ahead} from {step}");
            }
        }
    }

    #[test]
    fn no_step_precedes_the_start() {
        assert_eq!(nearest_step(0, 0), Some(0));
        assert_eq!(nearest_step(3, 5), Some(3));
        assert_eq!(nearest_step(65_535, 0), None);
        assert_eq!(nearest_step(65_000, 5), None);
        assert_eq!(nearest_step(65_535, u32::MAX), Some(u32::MAX));
        assert_eq!(nearest_step(0, u32::MAX), None, "nor after the last one");
    }
}
