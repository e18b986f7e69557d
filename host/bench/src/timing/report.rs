//! The timing of all steps together.

use std::fmt;

use lashloop_session::counted;
use serde::{Deserialize, Serialize};

use super::quantiles::{Durations, Quantiles};
use super::step_timing::{StepOutcome, StepTiming};

/// What paces a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClockName {
    /// The plant waits for the drive and the drive for the plant.
    #[default]
    Lockstep,
    /// The wall clock.
    RealTime,
}

impl fmt::Display for ClockName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(match self {
            Self::Lockstep => "lockstep",
            Self::RealTime => "real time",
        })
    }
}

/// Place of the compute time in [`Timings::round_trip`].
const COMPUTE: usize = 3;

/// Collects the timing of steps.
#[derive(Debug, Clone)]
pub struct Timings {
    /// The counts so far.
    report: TimingReport,
    /// Steps at the start that are excluded.
    warm_up: u64,
    run_of_late: u64,
    lateness: Durations,
    /// The whole round trip, then its parts in the order of [`RoundTrip`](super::RoundTrip).
    round_trip: [Durations; 5],
}

impl Timings {
    /// An empty collection that excludes the first `warm_up` steps. `period_us` is the control period.
    #[must_use]
    pub fn new(clock: ClockName, period_us: u32, warm_up: u64) -> Self {
        let report = TimingReport { clock, period_us, ..TimingReport::default() };
        let round_trip = std::array::from_fn(|_| Durations::new());
        Self { report, warm_up, run_of_late: 0, lateness: Durations::new(), round_trip }
    }

    /// Adds the next step.
    pub fn push(&mut self, step: &StepTiming) {
        let report = &mut self.report;
        if report.warm_up_steps < self.warm_up {
            report.warm_up_steps += 1;
            return;
        }
        report.steps += 1;
        match step.outcome {
            StepOutcome::Answered => self.run_of_late = 0,
            StepOutcome::Unanswered => report.unanswered += 1,
            StepOutcome::Missed => report.missed += 1,
        }
        if step.outcome != StepOutcome::Answered {
            self.run_of_late += 1;
            report.longest_run_of_late = report.longest_run_of_late.max(self.run_of_late);
        }
        let is_due = report.clock == ClockName::RealTime || step.tick_compute.is_some();
        if is_due && step.outcome != StepOutcome::Missed {
            self.lateness.record(step.lateness);
        }
        if let Some(compute) = step.tick_compute {
            self.round_trip[COMPUTE].record(compute);
        }
        if let Some(trip) = &step.round_trip {
            let times = [trip.total(), trip.send, trip.line_and_device, trip.compute, trip.receive];
            self.round_trip.iter_mut().zip(times).for_each(|(histogram, time)| histogram.record(time));
        }
    }

    /// The report. `refused` names the privileges that the system did not grant.
    #[must_use]
    pub fn report(&self, refused: Vec<String>) -> TimingReport {
        let [round_trip_us, send_us, line_and_device_us, compute_us, receive_us] =
            self.round_trip.each_ref().map(Durations::quantiles);
        TimingReport {
            lateness_us: self.lateness.quantiles(),
            round_trip_us,
            send_us,
            line_and_device_us,
            compute_us,
            receive_us,
            lateness_histogram: self.lateness.bins(),
            round_trip_histogram: self.round_trip[0].bins(),
            refused,
            ..self.report.clone()
        }
    }
}

/// The timing of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TimingReport {
    /// What paced it.
    pub clock: ClockName,
    /// Control period in microseconds.
    pub period_us: u32,
    /// Steps at the start that the report excludes.
    pub warm_up_steps: u64,
    /// Steps in the report.
    pub steps: u64,
    /// Steps without a torque by their end.
    pub unanswered: u64,
    /// Steps that the bench overslept.
    pub missed: u64,
    /// Most unanswered or missed steps in a row.
    pub longest_run_of_late: u64,
    /// From the due time of a step to its beginning; in real time, and in bench mode by the drive's clock.
    pub lateness_us: Option<Quantiles>,
    /// From the sample to the torque.
    pub round_trip_us: Option<Quantiles>,
    /// Part of the round trip: encoding and writing, see [`RoundTrip`](super::RoundTrip).
    pub send_us: Option<Quantiles>,
    /// Part of the round trip: the line in both directions and the device without its compute time.
    pub line_and_device_us: Option<Quantiles>,
    /// Part of the round trip: the drive's compute time.
    pub compute_us: Option<Quantiles>,
    /// Part of the round trip: reading and decoding.
    pub receive_us: Option<Quantiles>,
    /// Histogram of lateness: upper end of each bin in microseconds, and its steps.
    pub lateness_histogram: Vec<(f64, u64)>,
    /// Histogram of round trips, likewise.
    pub round_trip_histogram: Vec<(f64, u64)>,
    /// Privileges that the system did not grant, with its reasons.
    pub refused: Vec<String>,
}

