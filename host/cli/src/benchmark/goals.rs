//! Measurements of baseline and loop, each with its goal.

use std::fmt;

/// The measurements, in the order of the lines.
#[derive(Default)]
pub(super) struct Goals(Vec<Goal>);

struct Goal {
    what: &'static str,
    baseline: f64,
    of_loop: f64,
    target: Target,
}

pub(super) enum Target {
    /// Printed without a goal.
    None,
    /// The loop reaches at least this ratio to the baseline.
    AtLeast(f64),
    /// The loop takes at most this ratio to the baseline.
    AtMost(f64),
    /// The loop stays below this value, independent of the baseline.
    Below(f64),
}

impl Goals {
    pub(super) fn push(&mut self, what: &'static str, target: Target, baseline: f64, of_loop: f64) {
        self.0.push(Goal { what, baseline, of_loop, target });
    }

    pub(super) fn all_met(&self) -> bool {
        self.0.iter().all(Goal::is_met)
    }
}

impl Goal {
    fn ratio(&self) -> f64 {
        self.of_loop / self.baseline
    }

    /// A missing measurement misses its goal.
    fn is_met(&self) -> bool {
        match self.target {
            Target::None => true,
            Target::AtLeast(ratio) => self.ratio() >= ratio,
            Target::AtMost(ratio) => self.ratio() <= ratio,
            Target::Below(limit) => self.of_loop < limit,
        }
    }
}

impl fmt::Display for Goals {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:<44}{:>10}{:>10}{:>8}  goal", "medians", "baseline", "the loop", "ratio")?;
        for goal in &self.0 {
            let Goal { what, baseline, of_loop, target } = goal;
            let ratio = goal.ratio();
            write!(out, "\n{what:<44}{baseline:>10.1}{of_loop:>10.1}{ratio:>8.2}")?;
            match target {
                Target::None => continue,
                Target::AtLeast(least) => write!(out, "  ratio >= {least}")?,
                Target::AtMost(most) => write!(out, "  ratio <= {most}")?,
                Target::Below(limit) => write!(out, "  the loop < {limit}")?,
            }
            write!(out, ": {}", if goal.is_met() { "met" } else { "MISSED" })?;
        }
        Ok(())
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
        assert!(met(|goals| goals.push("speed", Target::AtLeast(0.8), 100.0, 80.0)));
        assert!(!met(|goals| goals.push("speed", Target::AtLeast(0.8), 100.0, 79.0)));
        assert!(met(|goals| goals.push("time", Target::AtMost(1.2), 100.0, 120.0)));
        assert!(!met(|goals| goals.push("time", Target::AtMost(1.2), 100.0, 121.0)));
        assert!(!met(|goals| goals.push("time", Target::Below(10.0), 100.0, 10.0)));
        assert!(!met(|goals| goals.push("time", Target::AtMost(1.2), 100.0, f64::NAN)), "not measured");
        assert!(met(|goals| goals.push("late", Target::None, 0.0, 100.0)));
    }

    #[test]
    fn median_is_the_middle_value() {
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
    }
}
