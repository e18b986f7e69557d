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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integral_rests_at_the_limit_of_the_output_and_is_unloaded_once() {
        let mut integral = Integral::new(2.0, 5.0, 0.5);
        let mut after = |at_limit, phase| {
            integral.step(4.0, at_limit, phase);
            integral.value
        };
        let phases = [Phase::Approaching, Phase::Approaching, Phase::Arriving, Phase::Holding];
        assert_eq!(
            [true, false, false, false].map(|at_limit| after(at_limit, Phase::Approaching)),
            [0.0, 4.0, 5.0, 5.0]
        );
        assert_eq!(phases.map(|phase| after(false, phase)), [5.0, 5.0, 1.5, 1.5]);
    }
}
