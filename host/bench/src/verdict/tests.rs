//! Verdicts of runs of one second with a constant error.

use std::time::Duration;

use super::{Exit, Judgement, LinkCounts, Verdict};
use crate::scenario::expectation::Expectation;
use crate::scenario::sections::Allowance;
use crate::timing::{ClockName, RoundTrip, StepOutcome, StepTiming, TimingReport, Timings};
use lashloop_plant::metrics::{
    Measurement, Metric, Metrics, Plan, Quantity, Query, Sample, SignalTable, Statistic, Window,
};

fn metrics(load_position_rad: f64) -> Metrics {
    let mut measurement = Measurement::new(0.001, &SignalTable::default());
    for step in 0..1000 {
        measurement.push(&Sample {
            time_s: f64::from(step) * 0.001,
            reference_rad: 0.0,
            load_position_rad,
            motor_position_rad: 0.0,
            torque_nm: 0.0,
            plant: &[],
            drive: None,
        });
    }
    measurement.metrics()
}

/// A run of one second whose torque is its time, with the answers to these expectations.
fn rising_torque(expectations: &[Expectation]) -> Metrics {
    let signals = SignalTable::default();
    let plan = Plan { period_s: 0.001, steps: 1000, reference: None, signals: &signals };
    let mut measurement = Measurement::of_run(&plan, expectations.iter().map(Expectation::query));
    for step in 0..1000 {
        let time_s = f64::from(step) * 0.001;
        measurement.push(&Sample {
            time_s,
            reference_rad: 0.0,
            load_position_rad: 0.0,
            motor_position_rad: 0.0,
            torque_nm: time_s,
            plant: &[],
            drive: None,
        });
    }
    measurement.metrics()
}

fn expect(metric: Metric, min: Option<f64>, max: Option<f64>) -> Expectation {
    Expectation::of_metric(metric, min, max)
}

fn judge(expectations: &[Expectation], metrics: &Metrics) -> Judgement {
    Judgement::new(expectations, metrics, &Allowance::default(), &LinkCounts::default(), &timing(&[]))
}

#[test]
fn a_value_on_its_bound_passes_and_beyond_it_fails() {
    let metrics = metrics(0.25);
    for (min, max, verdict) in [
        (Some(0.25), Some(0.25), Verdict::Pass),
        (Some(0.25), None, Verdict::Pass),
        (None, Some(0.25), Verdict::Pass),
        (Some(0.26), None, Verdict::Fail),
        (None, Some(0.24), Verdict::Fail),
    ] {
        let judgement = judge(&[expect(Metric::StaticError, min, max)], &metrics);
        assert_eq!(judgement.verdict, verdict, "{min:?} to {max:?}");
    }
}

