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
    (notes, vec![Band { name, from: 0.0, to: end_s, low, high }])
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
    let end_s = run.times_s().last().copied().unwrap_or_default();
    expectations.filter_map(|it| band(it, name, end_s)).collect()
}

fn band(expectation: &JudgedExpectation, name: &str, end_s: f64) -> Option<Band> {
    let JudgedExpectation { quantity, window, min, max, .. } = expectation;
    let (signal, statistic) = match quantity {
        Quantity::Statistic { signal, statistic } => (&**signal, *statistic),
        Quantity::Metric(Metric::PeakTorque) => ("torque_nm", Statistic::Peak),
        Quantity::Metric(Metric::PeakTrackingError) => ("error_rad", Statistic::Peak),
        Quantity::Metric(_) => return None,
    };
    if signal != name {
        return None;
    }
    // Only these bound every value of the window.
    let (low, high) = match statistic {
        Statistic::Min => (*min, None),
        Statistic::Max => (None, *max),
        Statistic::Peak => (max.map(|it| -it), *max),
        _ => return None,
    };
    let (from, to) = window.map_or((0.0, end_s), |it| (it.from_s, it.to_s.unwrap_or(end_s)));
    (low.is_some() || high.is_some()).then_some(Band { name: "expected", from, to, low, high })
}

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
        let band = Band { name: "5 % band", from: 0.0, to: 0.999, low: Some(-0.05), high: Some(0.05) };
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
        let (data, _) = charts(&run, &Panels::default());
        let peak = Band { name: "expected", from: 0.2, to: 0.5, low: Some(-2.0), high: Some(2.0) };
        assert_eq!(chart(&data, "Torque").bands, [peak], "a root mean square bounds no value");
        let least = Band { name: "expected", from: 0.0, to: 0.999, low: Some(-3.0), high: None };
        assert_eq!(chart(&data, "Drive's own signals in plain").bands, [least]);
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
