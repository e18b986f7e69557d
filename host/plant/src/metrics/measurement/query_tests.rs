//! Statistics of signals, and windows.

use crate::metrics::fixture::{PERIOD_S, assert_close, at_rest, measure, signals, steps};
use crate::metrics::{
    Measured, Measurement, Metric, Metrics, Plan, Quantity, Query, Sample, Statistic, Window,
};

/// Measures `queries` in a run of `seconds`.
fn ask(queries: &[Query], seconds: f64, at: impl Fn(f64) -> Sample<'static>) -> Metrics {
    let signals = signals();
    let plan = Plan { period_s: PERIOD_S, steps: steps(seconds), reference: None, signals: &signals };
    measure(Measurement::of_run(&plan, queries.to_vec()), seconds, at)
}

fn statistic(signal: &str, statistic: Statistic) -> Query {
    Query { quantity: Quantity::Statistic { signal: signal.to_owned(), statistic }, window: None }
}

fn within(query: impl Into<Query>, first: u32, end: u32) -> Query {
    let at = |step: u32| f64::from(step) * PERIOD_S;
    Query { window: Some(Window { from_s: at(first), to_s: Some(at(end)) }), ..query.into() }
}

#[test]
fn every_statistic_of_a_sawtooth_has_its_closed_form() {
    // Two sawteeth from -1 to 2.999 rad: 4000 values in steps of 1 mrad, twice.
    let sawtooth = |t_s: f64| ((t_s / PERIOD_S).round() % 4000.0) * 1e-3 - 1.0;
    let want = [
        (Statistic::Min, -1.0),
        (Statistic::Max, 2.999),
        (Statistic::Mean, 0.9995),
        // The variance of n equal steps h is h^2 (n^2 - 1) / 12.
        (Statistic::Rms, (0.9995_f64.powi(2) + (16e6 - 1.0) * 1e-6 / 12.0).sqrt()),
        (Statistic::Peak, 2.999),
        (Statistic::PeakToPeak, 3.999),
        (Statistic::Std, ((16e6 - 1.0) * 1e-6 / 12.0_f64).sqrt()),
        (Statistic::Final, 2.999),
    ];
    assert_eq!(want.map(|(statistic, _)| statistic), Statistic::ALL);
    for (kind, want) in want {
        let query = statistic("motor_position_rad", kind);
        let metrics = ask(std::slice::from_ref(&query), 8.0, |t_s| Sample {
            motor_position_rad: sawtooth(t_s),
            ..at_rest(t_s)
        });
        assert_close(kind, metrics.answer(&query), want);
    }
}

#[test]
fn peak_counts_both_signs() {
    let query = statistic("torque_nm", Statistic::Peak);
    let metrics = ask(std::slice::from_ref(&query), 1.0, |t_s| Sample { torque_nm: -t_s, ..at_rest(t_s) });
    assert_close("peak", metrics.answer(&query), 0.999);
}

#[test]
fn deviation_survives_a_large_mean() {
    // +-1e-3 around 1e4: the sum of squares would lose it to rounding.
    let alternating = |t_s: f64| 1e4 + if (t_s / PERIOD_S).round() % 2.0 == 0.0 { 1e-3 } else { -1e-3 };
    let query = statistic("motor_position_rad", Statistic::Std);
    let metrics = ask(std::slice::from_ref(&query), 10.0, |t_s| Sample {
        motor_position_rad: alternating(t_s),
        ..at_rest(t_s)
    });
    assert_close("std", metrics.answer(&query), 1e-3);
}

#[test]
fn any_signal_has_statistics_by_its_name() {
    let at = |t_s: f64| Sample {
        reference_rad: 1.0,
        load_position_rad: 2.0,
        motor_position_rad: 3.0,
        torque_nm: 4.0,
        plant: &[5.0, 6.0],
        drive: Some(&[7.0, 8.0, 9.0]),
        ..at_rest(t_s)
    };
    let signals = signals();
    let queries: Vec<_> = signals.names().map(|name| statistic(&name, Statistic::Mean)).collect();
    let metrics = ask(&queries, 0.1, at);
    let have: Vec<_> = queries.iter().map(|query| metrics.answer(query)).collect();
    assert_eq!(have, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0].map(Measured::Value));
    let units: Vec<_> = signals.names().filter_map(|name| signals.unit(&name)).collect();
    assert_eq!(units, ["rad", "rad", "rad", "N m", "rad", "N m", "rad", "N m", "rad"]);
}

