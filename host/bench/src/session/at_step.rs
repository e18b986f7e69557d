//! A message and the control period it speaks of.

use std::ops::Deref;

use lashloop_protocol::sequence;

/// A message whose sequence has been found among the control periods, which are counted on where sequences wrap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtStep<M> {
    /// The control period that it means, from 0 at the start. The last words of a firmware mean none.
    pub step: u32,
    /// The message.
    pub message: M,
}

impl<M> AtStep<M> {
    /// What came while the sample of `step` was the last one sent. A sequence that none of the samples can have had is
    /// left as the drive named it.
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
    fn a_message_is_placed_at_the_step_that_had_its_sequence() {
        let step = |step, sequence| AtStep::near(step, sequence, ()).step;
        assert_eq!([step(0, 0), step(70_000, 4464), step(70_000, 4460)], [0, 70_000, 69_996]);
        assert_eq!(step(65_540, 65_530), 65_530, "late, from before the wrap");
    }

    #[test]
    fn a_sequence_of_no_sample_stays_as_it_was_named() {
        assert_eq!(AtStep::near(5, 65_530, ()).step, 65_530);
    }
}