impl TimingReport {
    /// Steps without a torque of their own.
    #[must_use]
    pub fn late(&self) -> u64 {
        self.unanswered + self.missed
    }
}

impl fmt::Display for TimingReport {
    /// A table on several lines.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { clock, period_us, steps, unanswered, missed, longest_run_of_late, .. } = self;
        write!(out, "{clock}, period {period_us} us, {}", counted(*steps, "step"))?;
        if self.warm_up_steps > 0 {
            write!(out, " after {} of warm-up", self.warm_up_steps)?;
        }
        write!(out, "; {unanswered} unanswered, {missed} missed, at most {longest_run_of_late} in a row")?;
        write!(out, "\n{:18}{:>10}{:>10}{:>10}{:>10}", "us", "p50", "p99", "p99.9", "max")?;
        let rows = [
            ("lateness", self.lateness_us),
            ("round trip", self.round_trip_us),
            ("  send", self.send_us),
            ("  line and device", self.line_and_device_us),
            ("  compute", self.compute_us),
            ("  receive", self.receive_us),
        ];
        for (name, quantiles) in rows {
            if let Some(Quantiles { p50, p99, p99_9, max }) = quantiles {
                write!(out, "\n{name:18}{p50:>10.1}{p99:>10.1}{p99_9:>10.1}{max:>10.1}")?;
            }
        }
        for refusal in &self.refused {
            write!(out, "\nnot granted: {refusal}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::timing::RoundTrip;

    const US: Duration = Duration::from_micros(1);

    fn step(outcome: StepOutcome) -> StepTiming {
        let parts = RoundTrip { send: 2 * US, line_and_device: 20 * US, compute: 5 * US, receive: 3 * US };
        StepTiming {
            lateness: 10 * US,
            outcome,
            round_trip: (outcome == StepOutcome::Answered).then_some(parts),
            tick_compute: None,
        }
    }

    fn report(warm_up: u64, outcomes: &[StepOutcome]) -> TimingReport {
        let mut timings = Timings::new(ClockName::RealTime, 1_000, warm_up);
        outcomes.iter().for_each(|outcome| timings.push(&step(*outcome)));
        timings.report(Vec::new())
    }

    #[test]
    fn only_an_answer_ends_a_run_of_late_steps() {
        use StepOutcome::{Answered, Missed, Unanswered};
        let report = report(0, &[Unanswered, Answered, Missed, Unanswered, Missed, Answered, Unanswered]);
        assert_eq!((report.unanswered, report.missed, report.longest_run_of_late), (3, 2, 3));
        assert_eq!(report.late(), 5);
    }

    #[test]
    fn the_warm_up_is_excluded() {
        use StepOutcome::{Answered, Unanswered};
        let report = report(2, &[Unanswered, Unanswered, Answered]);
        assert_eq!((report.warm_up_steps, report.steps, report.unanswered), (2, 1, 0));
        assert_eq!(report.longest_run_of_late, 0);
    }

    #[test]
    fn the_parts_of_the_round_trip_add_up() {
        let report = report(0, &[StepOutcome::Answered]);
        let sum: f64 = [report.send_us, report.line_and_device_us, report.compute_us, report.receive_us]
            .map(|part| part.expect("a part").max)
            .iter()
            .sum();
        assert!((sum - 30.0).abs() < 0.1 && (report.round_trip_us.expect("a trip").max - 30.0).abs() < 0.1);
    }

    #[test]
    fn a_missed_step_has_no_lateness_of_its_own() {
        assert_eq!(report(0, &[StepOutcome::Missed]).lateness_us, None);
    }

    #[test]
    fn lockstep_has_no_lateness() {
        let mut timings = Timings::new(ClockName::Lockstep, 1_000, 0);
        timings.push(&step(StepOutcome::Answered));
        assert_eq!(timings.report(Vec::new()).lateness_us, None);
    }
}
