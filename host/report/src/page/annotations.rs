//! What a chart says about its curves: rise and settling of a step, and the limits that the scenario expects.

use lashloop_bench::verdict::JudgedExpectation;
use lashloop_plant::metrics::{Metric, Quantity, Statistic};

use super::data::{Band, Mark};
use super::input::Run;
use super::typeset::shown;

/// Bands of settling: metric, fraction of the first error, name.
const SETTLING: [(Metric, f64, &str); 3] = [
    (Metric::SettleTime5Pct, 0.05, "5 % band"),
    (Metric::SettleTime2Pct, 0.02, "2 % band"),
    (Metric::SettleTime1Pct, 0.01, "1 % band"),
];

/// Rise and settling of a load whose reference stays: notes, and the band of 5 % around the reference.
pub(super) fn of_step(run: &Run) -> (Vec<Mark>, Vec<Band>) {
    let Some((reference_rad, way_rad, end_s)) = step(run) else { return Default::default() };
    let metric = |metric: Metric| run.record.summary.as_ref()?.metrics.get(metric.name()).copied().flatten();
    let mut notes = Vec::new();
    if let Some(rise_s) = metric(Metric::RiseTime)
        && let Some(x) = first_at(run, reference_rad - 0.1 * way_rad)
    {
        notes.push(Mark { x, label: format!("rise in {} s", shown(rise_s)) });
    }
    for (settling, _, name) in SETTLING.into_iter().take(2) {
        if let Some(x) = metric(settling) {
            let percent = name.trim_end_matches(" band");
            notes.push(Mark { x, label: format!("within {percent} after {} s", shown(x)) });
        }
    }
    let (_, fraction, name) = SETTLING[0];
    let half_rad = fraction * way_rad.abs();
    let [low, high] = [-half_rad, half_rad].map(|it| Some(reference_rad + it));
    let name = name.to_owned();
    (notes, vec![Band { name, is_expected: false, from: 0.0, to: end_s, low, high }])
}

/// Reference, way of the load to it, and time of the last step; `None` if the reference moves, or the load has no way.
fn step(run: &Run) -> Option<(f64, f64, f64)> {
    let (reference, load) = (run.column("reference_rad")?, run.column("load_position_rad")?);
    let (first, end_s) = (*reference.first()?, *run.times_s().last()?);
    let way_rad = first - load.first()?;
    (reference.iter().all(|it| *it == first) && way_rad.abs() > 1e-6).then_some((first, way_rad, end_s))
}

/// The first time at which the load is at a position, or beyond.
fn first_at(run: &Run, position_rad: f64) -> Option<f64> {
    let load = run.column("load_position_rad")?;
    let side = position_rad >= *load.first()?;
    let at = load.iter().position(|it| if side { *it >= position_rad } else { *it <= position_rad })?;
    run.times_s().get(at).copied()
}

/// What the scenario expects of the values of a signal, in the windows of the expectations.
pub(super) fn of_signal(run: &Run, name: &str) -> Vec<Band> {
    let expectations = run.record.summary.iter().flat_map(|it| &it.expectations);
    expectations.filter_map(|it| band(run, it, name)).collect()
}

/// Distance from the reference within which `settle_time_s` counts, in rad.
const SETTLED_RAD: f64 = 0.05;
/// Time at the end of a window that `static_error_rad` is of.
const STATIC_S: f64 = 1.0;

fn band(run: &Run, expectation: &JudgedExpectation, name: &str) -> Option<Band> {
    let JudgedExpectation { quantity, window, min, max, .. } = expectation;
    let end_s = run.times_s().last().copied().unwrap_or_default();
    let (from_s, to_s) = window.map_or((0.0, end_s), |it| (it.from_s, it.to_s.unwrap_or(end_s)));
    let around = |half: f64| (Some(-half), Some(half));
    let first_error_rad = || {
        let at = run.times_s().partition_point(|time_s| *time_s < from_s);
        Some((run.column("load_position_rad")?.get(at)? - run.column("reference_rad")?.get(at)?).abs())
    };
    let (signal, from, (low, high)) = match quantity {
        // Only these bound every value of the window.
        Quantity::Statistic { signal, statistic: Statistic::Min } => (&**signal, from_s, (*min, None)),
        Quantity::Statistic { signal, statistic: Statistic::Max } => (&**signal, from_s, (None, *max)),
        Quantity::Statistic { signal, statistic: Statistic::Peak } => (&**signal, from_s, around((*max)?)),
        Quantity::Metric(Metric::PeakTorque) => ("torque_nm", from_s, around((*max)?)),
        Quantity::Metric(Metric::PeakTrackingError) => (ERROR, from_s, around((*max)?)),
        Quantity::Metric(Metric::StaticError) => (ERROR, (to_s - STATIC_S).max(from_s), (*min, *max)),
        Quantity::Metric(Metric::SettleTime) => (ERROR, from_s + (*max)?, around(SETTLED_RAD)),
        Quantity::Metric(metric) => {
            let (_, fraction, _) = SETTLING.iter().find(|(it, ..)| it == metric)?;
            (ERROR, from_s + (*max)?, around(fraction * first_error_rad()?))
        }
        Quantity::Statistic { .. } => return None,
    };
    let has_limit = low.is_some() || high.is_some();
    let name = (signal == name && has_limit).then(|| format!("expected of {name}"))?;
    Some(Band { name, is_expected: true, from, to: to_s, low, high })
}

/// Column of the load's position minus its reference.
const ERROR: &str = "error_rad";

