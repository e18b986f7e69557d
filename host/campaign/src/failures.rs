//! Failures over the axes: the runs of each variant in bins of an axis, and how many of them fail.

use crate::axis::{Axis, AxisValue, Values};
use crate::interval;
use crate::plan::Plan;
use crate::settings::{Method, Part};

/// Bins of a range.
const BINS: u64 = 10;
/// Most bins of an axis whose values are listed.
const MOST_BINS: u64 = 12;

/// An axis of a part in bins.
#[derive(Debug, Clone, PartialEq)]
pub struct FailureAxis {
    /// Index of the part.
    pub part: usize,
    /// Its label, else its first key.
    pub label: String,
    pub unit: String,
    /// The key whose value multiplies those of the axis.
    pub times: Option<String>,
    pub bins: Vec<Bin>,
    axis: usize,
    place: Place,
}

/// How a row gets its place among the slots.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// By the fraction of the axis that was drawn.
    Drawn { slots: u64, slots_per_bin: u64 },
    /// By the number of the row: each value is repeated for as many rows.
    Enumerated { rows_per_value: u64, slots: u64, slots_per_bin: u64 },
}

/// A part of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Bin {
    pub from: AxisValue,
    /// Equal to `from` in a bin of one value.
    pub to: AxisValue,
    /// By variant.
    pub tallies: Vec<Tally>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    pub runs: u64,
    /// Runs whose verdict is not PASS.
    pub failures: u64,
}

impl Tally {
    /// The fraction that fails; `None` without a run.
    #[must_use]
    pub fn fraction(self) -> Option<f64> {
        (self.runs > 0).then(|| self.failures as f64 / self.runs as f64)
    }

    /// Clopper-Pearson interval of the fraction.
    #[must_use]
    pub fn interval(self, confidence: f64) -> [f64; 2] {
        interval::fraction(self.failures, self.runs, confidence)
    }
}

impl FailureAxis {
    /// The axes of a part, without a run.
    #[must_use]
    pub fn of(number: usize, part: &Part, variants: usize) -> Vec<Self> {
        let axes = part.axes.iter().enumerate();
        let axes = axes.map(|(at, axis)| {
            let faster = part.axes[at + 1..].iter().map(|axis| axis.values.len()).product();
            let rows_per_value = if part.method == Method::Grid { faster } else { 1 };
            let (place, ends) = bins(axis, part.method.is_sampled(), rows_per_value);
            let bin =
                |[from, to]: [AxisValue; 2]| Bin { from, to, tallies: vec![Tally::default(); variants] };
            Self {
                part: number,
                label: axis.label.clone().unwrap_or_else(|| axis.name().to_owned()),
                unit: axis.unit.clone(),
                times: axis.times.clone(),
                bins: ends.into_iter().map(bin).collect(),
                axis: at,
                place,
            }
        });
        axes.collect()
    }

    /// Counts a run.
    pub fn push(&mut self, plan: &Plan, row: u64, variant: usize, has_failed: bool) {
        let bin = match self.place {
            Place::Drawn { slots, slots_per_bin } => {
                let fraction = plan.fraction(self.part, self.axis, row);
                ((fraction * slots as f64) as u64).min(slots - 1) / slots_per_bin
            }
            Place::Enumerated { rows_per_value, slots, slots_per_bin } => {
                row / rows_per_value % slots / slots_per_bin
            }
        };
        let tally = &mut self.bins[bin as usize].tallies[variant];
        tally.runs += 1;
        tally.failures += u64::from(has_failed);
    }
}