#[test]
fn one_missed_expectation_of_many_fails_the_run() {
    let expectations = [
        expect(Metric::StaticError, Some(0.0), Some(1.0)),
        expect(Metric::Overshoot, None, Some(0.0)),
        expect(Metric::SettleTime, None, Some(100.0)),
    ];
    let judgement = judge(&expectations, &metrics(0.25));
    assert_eq!(judgement.verdict, Verdict::Fail);
    let lines: Vec<_> = judgement.expectations.iter().map(ToString::to_string).collect();
    insta::assert_snapshot!(lines.join("\n"), @r#"
    static_error_rad: 0.25 rad; meets 0 to 1 rad
    overshoot_rad: 0 rad; meets at most 0 rad
    settle_time_s: never; misses at most 100 s
    "#);
}

#[test]
fn signals_and_windows_are_judged_like_metrics() {
    let window = Some(Window { from_s: 0.25, to_s: Some(0.5) });
    let at_most = |query: Query| Expectation::new(query, "N m", None, Some(0.6));
    let statistic = |signal: &str, statistic| Quantity::Statistic { signal: signal.to_owned(), statistic };
    let expectations = [
        at_most(Query { quantity: Quantity::Metric(Metric::PeakTorque), window: None }),
        at_most(Query { quantity: Quantity::Metric(Metric::PeakTorque), window }),
        at_most(Query { quantity: statistic("torque_nm", Statistic::Mean), window: None }),
        at_most(Query { quantity: statistic("torque_nm", Statistic::Min), window }),
        at_most(Query { quantity: statistic("drive.load_error_rad", Statistic::Max), window: None }),
    ];
    let judgement = judge(&expectations, &rising_torque(&expectations));
    assert_eq!(judgement.verdict, Verdict::Fail);
    let lines: Vec<_> = judgement.expectations.iter().map(ToString::to_string).collect();
    insta::assert_snapshot!(lines.join("\n"), @r#"
    peak_torque_nm: 0.999 N m; misses at most 0.6 N m
    peak_torque_nm, 0.25 s to 0.5 s: 0.499 N m; meets at most 0.6 N m
    mean of torque_nm: 0.4995 N m; meets at most 0.6 N m
    min of torque_nm, 0.25 s to 0.5 s: 0.25 N m; meets at most 0.6 N m
    max of drive.load_error_rad: unknown signal; misses at most 0.6 N m
    "#);
    let unasked = judge(&expectations[1..2], &rising_torque(&[]));
    assert_eq!(unasked.verdict, Verdict::Fail, "an expectation without a measurement can't pass");
}

#[test]
fn a_metric_that_is_not_finite_always_fails() {
    let nan = metrics(f64::NAN);
    for metric in Metric::ALL {
        let judged = &judge(&[expect(metric, Some(f64::MIN), Some(f64::MAX))], &nan).expectations[0];
        assert!(!judged.ok, "{judged}");
    }
    assert_eq!(judge(&[], &nan).verdict, Verdict::Fail);
    assert_eq!(judge(&[], &metrics(0.0)).verdict, Verdict::Pass);
}

#[test]
fn a_link_beyond_its_allowance_makes_even_a_failed_run_invalid() {
    let allow = Allowance { lost: 2, late: 5, ..Allowance::default() };
    let missed = [expect(Metric::StaticError, None, Some(0.0))];
    let lockstep = Timings::new(ClockName::Lockstep, 1_000, 0).report(Vec::new());
    let judge = |counts| Judgement::new(&missed, &metrics(0.25), &allow, &counts, &lockstep);
    let counts =
        LinkCounts { frames_sent: 1000, frames_received: 998, lost: 2, late: 5, ..LinkCounts::default() };
    assert_eq!(judge(counts).verdict, Verdict::Fail);
    for (counts, reason) in [
        (LinkCounts { lost: 3, ..counts }, "lost: 3 counted, allow.lost is 2"),
        (LinkCounts { late: 6, ..counts }, "late: 6 counted, allow.late is 5"),
        (LinkCounts { crc_errors: 1, ..counts }, "crc_errors: 1 counted, allow.crc_errors is 0"),
    ] {
        let judgement = judge(counts);
        assert_eq!(judgement.verdict, Verdict::Invalid);
        assert_eq!(judgement.breaches.iter().map(ToString::to_string).collect::<Vec<_>>(), [reason]);
    }
}

#[test]
fn timing_beyond_its_allowance_makes_even_a_failed_run_invalid() {
    use StepOutcome::{Answered, Missed, Unanswered};
    let timing = timing(&[Answered, Unanswered, Missed, Answered, Unanswered]);
    let missed = [expect(Metric::StaticError, None, Some(0.0))];
    let counts = LinkCounts { lost: 1, late: 1, ..LinkCounts::default() };
    let judge = |allow: &Allowance| Judgement::new(&missed, &metrics(0.25), allow, &counts, &timing);
    let enough = Allowance {
        late: 3,
        late_in_a_row: Some(2),
        lateness_p99_us: Some(11),
        round_trip_p99_us: Some(31),
        ..Allowance::default()
    };
    assert_eq!(judge(&enough).verdict, Verdict::Fail);
    for (allow, reason) in [
        (Allowance { late: 2, ..enough }, "late: 3 counted, allow.late is 2"),
        (
            Allowance { late_in_a_row: Some(1), ..enough },
            "late_in_a_row: 2 counted, allow.late_in_a_row is 1",
        ),
        (
            Allowance { lateness_p99_us: Some(9), ..enough },
            "lateness_p99_us: 11 counted, allow.lateness_p99_us is 9",
        ),
        (
            Allowance { round_trip_p99_us: Some(20), ..enough },
            "round_trip_p99_us: 31 counted, allow.round_trip_p99_us is 20",
        ),
    ] {
        let judgement = judge(&allow);
        assert_eq!(judgement.verdict, Verdict::Invalid);
        assert_eq!(judgement.breaches.iter().map(ToString::to_string).collect::<Vec<_>>(), [reason]);
    }
}

#[test]
fn what_was_never_measured_meets_no_limit() {
    let limit = Some(1_000_000);
    let allow =
        Allowance { late: 9, lateness_p99_us: limit, round_trip_p99_us: limit, ..Allowance::default() };
    let timing = timing(&[StepOutcome::Missed; 3]);
    let judgement = Judgement::new(&[], &metrics(0.0), &allow, &LinkCounts::default(), &timing);
    assert_eq!(judgement.verdict, Verdict::Invalid);
    let reasons: Vec<_> = judgement.breaches.iter().map(ToString::to_string).collect();
    assert_eq!(
        reasons,
        [
            "lateness_p99_us: nothing to measure, allow.lateness_p99_us is 1000000",
            "round_trip_p99_us: nothing to measure, allow.round_trip_p99_us is 1000000",
        ]
    );
}

/// Timing of a run in real time, each step with a lateness of 10 us and a round trip of 30 us.
fn timing(outcomes: &[StepOutcome]) -> TimingReport {
    const US: Duration = Duration::from_micros(1);
    let parts = RoundTrip { send: 2 * US, line_and_device: 20 * US, compute: 5 * US, receive: 3 * US };
    let mut timings = Timings::new(ClockName::RealTime, 1_000, 0);
    for outcome in outcomes {
        let round_trip = (*outcome == StepOutcome::Answered).then_some(parts);
        timings.push(&StepTiming { lateness: 10 * US, outcome: *outcome, round_trip, tick_compute: None });
    }
    timings.report(Vec::new())
}

#[test]
fn every_end_of_a_run_has_its_own_exit_code() {
    let ends = [
        Verdict::Pass.into(),
        Verdict::Fail.into(),
        Exit::UsageOrScenario,
        Verdict::Invalid.into(),
        Exit::DeviceOrLink,
    ];
    assert_eq!(ends.map(|exit: Exit| exit as u8), [0, 1, 2, 3, 4]);
}
