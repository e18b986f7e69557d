//! What a run can't measure, before it is made.

use super::{Plan, RunStart};
use crate::metrics::fixture::{PERIOD_S, signals, steps};
use crate::metrics::{Measured, Metric, Quantity, Query, SignalTable, Statistic, Window};
use crate::reference::{Reference, Trapezoid};

const CONSTANT: Reference = Reference::Constant { position_rad: 0.0 };
const SINE: Reference =
    Reference::Sine { amplitude_rad: 0.5, frequency_hz: 0.1, offset_rad: 0.1, phase_rad: 0.0 };
/// At rest from 3.5 s on.
const MOVE: Reference = Reference::Trapezoid(Trapezoid {
    from_rad: 0.0,
    to_rad: 2.0,
    start_s: 1.0,
    velocity_rad_s: 1.0,
    acceleration_rad_s2: 2.0,
});

#[derive(Clone)]
struct Run {
    reference: Reference,
    seconds: f64,
    load_position_rad: f64,
    telemetry_every: u16,
    signals: SignalTable,
}

/// Every metric but lost motion, the move and the steady velocity can be measured.
fn regulation() -> Run {
    Run {
        reference: CONSTANT,
        seconds: 20.0,
        load_position_rad: 1.0,
        telemetry_every: 10,
        signals: signals(),
    }
}

impl Run {
    fn obstacle(&self, query: &Query) -> Option<Measured> {
        let Self { reference, seconds, load_position_rad, telemetry_every, signals } = self;
        let plan = Plan { period_s: PERIOD_S, steps: steps(*seconds), reference: Some(reference), signals };
        plan.obstacle(
            query,
            &RunStart { load_position_rad: *load_position_rad, telemetry_every: *telemetry_every },
        )
    }

    /// The metrics that this run can't measure.
    fn obstacles(&self) -> Vec<(Metric, Measured)> {
        let obstacle = |metric: Metric| Some((metric, self.obstacle(&metric.into())?));
        Metric::ALL.into_iter().filter_map(obstacle).collect()
    }
}

fn within(metric: Metric, first: u32, end: u32) -> Query {
    let at = |step: u32| f64::from(step) * PERIOD_S;
    Query { window: Some(Window { from_s: at(first), to_s: Some(at(end)) }), ..metric.into() }
}

#[test]
fn regulation_measures_everything_but_motion() {
    let want = [
        (Metric::SettleAfterMove, Measured::NoMove),
        (Metric::SettleAfterEveryMove, Measured::NoMove),
        (Metric::SteadyVelocityError, Measured::NoSteadyVelocity),
        (Metric::LostMotion, Measured::NoReversal),
    ];
    assert_eq!(regulation().obstacles(), want);
}

#[test]
fn slow_sine_measures_lost_motion_and_no_rest() {
    let run = Run { reference: SINE, ..regulation() };
    let want = [
        (Metric::SettleAfterMove, Measured::NoEndOfMotion),
        (Metric::SettleAfterEveryMove, Measured::NoEndOfMotion),
        (Metric::RiseTime, Measured::NoEndOfMotion),
        (Metric::SteadyVelocityError, Measured::NoSteadyVelocity),
    ];
    assert_eq!(run.obstacles(), want);
    // The sine's first passage downwards is at 5 s.
    let query = Query::from(Metric::LostMotion);
    assert_eq!(Run { seconds: 4.9, ..run }.obstacle(&query), Some(Measured::NoReversal));
}

#[test]
fn move_from_rest_measures_motion_and_nothing_relative() {
    let run = Run { reference: MOVE, load_position_rad: 0.0, ..regulation() };
    let want = [
        (Metric::SettleTime5Pct, Measured::NoInitialError),
        (Metric::SettleTime2Pct, Measured::NoInitialError),
        (Metric::SettleTime1Pct, Measured::NoInitialError),
        (Metric::Overshoot, Measured::NoInitialError),
        (Metric::LostMotion, Measured::NoReversal),
    ];
    assert_eq!(run.obstacles(), want);
    let query = Query::from(Metric::SettleAfterMove);
    assert_eq!(Run { seconds: 3.5, ..run }.obstacle(&query), Some(Measured::NoEndOfMotion));
}

#[test]
fn short_run_measures_no_long_window() {
    let short: Vec<_> = Run { seconds: 0.9, ..regulation() }
        .obstacles()
        .into_iter()
        .filter_map(|(metric, reason)| (reason == Measured::RunTooShort).then_some(metric))
        .collect();
    assert_eq!(short, [Metric::StaticError, Metric::Hunting, Metric::DeadZoneBias]);
}

#[test]
fn window_outside_the_run_or_shorter_than_the_metric_is_an_obstacle() {
    let obstacle = |metric: Metric, first, end| regulation().obstacle(&within(metric, first, end));
    assert_eq!(obstacle(Metric::PeakTorque, 19_000, 20_000), None);
    assert_eq!(obstacle(Metric::PeakTorque, 19_000, 20_001), Some(Measured::RunTooShort));
    assert_eq!(obstacle(Metric::PeakTorque, 5, 5), Some(Measured::RunTooShort));
    assert_eq!(obstacle(Metric::StaticError, 0, 1000), None);
    assert_eq!(obstacle(Metric::StaticError, 0, 999), Some(Measured::RunTooShort));
}

#[test]
fn window_that_starts_later_may_have_an_initial_error() {
    let run = Run { reference: MOVE, load_position_rad: 0.0, ..regulation() };
    let query = within(Metric::Overshoot, 2000, 9000);
    assert_eq!(run.obstacle(&query), None);
}

#[test]
fn estimates_need_their_signals_and_telemetry_in_the_window() {
    let query = Query::from(Metric::DeadZoneBias);
    let no_gap = Run { signals: SignalTable { plant: Vec::new(), ..signals() }, ..regulation() };
    assert_eq!(no_gap.obstacle(&query), Some(Measured::MissingSignal("dead_zone_rad")));
    let no_estimate = Run { signals: SignalTable { drive: Vec::new(), ..signals() }, ..regulation() };
    let missing = Some(Measured::MissingSignal("drive.dead_zone_estimate_rad"));
    assert_eq!(no_estimate.obstacle(&query), missing);
    let silent = Run { telemetry_every: 0, ..regulation() };
    assert_eq!(silent.obstacle(&query), Some(Measured::NoTelemetry));
    let between = within(Metric::DeadZoneError, 11, 20);
    assert_eq!(regulation().obstacle(&between), Some(Measured::NoTelemetry));
}

#[test]
fn unknown_signal_is_an_obstacle() {
    let max = |signal: &str| {
        let quantity = Quantity::Statistic { signal: signal.to_owned(), statistic: Statistic::Max };
        regulation().obstacle(&Query { quantity, window: None })
    };
    assert_eq!(max("torque_nm"), None);
    assert_eq!(max("dead_zone_rad"), None);
    assert_eq!(max("dead_zone_estimate_rad"), Some(Measured::UnknownSignal));
    assert_eq!(max("drive.dead_zone_estimate_rad"), None);
}
