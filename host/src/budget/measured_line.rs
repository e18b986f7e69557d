//! A line to a drive as the map's axes have it, from the round trip that was measured on it.

use std::time::Duration;

use crate::doctor::round_trip::{self, Timing};
use lashloop_bench::device::{Connection, DeviceChoice, DeviceError, LineSpeed, session_number};
use lashloop_bench::link::latency_timer::LatencyTimer;
use lashloop_bench::session::Session;
use lashloop_bench::supervisor::Supervisor;

/// A measured line.
#[derive(Debug)]
pub struct MeasuredLine {
    pub timing: Timing,
    /// `None` for a line that isn't a terminal.
    pub latency_timer: Option<LatencyTimer>,
}

/// The position of a line on a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub delay_us: f64,
    pub jitter_us: f64,
    /// Fraction of samples without an answer.
    pub loss: f64,
}

impl MeasuredLine {
    /// Opens the line as a run does, with a shortened latency timer if the system permits it, and sends `rounds` samples to the
    /// disarmed drive.
    ///
    /// # Errors
    /// The line can't be opened, or no drive answers.
    pub fn measure(
        choice: &DeviceChoice,
        speed: LineSpeed,
        rounds: u32,
        supervisor: &Supervisor,
    ) -> Result<Self, DeviceError> {
        let timer_before_ms = choice.terminal().and_then(LatencyTimer::read_ms);
        let (link, connection) = Connection::open(choice, speed, supervisor)?;
        let latency_timer =
            choice.terminal().map(|terminal| LatencyTimer::shorten(terminal).since(timer_before_ms));
        let explain = |source| connection.explain(source);
        let mut session = Session::open(link, session_number()).map_err(explain)?;
        let timing = round_trip::measure(&mut session, rounds).map_err(explain)?;
        Ok(Self { timing, latency_timer })
    }
}

impl Point {
    /// Delay is the median of the round trip. Jitter has the 99th percentile of the round trip as its own: of a uniform jitter
    /// from 0 to J above the delay that is 0.99 J. The slowest hundredth of the samples is not modelled.
    #[must_use]
    pub fn of(timing: &Timing) -> Self {
        let us = |time: Duration| (time.as_secs_f64() * 1e6).ceil();
        let (delay_us, p99_us) = (us(timing.p50), us(timing.p99));
        let sent = (timing.answered + timing.lost).max(1);
        Self {
            delay_us,
            jitter_us: ((p99_us - delay_us).max(0.0) / 0.99).ceil(),
            loss: f64::from(timing.lost) / f64::from(sent),
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
        let [p50, p99, max] = [1_400_100, 1_999_000, 9_000_000].map(Duration::from_nanos);
        let timing = Timing { answered: 998, lost: 2, surplus: 0, left_out: 0, p50, p99, max };
        let point = Point::of(&timing);
        assert_eq!(point, Point { delay_us: 1401.0, jitter_us: 605.0, loss: 0.002 });
        assert!(point.delay_us + 0.99 * point.jitter_us >= 1999.0);
    }
}
