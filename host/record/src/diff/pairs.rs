//! Rows of two records at the same plant time.
//!
//! Records of one scenario have the same rows. Those of other periods or lengths, of interrupted runs and of windows around
//! a failure have some in common.

use std::cmp::Ordering;
use std::ops::RangeInclusive;

use serde::Serialize;

/// The rows that both records have.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pairs {
    /// Row in the first and in the second record, ascending.
    pub(super) rows: Vec<[usize; 2]>,
    pub(super) coverage: Coverage,
}

/// How far two records cover the same time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coverage {
    /// Rows compared.
    pub compared: usize,
    /// Period of the rows of each record in us; `None` for a single row.
    pub period_us: [Option<i64>; 2],
    /// Time of the last row of each record within the window in s; `None` without a row there.
    pub last_s: [Option<f64>; 2],
    /// Rows of each record before the first or after the last of the other.
    pub outside: [usize; 2],
    /// Rows of each record between rows of the other.
    pub between: [usize; 2],
}

impl Coverage {
    /// Whether the records cover the same time: with equal periods row by row, otherwise to within one period at either
    /// end.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        match self.period_us {
            [Some(a), Some(b)] if a != b => {
                // Of the shorter period, as many rows as fit into a longer one can be outside.
                let surplus = |of: usize| (2 * a.max(b) / self.period_us[of].unwrap_or(1).max(1)) as usize;
                self.outside[0] <= surplus(0) && self.outside[1] <= surplus(1)
            }
            _ => self.outside == [0; 2] && self.between == [0; 2],
        }
    }
}

impl Pairs {
    /// Pairs the rows of these times that are in the window. Times ascend.
    pub(super) fn new(times_s: [&[f64]; 2], window_s: &RangeInclusive<f64>) -> Self {
        let rows_of = times_s.map(|times_s| {
            let rows = times_s.iter().enumerate().filter(|(_, time_s)| window_s.contains(time_s));
            rows.map(|(row, time_s)| (row, microseconds(*time_s))).collect::<Vec<_>>()
        });
        let [a, b] = &rows_of;
        let mut rows = Vec::with_capacity(a.len().min(b.len()));
        let (mut outside, mut between) = ([0; 2], [0; 2]);
        let range = |of: &[(usize, i64)]| Some((of.first()?.1, of.last()?.1));
        let ranges = [range(a), range(b)];
        let mut unpaired = |side: usize, time_us: i64| match ranges[1 - side] {
            Some((first_us, last_us)) if (first_us..=last_us).contains(&time_us) => between[side] += 1,
            _ => outside[side] += 1,
        };
        let (mut a_rest, mut b_rest) = (a.iter().peekable(), b.iter().peekable());
        loop {
            match (a_rest.peek(), b_rest.peek()) {
                (Some(&&(row_a, a_us)), Some(&&(row_b, b_us))) => match a_us.cmp(&b_us) {
                    Ordering::Equal => {
                        rows.push([row_a, row_b]);
                        a_rest.next();
                        b_rest.next();
                    }
                    Ordering::Less => {
                        unpaired(0, a_us);
                        a_rest.next();
                    }
                    Ordering::Greater => {
                        unpaired(1, b_us);
                        b_rest.next();
                    }
                },
                (Some(&&(_, a_us)), None) => {
                    unpaired(0, a_us);
                    a_rest.next();
                }
                (None, Some(&&(_, b_us))) => {
                    unpaired(1, b_us);
                    b_rest.next();
                }
                (None, None) => break,
            }
        }
        let coverage = Coverage {
            compared: rows.len(),
            period_us: times_s.map(period_us),
            last_s: [a, b].map(|of| of.last().map(|(_, time_us)| *time_us as f64 * 1e-6)),
            outside,
            between,
        };
        Self { rows, coverage }
    }
}

/// Control periods are whole microseconds, so the times of two records are equal in this unit or not at all.
pub(super) fn microseconds(time_s: f64) -> i64 {
    (time_s * 1e6).round() as i64
}

/// The period of ascending times; `None` for less than two.
pub(super) fn period_us(times_s: &[f64]) -> Option<i64> {
    let &[first_s, second_s, ..] = times_s else { return None };
    Some(microseconds(second_s) - microseconds(first_s)).filter(|period_us| *period_us > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;

    fn times_s(period_s: f64, rows: u32) -> Vec<f64> {
        (0..rows).map(|row| f64::from(row) * period_s).collect()
    }

    #[test]
    fn a_shorter_record_is_compared_to_its_end() {
        let pairs = Pairs::new([&times_s(1e-3, 10), &times_s(1e-3, 7)], &ALL);
        assert_eq!(pairs.rows, (0..7).map(|row| [row, row]).collect::<Vec<_>>());
        assert_eq!((pairs.coverage.outside, pairs.coverage.between), ([3, 0], [0, 0]));
        assert!(!pairs.coverage.is_equal());
        let within = Pairs::new([&times_s(1e-3, 10), &times_s(1e-3, 7)], &(0.0..=4e-3));
        assert!(within.coverage.is_equal() && within.coverage.compared == 5, "{:?}", within.coverage);
    }

    #[test]
    fn other_periods_have_their_common_times_compared() {
        let pairs = Pairs::new([&times_s(1e-3, 10), &times_s(0.5e-3, 20)], &ALL);
        assert_eq!(pairs.rows, (0..10).map(|row| [row, 2 * row]).collect::<Vec<_>>());
        assert_eq!(pairs.coverage.period_us, [Some(1000), Some(500)]);
        assert!(pairs.coverage.is_equal(), "{:?}", pairs.coverage);
        let shorter = Pairs::new([&times_s(1e-3, 10), &times_s(0.5e-3, 10)], &ALL);
        assert!(!shorter.coverage.is_equal(), "{:?}", shorter.coverage);
    }

    #[test]
    fn a_window_around_a_failure_and_a_gap_are_found() {
        let late: Vec<_> = times_s(1e-3, 10).split_off(4);
        let pairs = Pairs::new([&times_s(1e-3, 10), &late], &ALL);
        assert_eq!((pairs.rows.first(), pairs.coverage.outside), (Some(&[4, 0]), [4, 0]));
        let gap: Vec<_> =
            times_s(1e-3, 10).into_iter().filter(|time_s| *time_s < 2e-3 || *time_s > 5e-3).collect();
        let pairs = Pairs::new([&gap, &times_s(1e-3, 10)], &ALL);
        assert_eq!((pairs.coverage.between, pairs.coverage.is_equal()), ([0, 4], false));
    }

    #[test]
    fn records_without_a_common_time_have_no_pairs() {
        let later: Vec<_> = times_s(1e-3, 4).iter().map(|time_s| time_s + 1.0).collect();
        let pairs = Pairs::new([&times_s(1e-3, 4), &later], &ALL);
        assert_eq!((pairs.rows.len(), pairs.coverage.outside), (0, [4, 4]));
        assert!(Pairs::new([&[], &[f64::NAN]], &ALL).rows.is_empty());
    }
}