#[test]
fn drive_signal_counts_the_samples_with_telemetry_only() {
    let query = statistic("drive.dead_zone_estimate_rad", Statistic::Mean);
    let every_tenth = |t_s: f64| Sample {
        drive: ((t_s / PERIOD_S).round() % 10.0 == 0.0).then_some(&[2.0, 0.0]),
        ..at_rest(t_s)
    };
    assert_close("mean", ask(std::slice::from_ref(&query), 1.0, every_tenth).answer(&query), 2.0);
    let silent = ask(std::slice::from_ref(&query), 1.0, at_rest);
    assert_eq!(silent.answer(&query), Measured::NoTelemetry);
}

#[test]
fn signal_that_is_not_finite_takes_its_own_statistics_only() {
    for kind in Statistic::ALL {
        let (bad, good) = (statistic("dead_zone_rad", kind), statistic("disturbing_torque_nm", kind));
        let at = |t_s: f64| Sample {
            plant: if t_s == 0.0 { &[f64::NAN, 0.0] } else { &[1.0, 0.0] },
            ..at_rest(t_s)
        };
        let metrics = ask(&[bad.clone(), good.clone()], 1.0, at);
        assert_eq!(metrics.answer(&bad), Measured::NotFinite, "{kind}");
        assert_close(kind, metrics.answer(&good), 0.0);
    }
}

#[test]
fn unknown_signal_has_no_statistic() {
    let query = statistic("drive.temperature", Statistic::Max);
    let metrics = ask(std::slice::from_ref(&query), 1.0, at_rest);
    assert_eq!(metrics.answer(&query), Measured::UnknownSignal);
    assert_eq!(metrics.answer(&statistic("torque_nm", Statistic::Max)), Measured::NotMeasured);
}

#[test]
fn window_is_measured_as_a_run_of_its_own() {
    // Far from the reference but for 2 s to 4 s, where the error falls from 0.4005 rad by 0.2 rad/s.
    let at = |t_s: f64| {
        let error_rad = if (1.9995..3.9995).contains(&t_s) { 0.4005 - 0.2 * (t_s - 2.0) } else { 9.0 };
        Sample { load_position_rad: error_rad, ..at_rest(t_s) }
    };
    let query = |metric: Metric| within(metric, 2000, 4000);
    let metrics = [
        Metric::SettleTime,
        Metric::SettleTime5Pct,
        Metric::StaticError,
        Metric::PeakTrackingError,
        Metric::Hunting,
    ];
    let have = ask(&metrics.map(query), 10.0, at);
    // The error is 0.05 rad 1.7525 s after the start of the window, and 5 % of its first value after 1.9024 s.
    assert_close("settle", have.answer(&query(Metric::SettleTime)), 1.753);
    assert_close("settle 5 %", have.answer(&query(Metric::SettleTime5Pct)), 1.903);
    assert_close("static", have.answer(&query(Metric::StaticError)), 0.1006);
    assert_close("peak", have.answer(&query(Metric::PeakTrackingError)), 0.4005);
    assert_eq!(have.answer(&query(Metric::Hunting)), Measured::RunTooShort);
    assert_eq!(have.get(Metric::SettleTime), Measured::Never);
}

#[test]
fn window_that_the_run_did_not_reach_has_no_value() {
    let query = within(Metric::PeakTorque, 500, 1001);
    let metrics = ask(std::slice::from_ref(&query), 1.0, at_rest);
    assert_eq!(metrics.answer(&query), Measured::RunTooShort);
    let reached = within(Metric::PeakTorque, 500, 1000);
    assert_close("peak", ask(std::slice::from_ref(&reached), 1.0, at_rest).answer(&reached), 0.0);
}

#[test]
fn run_that_is_not_finite_answers_no_query() {
    let queries = [statistic("dead_zone_rad", Statistic::Min), within(Metric::PeakTorque, 0, 10)];
    let metrics = ask(&queries, 1.0, |t_s| Sample {
        torque_nm: if t_s > 0.5 { f64::NAN } else { 0.0 },
        ..at_rest(t_s)
    });
    for query in &queries {
        assert_eq!(metrics.answer(query), Measured::NotFinite);
    }
}

#[test]
fn window_without_an_end_reaches_to_the_end_of_the_run() {
    let window = Some(Window { from_s: 0.9, to_s: None });
    let query = Query { window, ..statistic("torque_nm", Statistic::Min) };
    let metrics = ask(std::slice::from_ref(&query), 1.0, |t_s| Sample { torque_nm: t_s, ..at_rest(t_s) });
    assert_close("min", metrics.answer(&query), 0.9);
}
