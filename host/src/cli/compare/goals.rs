//! Measurements of baseline and loop, each with its goal.

use std::fmt;

/// The measurements, in the order of the lines.
#[derive(Default)]
pub(super) struct Goals(Vec<Goal>);

struct Goal {
    what: &'static str,
    baseline: f64,
    of_loop: f64,
    target: Option<Target>,
}

enum Target {
    /// The loop reaches at least this ratio to the baseline.
    AtLeast(f64),
    /// The loop takes at most this ratio to the baseline.
    AtMost(f64),
    /// The loop stays below this value, independent of the baseline.
    Below(f64),
}

impl Goals {
    pub(super) fn at_least(&mut self, what: &'static str, ratio: f64, baseline: f64, of_loop: f64) {
        self.0.push(Goal { what, baseline, of_loop, target: Some(Target::AtLeast(ratio)) });
    }

    pub(super) fn at_most(&mut self, what: &'static str, ratio: f64, baseline: f64, of_loop: f64) {
        self.0.push(Goal { what, baseline, of_loop, target: Some(Target::AtMost(ratio)) });
    }

    pub(super) fn below(&mut self, what: &'static str, limit: f64, baseline: f64, of_loop: f64) {
        self.0.push(Goal { what, baseline, of_loop, target: Some(Target::Below(limit)) });
    }

    /// A measurement without a goal.
    pub(super) fn note(&mut self, what: &'static str, baseline: f64, of_loop: f64) {
        self.0.push(Goal { what, baseline, of_loop, target: None });
    }

    pub(super) fn all_met(&self) -> bool {
        self.0.iter().all(|goal| goal.is_met() != Some(false))
    }
}

impl Goal {
    fn ratio(&self) -> f64 {
        self.of_loop / self.baseline
    }

    /// A missing measurement misses its goal.
    fn is_met(&self) -> Option<bool> {
        self.target.as_ref().map(|target| match *target {
            Target::AtLeast(ratio) => self.ratio() >= ratio,
            Target::AtMost(ratio) => self.ratio() <= ratio,
            Target::Below(limit) => self.of_loop < limit,
        })
    }
}

impl fmt::Display for Goals {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let heading = ["baseline", "the loop", "ratio", "goal"];
        let [baseline, of_loop, ratio, target] = heading;
        write!(out, "{:<44}{baseline:>10}{of_loop:>10}{ratio:>8}  {target}", "medians")?;
        for goal in &self.0 {
            let Goal { what, baseline, of_loop, target } = goal;
            write!(out, "\n{what:<44}{baseline:>10.1}{of_loop:>10.1}")?;
            let Some(target) = target else { continue };
            let met = if goal.is_met() == Some(true) { "met" } else { "MISSED" };
            write!(out, "{:>8.2}  {target}: {met}", goal.ratio())?;
        }
        Ok(())
    }
}

impl fmt::Display for Target {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtLeast(ratio) => write!(out, "ratio >= {ratio}"),
            Self::AtMost(ratio) => write!(out, "ratio <= {ratio}"),
            Self::Below(limit) => write!(out, "the loop < {limit}"),
        }
    }
}

/// The middle value; the upper of the two for an even number.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_goal_compares_by_its_own_rule() {
        let met = |set: fn(&mut Goals)| {
            let mut goals = Goals::default();
            set(&mut goals);
            goals.all_met()
        };
        assert!(met(|goals| goals.at_least("speed", 0.8, 100.0, 80.0)));
        assert!(!met(|goals| goals.at_least("speed", 0.8, 100.0, 79.0)));
        assert!(met(|goals| goals.at_most("time", 1.2, 100.0, 120.0)));
        assert!(!met(|goals| goals.at_most("time", 1.2, 100.0, 121.0)));
        assert!(!met(|goals| goals.below("time", 10.0, 100.0, 10.0)));
        assert!(!met(|goals| goals.at_most("time", 1.2, 100.0, f64::NAN)), "not measured");
        assert!(met(|goals| goals.note("late", 0.0, 100.0)));
    }

    #[test]
    fn median_is_the_middle_value() {
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
    }
}
