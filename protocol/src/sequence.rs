//! The number that a sample and all that belongs to it carry: which control period since the `Start`, modulo 2^16.
//!
//! A host that counts its periods further finds the period that a message means by [`nearest_step`]: no host goes on for
//! more than [`LONGEST_GAP`] periods without an answer, so what comes back is no older than that.

/// Control periods after which a drive takes a sample at the latest; beyond that its sequence is taken for a stray frame. A
/// host that has had no answer for longer has to start the drive anew, long before sequences come round again.
pub const LONGEST_GAP: u16 = 1000;

/// The sequence of a control period, counted from 0 at the `Start`.
#[inline]
#[must_use]
pub const fn of_step(step: u32) -> u16 {
    step as u16
}

/// The control period that `sequence` stands for, if it is one of the 2^16 around `step`, half of them before it; `None`
/// if that is before the `Start`, so that no sample can have had it.
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
    fn a_step_is_found_again_from_its_sequence() {
        for step in [32_768, 65_535, 65_536, 65_537, 1_000_000_000, u32::MAX - 32_767] {
            for ahead in [0, 1, -1, 1000, -1000, 32_767, -32_768] {
                let meant = step.checked_add_signed(ahead).expect("a step");
                assert_eq!(nearest_step(of_step(meant), step), Some(meant), "{ahead} from {step}");
            }
        }
    }

    #[test]
    fn before_the_start_there_is_no_step() {
        assert_eq!(nearest_step(0, 0), Some(0));
        assert_eq!(nearest_step(3, 5), Some(3));
        assert_eq!(nearest_step(65_535, 0), None);
        assert_eq!(nearest_step(65_000, 5), None);
        assert_eq!(nearest_step(65_535, u32::MAX), Some(u32::MAX));
        assert_eq!(nearest_step(0, u32::MAX), None, "nor after the last one");
    }
}
