//! A line to a drive as the map's axes have it, from the round trip that was measured on it.

use std::time::Duration;

/// The position of a line on a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub delay_us: f64,
    pub jitter_us: f64,
    /// Fraction of samples without an answer.
    pub loss: f64,
}

impl Point {
    /// Delay is the median of the round trip. Jitter has the 99th percentile of the round trip as its own: of a uniform jitter
    /// from 0 to J above the delay that is 0.99 J. The slowest hundredth of the samples is not modelled.
    #[must_use]
    pub fn of(p50: Duration, p99: Duration, answered: u32, lost: u32) -> Self {
        let us = |time: Duration| (time.as_secs_f64() * 1e6).ceil();
        let (delay_us, p99_us) = (us(p50), us(p99));
        let sent = (answered + lost).max(1);
        Self {
            delay_us,
            jitter_us: ((p99_us - delay_us).max(0.0) / 0.99).ceil(),
            loss: f64::from(lost) / f64::from(sent),
        }
    }

    /// Delay, jitter and loss.
    #[must_use]
    pub const fn values(self) -> [f64; 3] {
        [self.delay_us, self.jitter_us, self.loss]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modelled_line_has_the_99th_percentile_of_the_measured_one() {
        let [p50, p99] = [1_400_100, 1_999_000].map(Duration::from_nanos);
        let point = Point::of(p50, p99, 998, 2);
        assert_eq!(point, Point { delay_us: 1401.0, jitter_us: 605.0, loss: 0.002 });
        assert!(point.delay_us + 0.99 * point.jitter_us >= 1999.0);
    }
}