/// The bins of an axis: how rows are placed, and the first and last value of each.
fn bins(axis: &Axis, is_sampled: bool, rows_per_value: u64) -> (Place, Vec<[AxisValue; 2]>) {
    if let (true, Values::Range(_)) = (is_sampled, &axis.values) {
        let end = |bin: u64| axis.values.at_fraction(bin as f64 / BINS as f64);
        let place = Place::Drawn { slots: BINS, slots_per_bin: 1 };
        return (place, (0..BINS).map(|bin| [end(bin), end(bin + 1)]).collect());
    }
    let slots = axis.values.len().max(1);
    let slots_per_bin = slots.div_ceil(MOST_BINS);
    let ends = (0..slots).step_by(slots_per_bin as usize).map(|first| {
        [first, (first + slots_per_bin).min(slots) - 1].map(|index| axis.values.at_index(index))
    });
    let place = match is_sampled {
        true => Place::Drawn { slots, slots_per_bin },
        false => Place::Enumerated { rows_per_value, slots, slots_per_bin },
    };
    (place, ends.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Range, Scale};

    fn axis(key: &str, values: Values) -> Axis {
        Axis { keys: vec![key.to_owned()], label: None, unit: String::new(), values, times: None }
    }

    fn range(points: Option<u64>) -> Values {
        Values::Range(Range { min: 0.0, max: 10.0, scale: Scale::Linear, points })
    }

    fn listed(count: u32) -> Values {
        Values::Listed((0..count).map(|value| AxisValue::Number(f64::from(value))).collect())
    }

    /// The axes of a part in which the runs fail whose value of axis `cause` is at least `from`.
    fn counted(method: Method, axes: Vec<Axis>, cause: usize, from: f64) -> Vec<FailureAxis> {
        let points = method.is_sampled().then_some(4000);
        let part = Part { name: "p".to_owned(), set: Vec::new(), method, points, axes_of: None, axes };
        let plan = Plan::new(1, std::slice::from_ref(&part), 1, |_, _| None).expect("a plan");
        let mut axes = FailureAxis::of(0, &part, 1);
        for row in 0..plan.cases() {
            let has_failed = plan.case(row).values[cause].number().expect("a number") >= from;
            axes.iter_mut().for_each(|axis| axis.push(&plan, row, 0, has_failed));
        }
        axes
    }

    fn fractions(axis: &FailureAxis) -> Vec<f64> {
        axis.bins.iter().map(|bin| bin.tallies[0].fraction().expect("runs")).collect()
    }

    #[test]
    fn failures_stand_at_the_values_of_the_axis_that_causes_them() {
        for method in [Method::Random, Method::LatinHypercube, Method::Sobol] {
            let axes = vec![axis("a", range(None)), axis("b", range(None)), axis("c", listed(4))];
            let axes = counted(method, axes, 0, 7.0);
            assert_eq!(fractions(&axes[0]), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
            assert_eq!(
                [&axes[0].bins[7].from, &axes[0].bins[7].to].map(AxisValue::number),
                [Some(7.0), Some(8.0)]
            );
            for fraction in fractions(&axes[1]).into_iter().chain(fractions(&axes[2])) {
                assert!((fraction - 0.3).abs() < 0.1, "{method:?}: {fraction}");
            }
            assert_eq!(axes[2].bins.len(), 4);
        }
        let listed_cause = counted(Method::Random, vec![axis("c", listed(4))], 0, 2.0);
        assert_eq!(fractions(&listed_cause[0]), [0.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn grid_and_list_have_a_bin_for_each_value_and_long_axes_fewer() {
        let axes = || vec![axis("a", range(Some(3))), axis("b", listed(2)), axis("c", listed(30))];
        let grid = counted(Method::Grid, axes(), 0, 5.0);
        assert_eq!(fractions(&grid[0]), [0.0, 1.0, 1.0]);
        assert_eq!(fractions(&grid[1]), [2.0 / 3.0; 2]);
        assert_eq!((grid[2].bins.len(), grid[2].bins[0].tallies[0].runs), (10, 18));
        assert_eq!(grid[2].bins[9].to.number(), Some(29.0));
        assert_eq!(fractions(&counted(Method::Grid, axes(), 2, 27.0)[2])[8..], [0.0, 1.0]);
        assert_eq!(fractions(&counted(Method::List, vec![axis("b", listed(3))], 0, 1.0)[0]), [0.0, 1.0, 1.0]);
    }
}
