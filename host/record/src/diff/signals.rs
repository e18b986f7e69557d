//! The signals of two records, value by value.

use lashloop_plant::Signal;
use serde::Serialize;

use super::tolerance::Tolerances;
use crate::columns::Columns;

/// A signal that both records have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalDifference {
    /// Name of the column.
    pub name: String,
    /// Unit of the values.
    pub unit: String,
    /// Rows compared.
    pub compared: usize,
    /// Rows whose values differ in at least one bit.
    pub differing: usize,
    /// The first of these rows.
    pub first: Option<ValuePair>,
    /// The row of the largest difference.
    pub largest: Option<ValuePair>,
    /// Rows in which the first, and in which the second record alone has no value.
    pub absent: [usize; 2],
    /// The largest difference allowed, in the unit; `None` for equal bits.
    pub tolerance: Option<f64>,
    /// Whether every row is within the tolerance. A value that only one record has never is.
    pub within: bool,
}

/// The values of both records at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ValuePair {
    /// When.
    #[serde(flatten)]
    pub at: At,
    /// The values; absent is NaN, null in JSON.
    pub values: [f64; 2],
}

/// A row of the first record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct At {
    /// Step of the run.
    pub step: i64,
    /// Time of the run.
    pub time_s: f64,
}

impl ValuePair {
    /// Second value minus the first.
    #[must_use]
    pub fn difference(&self) -> f64 {
        self.values[1] - self.values[0]
    }
}

/// The signals of two records.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Signals {
    pub(super) common: Vec<SignalDifference>,
    /// Names that only the first, and only the second record has.
    pub(super) alone: [Vec<String>; 2],
    /// Names with their two units, which are not compared.
    pub(super) other_unit: Vec<(String, [String; 2])>,
}

impl Signals {
    /// Compares the columns that `is_wanted` accepts in these pairs of rows, each pair that `counts` accepts for the column.
    /// `at` gives step and time of a row of the first record.
    pub(super) fn compare(
        columns: [&Columns; 2],
        rows: &[[usize; 2]],
        tolerances: &Tolerances,
        at: impl Fn(usize) -> At,
        is_wanted: impl Fn(&str) -> bool,
        counts: impl Fn(&str, [usize; 2]) -> bool,
    ) -> Self {
        let [a, b] = columns;
        let mut signals = Self::default();
        for Signal { name, unit } in a.signals().iter().filter(|it| is_wanted(&it.name)) {
            let (Some(a_values), Some(b_values)) = (a.get(name), b.get(name)) else {
                signals.alone[0].push(name.to_string());
                continue;
            };
            let other = b.unit(name).unwrap_or_default();
            if other != unit {
                signals.other_unit.push((name.to_string(), [unit.to_string(), other.to_owned()]));
                continue;
            }
            let counted = rows.iter().filter(|rows| counts(name, **rows));
            let pairs = counted.map(|&[row_a, row_b]| (row_a, [a_values[row_a], b_values[row_b]]));
            signals.common.push(SignalDifference::new(name, unit, pairs, tolerances, &at));
        }
        let alone = b.signals().iter().filter(|it| is_wanted(&it.name) && a.get(&it.name).is_none());
        signals.alone[1] = alone.map(|it| it.name.to_string()).collect();
        signals
    }
}

