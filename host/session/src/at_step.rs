//! A message and the control period it refers to.

use std::ops::Deref;

use lashloop_protocol::sequence;

/// A message with the control period of its sequence number. Periods count on where sequence numbers wrap around.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtStep<M> {
    /// Control period from 0 at the start of the drive. Of no meaning in the fault report of a panicked firmware.
    pub step: u32,
    /// The message.
    pub message: M,
}

impl<M> AtStep<M> {
    /// A message received while the sample of `step` was the last one sent. A sequence number of no sample is kept as it
    /// is.
    pub(crate) fn near(step: u32, sequence: u16, message: M) -> Self {
        Self { step: sequence::nearest_step(sequence, step).unwrap_or(sequence.into()), message }
    }
}

impl<M> Deref for AtStep<M> {
    type Target = M;

    fn deref(&self) -> &M {
        &self.message
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_gets_the_step_of_its_sequence_number() {
        let step = |step, sequence| AtStep::near(step, sequence, ()).step;
        assert_eq!([step(0, 0), step(70_000, 4464), step(70_000, 4460)], [0, 70_000, 69_996]);
        assert_eq!(step(65_540, 65_530), 65_530, "late, from before the wraparound");
    }

    #[test]
    fn a_sequence_number_of_no_sample_is_kept() {
        assert_eq!(AtStep::near(5, 65_530, ()).step, 65_530);
    }
}
