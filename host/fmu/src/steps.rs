//! Communication steps and their times.
//!
//! A time is a whole number of nanoseconds since the start, divided once: `t = step number x step`. Sums of steps drift, and FMUs
//! compare times exactly.

use crate::description::CoSimulation;
use crate::error::FmuError;

/// Relative deviation from a whole number of steps that counts as none: the bench's times are sums of a few numbers.
const SLACK: f64 = 1e-9;
const SECOND_NS: f64 = 1e9;

/// The steps of a run.
#[derive(Debug)]
pub(crate) struct Steps {
    /// The one communication step; `None` if the FMU takes any.
    step_s: Option<f64>,
    /// Step inside the FMU, of which each communication step must be a multiple.
    inner_step_s: Option<f64>,
    elapsed_ns: u64,
}

/// A communication step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    pub(crate) time_s: f64,
    pub(crate) step_s: f64,
}

impl Steps {
    /// Those of a run with this period. `step_us` is that of the scenario; with 0 an FMU that takes one step only gets the one it
    /// prefers, any other one the period.
    pub(crate) fn new(
        fmu: &CoSimulation,
        preferred_step_s: Option<f64>,
        step_us: u32,
        period_s: f64,
    ) -> Result<Self, FmuError> {
        let given_s = (step_us > 0).then_some(f64::from(step_us) / 1e6);
        let only_s = preferred_step_s.filter(|step_s| *step_s > 0.0).unwrap_or(period_s);
        let step_s = given_s.or((!fmu.takes_any_step).then_some(only_s));
        let steps = Self { step_s, inner_step_s: fmu.inner_step_s, elapsed_ns: 0 };
        // What fails in the first period fails before the run.
        steps.count(period_s)?;
        Ok(steps)
    }

    /// Number and length of the communication steps of a torque that is held for this time.
    fn count(&self, held_s: f64) -> Result<(u32, f64), FmuError> {
        let wrong = |step_s, remedy| FmuError::Step { step_s, held_s, remedy };
        let step_s = self.step_s.unwrap_or(held_s);
        let count = multiple(held_s, step_s).ok_or_else(|| {
            wrong(
                step_s,
                "set plant.step_us to a step that divides the control period and each delay of a torque",
            )
        })?;
        if let Some(inner_s) = self.inner_step_s
            && multiple(step_s, inner_s).is_none()
        {
            return Err(FmuError::Step {
                step_s: inner_s,
                held_s: step_s,
                remedy: "set run.control_period_us, plant.step_us and the delays to multiples of it",
            });
        }
        Ok((count, step_s))
    }

    /// The steps of a torque that is held for this time from now on.
    pub(crate) fn hold(&mut self, held_s: f64) -> Result<impl Iterator<Item = Step> + use<>, FmuError> {
        let (count, step_s) = self.count(held_s)?;
        let (start_ns, held_ns) = (self.elapsed_ns, (held_s * SECOND_NS).round());
        self.elapsed_ns += held_ns as u64;
        let time_s =
            move |index| (start_ns as f64 + held_ns * f64::from(index) / f64::from(count)) / SECOND_NS;
        Ok((0..count).map(move |index| Step { time_s: time_s(index), step_s }))
    }

    /// The time now.
    pub(crate) fn time_s(&self) -> f64 {
        self.elapsed_ns as f64 / SECOND_NS
    }
}

/// How many times `step_s` is in `time_s`, if a whole number of times.
fn multiple(time_s: f64, step_s: f64) -> Option<u32> {
    let count = (time_s / step_s).round();
    let is_whole = count >= 1.0 && (count * step_s - time_s).abs() <= SLACK * time_s;
    // A period has at most 1e6 steps: both are whole microseconds, or the FMU's.
    (is_whole && count <= 1e6).then_some(count as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fmu(takes_any_step: bool, inner_step_s: Option<f64>) -> CoSimulation {
        CoSimulation { identifier: String::new(), takes_any_step, inner_step_s, needs_tool: false }
    }

    #[test]
    fn the_time_is_step_number_times_step() {
        let mut steps = Steps::new(&fmu(true, None), Some(1e-4), 0, 1e-3).expect("any step");
        for k in 0..100_000_u32 {
            let all: Vec<_> = steps.hold(1e-3).expect("a step").collect();
            assert_eq!(all, [Step { time_s: f64::from(k) / 1e3, step_s: 1e-3 }]);
        }
        assert_eq!(steps.time_s(), 100.0);
    }

    #[test]
    fn a_period_is_split_into_the_given_step() {
        let mut steps = Steps::new(&fmu(false, Some(5e-5)), None, 250, 1e-3).expect("a divisor");
        let times: Vec<_> = steps.hold(1e-3).expect("four").map(|it| it.time_s).collect();
        assert_eq!(times, [0.0, 0.25e-3, 0.5e-3, 0.75e-3]);
        let split: Vec<_> = steps.hold(1e-3 - 0.5e-3).expect("two").map(|it| it.time_s).collect();
        assert_eq!(split, [1e-3, 1.25e-3]);
    }

    #[test]
    fn a_step_that_does_not_fit_is_refused() {
        let error =
            |fmu, step_us| Steps::new(&fmu, Some(3e-4), step_us, 1e-3).expect_err("no multiple").to_string();
        let have = error(fmu(true, Some(3e-4)), 0);
        assert!(
            have.starts_with("the FMU takes steps of 0.0003 s, and 0.001 s isn't a multiple of it"),
            "{have}"
        );
        let have = error(fmu(true, None), 300);
        assert!(have.contains("set plant.step_us to a step that divides the control period"), "{have}");
        let have = error(fmu(false, None), 0);
        assert!(
            have.starts_with("the FMU takes steps of 0.0003 s, and 0.001 s isn't"),
            "the step it prefers: {have}"
        );
        // A torque that arrives within the period needs another step than the first one.
        let mut steps = Steps::new(&fmu(false, None), None, 0, 1e-3).expect("the period");
        assert!(steps.hold(3e-4).is_err());
    }
}
