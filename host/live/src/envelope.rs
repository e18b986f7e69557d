//! Samples as buckets of equally many steps, with the least and the greatest value of every column: a peak of one step
//! remains visible at any scale.
//!
//! A bucket is a row of numbers: time of its first step, then a pair of least and greatest value per column. A column
//! without a value in all of its steps is a pair of NaN.

use std::collections::VecDeque;

/// Turns steps into buckets.
#[derive(Debug)]
pub(super) struct Bucketing {
    steps_per_bucket: u32,
    filled: u32,
    bucket: Vec<f32>,
}

impl Bucketing {
    /// `steps_per_bucket` is at least 1.
    pub(super) fn new(steps_per_bucket: u32, columns: usize) -> Self {
        Self { steps_per_bucket, filled: 0, bucket: vec![f32::NAN; row_length(columns)] }
    }

    /// Adds a step, one value per column. Appends the bucket that it completes to `completed`.
    pub(super) fn push(&mut self, time_s: f64, values: &[f32], completed: &mut Vec<f32>) {
        if self.filled == 0 {
            self.bucket.fill(f32::NAN);
            self.bucket[0] = time_s as f32;
        }
        for (pair, value) in self.bucket[1..].chunks_exact_mut(2).zip(values) {
            // Both ignore NaN.
            pair[0] = pair[0].min(*value);
            pair[1] = pair[1].max(*value);
        }
        self.filled += 1;
        if self.filled == self.steps_per_bucket {
            self.finish(completed);
        }
    }

    /// Completes a bucket of fewer steps.
    pub(super) fn finish(&mut self, completed: &mut Vec<f32>) {
        if self.filled > 0 {
            completed.extend_from_slice(&self.bucket);
            self.filled = 0;
        }
    }
}

/// Numbers of one bucket.
pub(super) fn row_length(columns: usize) -> usize {
    1 + 2 * columns
}

/// The latest buckets, a bounded number of them. Readers have a place each and take what is new since then.
#[derive(Debug)]
pub(super) struct History {
    row_length: usize,
    capacity: usize,
    /// Number of the first bucket that is kept.
    first: u64,
    values: VecDeque<f32>,
}

/// Consecutive buckets of a history.
#[derive(Debug, PartialEq)]
pub(super) struct Chunk {
    /// Number of the first bucket. It exceeds the reader's place if older buckets have been dropped.
    pub(super) first: u64,
    /// Number of the bucket after the last one: the reader's next place.
    pub(super) next: u64,
    pub(super) values: Vec<f32>,
}

impl History {
    pub(super) fn new(columns: usize, capacity: usize) -> Self {
        Self { row_length: row_length(columns), capacity, first: 0, values: VecDeque::new() }
    }

    /// Appends whole buckets and drops the oldest beyond the capacity.
    pub(super) fn append(&mut self, buckets: &[f32]) {
        self.values.extend(buckets);
        let kept = self.values.len() / self.row_length;
        let dropped = kept.saturating_sub(self.capacity);
        self.values.drain(..dropped * self.row_length);
        self.first += dropped as u64;
    }

    /// At most `limit` buckets from number `place` on; `None` if there are none.
    pub(super) fn read(&self, place: u64, limit: usize) -> Option<Chunk> {
        let end = self.first + (self.values.len() / self.row_length) as u64;
        let first = place.max(self.first);
        let count = usize::try_from(end.checked_sub(first)?).ok()?.min(limit);
        if count == 0 {
            return None;
        }
        let start = (first - self.first) as usize * self.row_length;
        let values = self.values.range(start..start + count * self.row_length).copied().collect();
        Some(Chunk { first, next: first + count as u64, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_of_one_step_remains_in_its_bucket() {
        let (mut bucketing, mut buckets) = (Bucketing::new(100, 2), Vec::new());
        for step in 0..250_u16 {
            let torque = match step {
                137 => 8.0,
                138 => -9.0,
                _ => 0.5,
            };
            let telemetry = if step < 100 { f32::NAN } else { f32::from(step) };
            bucketing.push(f64::from(step) * 0.5, &[torque, telemetry], &mut buckets);
        }
        bucketing.finish(&mut buckets);
        let rows: Vec<_> = buckets.chunks(row_length(2)).collect();
        assert_eq!(rows.len(), 3);
        assert_eq!(rows[0][..3], [0.0, 0.5, 0.5]);
        assert!(rows[0][3].is_nan() && rows[0][4].is_nan());
        assert_eq!(rows[1], [50.0, -9.0, 8.0, 100.0, 199.0]);
        assert_eq!(rows[2], [100.0, 0.5, 0.5, 200.0, 249.0]);
    }

    /// Buckets without columns: the time alone.
    fn history(capacity: usize, buckets: u16) -> History {
        let mut history = History::new(0, capacity);
        for bucket in 0..buckets {
            history.append(&[f32::from(bucket)]);
        }
        history
    }

    #[test]
    fn a_late_reader_gets_the_history_and_a_slow_one_skips_what_was_dropped() {
        let history = history(10, 25);
        let late = history.read(0, 4).expect("buckets");
        assert_eq!((late.first, late.next, &late.values[..]), (15, 19, &[15.0, 16.0, 17.0, 18.0][..]));
        let rest = history.read(late.next, 100).expect("buckets");
        assert_eq!((rest.first, rest.next, rest.values.len()), (19, 25, 6));
        assert_eq!(history.read(rest.next, 100), None);
    }

    #[test]
    fn a_history_is_bounded() {
        let mut history = history(10, 0);
        for _ in 0..100 {
            history.append(&[0.0; 1_000]);
        }
        assert_eq!((history.values.len(), history.first), (10, 99_990));
    }
}