impl SignalDifference {
    fn new(
        name: &str,
        unit: &str,
        pairs: impl Iterator<Item = (usize, [f64; 2])>,
        tolerances: &Tolerances,
        at: impl Fn(usize) -> At,
    ) -> Self {
        let mut difference = Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            compared: 0,
            differing: 0,
            first: None,
            largest: None,
            absent: [0; 2],
            tolerance: None,
            within: true,
        };
        let (mut peak, mut largest) = (0.0_f64, -1.0);
        let (mut first_row, mut largest_row) = (None, None);
        for (row, values) in pairs {
            difference.compared += 1;
            let [a, b] = values;
            if a.is_finite() {
                peak = peak.max(a.abs());
            }
            if a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) {
                continue;
            }
            difference.differing += 1;
            first_row.get_or_insert((row, values));
            match values.map(f64::is_nan) {
                [true, _] => difference.absent[0] += 1,
                [_, true] => difference.absent[1] += 1,
                [false, false] => {
                    let amount = (b - a).abs();
                    if amount > largest {
                        largest = amount;
                        largest_row = Some((row, values));
                    }
                }
            }
        }
        let pair_at = |(row, values)| ValuePair { at: at(row), values };
        (difference.first, difference.largest) = (first_row.map(pair_at), largest_row.map(pair_at));
        difference.tolerance = tolerances.of(name).map(|tolerance| tolerance.at(peak));
        difference.within = match difference.tolerance {
            None => difference.differing == 0,
            Some(limit) => difference.absent == [0; 2] && largest <= limit,
        };
        difference
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(columns: &[(&'static str, &'static str, &[f64])]) -> Columns {
        let mut table = Columns::new(columns.iter().map(|(name, unit, _)| Signal::new(name, unit)).collect());
        for row in 0..columns[0].2.len() {
            table.push(columns.iter().map(|(_, _, values)| values[row]));
        }
        table
    }

    fn at(row: usize) -> At {
        At { step: row as i64, time_s: row as f64 * 1e-3 }
    }

    fn compare(a: &[f64], b: &[f64], tolerance: &[&str]) -> SignalDifference {
        let tolerances =
            Tolerances(tolerance.iter().map(|text| text.parse().expect("a tolerance")).collect());
        let [a, b] = [a, b].map(|values| columns(&[("u", "N m", values)]));
        let rows: Vec<_> = (0..a.len()).map(|row| [row, row]).collect();
        let mut signals = Signals::compare([&a, &b], &rows, &tolerances, at, |_| true, |_, _| true);
        signals.common.remove(0)
    }

    #[test]
    fn one_bit_is_a_difference_and_two_absent_values_are_none() {
        let next = f64::from_bits(1.0_f64.to_bits() + 1);
        let found = compare(&[f64::NAN, 1.0, 2.0], &[-f64::NAN, next, 2.0], &[]);
        assert_eq!((found.differing, found.first.map(|it| it.at.step), found.within), (1, Some(1), false));
        assert_eq!(compare(&[0.0], &[-0.0], &[]).differing, 1);
        assert!(compare(&[0.0], &[-0.0], &["u=0"]).within);
    }

    #[test]
    fn the_largest_difference_and_the_first_are_different_rows() {
        let found = compare(&[1.0, 1.0, 1.0, -4.0], &[1.0, 1.5, -1.0, -4.0], &["u=1.9"]);
        assert_eq!(found.first.map(|it| (it.at.step, it.difference())), Some((1, 0.5)));
        assert_eq!(found.largest.map(|it| (it.at.step, it.difference())), Some((2, -2.0)));
        assert!(!found.within);
        assert!(
            compare(&[1.0, 1.0, 1.0, -4.0], &[1.0, 1.5, -1.0, -4.0], &["50%"]).within,
            "half of the peak of 4"
        );
    }

    #[test]
    fn a_value_that_only_one_record_has_is_beyond_every_tolerance() {
        let found = compare(&[1.0, f64::NAN], &[f64::NAN, f64::INFINITY], &["u=1e300"]);
        assert_eq!((found.absent, found.within, found.largest), ([1, 1], false, None));
        assert!(!compare(&[1.0], &[f64::INFINITY], &["u=1e300"]).within);
    }

    #[test]
    fn signals_of_one_record_and_of_two_units_are_named() {
        let a = columns(&[("u", "N m", &[1.0]), ("x", "rad", &[1.0]), ("p", "rad", &[0.0])]);
        let b = columns(&[("u", "N m", &[1.0]), ("y", "", &[1.0]), ("p", "deg", &[0.0])]);
        let found = Signals::compare([&a, &b], &[[0, 0]], &Tolerances::default(), at, |_| true, |_, _| true);
        assert_eq!(found.common.len(), 1);
        assert_eq!(found.alone, [vec!["x".to_owned()], vec!["y".to_owned()]]);
        assert_eq!(found.other_unit, [("p".to_owned(), ["rad".to_owned(), "deg".to_owned()])]);
    }
}