#[cfg(test)]
mod tests {
    use lashloop_bench::verdict::JudgedExpectation;
    use lashloop_plant::metrics::{Measured, Window};

    use super::super::chosen_panels::Panels;
    use super::super::data::{Chart, Data};
    use super::super::run_charts::charts;
    use super::super::tests::record;
    use super::*;

    /// A load at cos t, whose reference is 0, and signals of the drive.
    fn run_of(change: impl FnOnce(&mut lashloop_record::summary::Summary)) -> Run {
        let mut record = record("plain", 0, 1_000, 2);
        change(record.summary.as_mut().expect("a summary"));
        Run::new("plain", record)
    }

    fn chart<'a>(data: &'a Data, title: &str) -> &'a Chart {
        data.charts.iter().find(|chart| chart.title == title).expect("the chart")
    }

    #[test]
    fn a_step_has_its_rise_its_settling_and_the_band() {
        let run = run_of(|summary| {
            summary.metrics.insert("rise_time_s".to_owned(), Some(0.25));
            summary.metrics.insert("settle_time_5pct_s".to_owned(), Some(0.4));
            summary.metrics.insert("settle_time_2pct_s".to_owned(), None);
        });
        let (data, _) = charts(&run, &Panels::default());
        let position = chart(&data, "Load position");
        let notes: Vec<_> = position.notes.iter().map(|it| (it.x, &*it.label)).collect();
        assert_eq!(notes, [(0.4, "within 5 % after 0.4 s")], "cos t doesn't get to 10 % within a second");
        let band = Band {
            name: "5 % band".to_owned(),
            is_expected: false,
            from: 0.0,
            to: 0.999,
            low: Some(-0.05),
            high: Some(0.05),
        };
        assert_eq!(position.bands, [band]);
        assert_eq!(first_at(&run, 0.9), Some(0.452), "cos 0.451 is above 0.9");
    }

    #[test]
    fn limits_of_every_value_stand_in_the_chart_of_their_signal_and_in_their_window() {
        let expect = |signal: &str, statistic, min, max, window| JudgedExpectation {
            quantity: Quantity::Statistic { signal: signal.to_owned(), statistic },
            window,
            value: Measured::Value(1.0),
            reason: None,
            unit: "N m".to_owned(),
            min,
            max,
            ok: true,
        };
        let window = Some(Window { from_s: 0.2, to_s: Some(0.5) });
        let run = run_of(|summary| {
            summary.expectations = vec![
                expect("torque_nm", Statistic::Peak, None, Some(2.0), window),
                expect("torque_nm", Statistic::Rms, None, Some(1.0), None),
                expect("drive.noise_1", Statistic::Min, Some(-3.0), None, None),
            ];
        });
        let lists = [vec!["torque_nm".to_owned()]];
        let panels = Panels::of(std::slice::from_ref(&run), &lists).expect("a signal");
        let (data, _) = charts(&run, &panels);
        let expected = |of: &str, from, to, low, high| {
            vec![Band { name: format!("expected of {of}"), is_expected: true, from, to, low, high }]
        };
        let peak = expected("torque_nm", 0.2, 0.5, Some(-2.0), Some(2.0));
        assert_eq!(chart(&data, "Torque").bands, peak, "a root mean square bounds no value");
        assert_eq!(chart(&data, "torque_nm").bands, peak, "in the chosen chart, too");
        let least = expected("drive.noise_1", 0.0, 0.999, Some(-3.0), None);
        assert_eq!(chart(&data, "Drive's own signals in plain").bands, least);
    }

    #[test]
    fn settling_and_static_error_bound_the_error_where_they_count() {
        let expect = |metric, min, max| JudgedExpectation {
            quantity: Quantity::Metric(metric),
            window: None,
            value: Measured::Value(1.0),
            reason: None,
            unit: String::new(),
            min,
            max,
            ok: true,
        };
        let run = run_of(|summary| {
            summary.expectations = vec![
                expect(Metric::SettleTime, None, Some(0.5)),
                expect(Metric::SettleTime2Pct, None, Some(0.6)),
                expect(Metric::StaticError, Some(-0.01), Some(0.02)),
                expect(Metric::Effort, None, Some(9.0)),
            ];
        });
        let (data, _) = charts(&run, &Panels::default());
        let bands: Vec<_> =
            chart(&data, "Position error").bands.iter().map(|it| (it.from, it.low, it.high)).collect();
        let expected =
            [(0.5, Some(-0.05), Some(0.05)), (0.6, Some(-0.02), Some(0.02)), (0.0, Some(-0.01), Some(0.02))];
        assert_eq!(bands, expected);
    }

    #[test]
    fn chosen_panels_are_first_and_own_signals_second() {
        let run = run_of(|_| ());
        let lists =
            [vec!["load_position_rad".to_owned(), "reference_rad".to_owned()], vec!["drive.*".to_owned()]];
        let panels = Panels::of(std::slice::from_ref(&run), &lists).expect("signals");
        let (data, _) = charts(&run, &panels);
        let titles: Vec<_> = data.charts.iter().map(|chart| &*chart.title).take(4).collect();
        let chosen = ["load_position_rad, reference_rad in rad", "drive.* in plain"];
        assert_eq!(titles, [chosen[0], chosen[1], "Load position", "Drive's own signals in plain"]);
        assert_eq!(data.charts[1].series.len(), 2);
        let unknown = Panels::of(&[run], &[vec!["twits_rad".to_owned()]]);
        assert!(unknown.expect_err("no signal").to_string().contains("twits_rad"));
    }
}
