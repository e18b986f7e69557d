//! An integral with a limit, which doesn't wind up.

use super::arrival::{Phase, REMAINING};

/// The integral with its constants.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integral {
    gain_per_period: f32,
    limit: f32,
    pub(crate) value: f32,
}

impl Integral {
    /// An integral of `gain` per second.
    pub(crate) fn new(gain: f32, limit: f32, period_s: f32) -> Self {
        Self { gain_per_period: gain * period_s, limit, value: 0.0 }
    }

    /// Advances by one sample. `at_limit`: the output, of the sign of the input, is at its limit.
    pub(crate) fn step(&mut self, input: f32, at_limit: bool, phase: Phase) {
        match phase {
            Phase::Approaching if at_limit => {}
            Phase::Approaching => {
                self.value = (self.value + self.gain_per_period * input).clamp(-self.limit, self.limit);
            }
            Phase::Arriving => self.value *= REMAINING,
            Phase::Holding => {}
        }
    }
}
