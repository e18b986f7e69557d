//! Figures of both sides, and whether they are what they ought to be.

use std::fmt;

/// What was measured, line by line.
#[derive(Default)]
pub(super) struct Goals(Vec<Goal>);

struct Goal {
    what: &'static str,
    bare: f64,
    ours: f64,
    wanted: Option<Wanted>,
}

enum Wanted {
    /// The loop has at least this share of the bare side.
    AtLeast(f64),
    /// The loop has at most so many times the bare side.
    AtMost(f64),
    /// The loop is below this, whatever the bare side is.
    Below(f64),
}

impl Goals {
    pub(super) fn at_least(&mut self, what: &'static str, ratio: f64, bare: f64, ours: f64) {
        self.0.push(Goal { what, bare, ours, wanted: Some(Wanted::AtLeast(ratio)) });
    }

    pub(super) fn at_most(&mut self, what: &'static str, ratio: f64, bare: f64, ours: f64) {
        self.0.push(Goal { what, bare, ours, wanted: Some(Wanted::AtMost(ratio)) });
    }

    pub(super) fn below(&mut self, what: &'static str, limit: f64, bare: f64, ours: f64) {
        self.0.push(Goal { what, bare, ours, wanted: Some(Wanted::Below(limit)) });
    }

    /// A figure without a goal.
    pub(super) fn note(&mut self, what: &'static str, bare: f64, ours: f64) {
        self.0.push(Goal { what, bare, ours, wanted: None });
    }

    pub(super) fn all_met(&self) -> bool {
        self.0.iter().all(|goal| goal.is_met() != Some(false))
    }
}

impl Goal {
    fn ratio(&self) -> f64 {
        self.ours / self.bare
    }

    /// A figure that could not be measured meets nothing.
    fn is_met(&self) -> Option<bool> {
        self.wanted.as_ref().map(|wanted| match *wanted {
            Wanted::AtLeast(ratio) => self.ratio() >= ratio,
            Wanted::AtMost(ratio) => self.ratio() <= ratio,
            Wanted::Below(limit) => self.ours < limit,
        })
    }
}

impl fmt::Display for Goals {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let heading = ["bare", "the loop", "ratio", "goal"];
        let [bare, ours, ratio, wanted] = heading;
        write!(out, "{:<44}{bare:>10}{ours:>10}{ratio:>8}  {wanted}", "medians")?;
        for goal in &self.0 {
            let Goal { what, bare, ours, wanted } = goal;
            write!(out, "\n{what:<44}{bare:>10.1}{ours:>10.1}")?;
            let Some(wanted) = wanted else { continue };
            let met = if goal.is_met() == Some(true) { "met" } else { "MISSED" };
            write!(out, "{:>8.2}  {wanted}: {met}", goal.ratio())?;
        }
        Ok(())
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtLeast(ratio) => write!(out, "ratio >= {ratio}"),
            Self::AtMost(ratio) => write!(out, "ratio <= {ratio}"),
            Self::Below(limit) => write!(out, "the loop < {limit}"),
        }
    }
}

/// The one in the middle; of an even number the upper of the two.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_goal_is_met_by_its_own_measure() {
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
    fn a_median_is_no_minimum_and_no_mean() {
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
    }
}
