//! The numbers: the paper's, ours, and those of the law beyond.

use std::fmt;

use lashloop_bench::text_table::aligned;
use lashloop_plant::metrics::Metric;

use super::curves::written;
use super::hysteresis::thickness;
use super::laws::{Laws, Runs};

/// A titled table, formatted as text here and as HTML in `page`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Title.
    pub title: &'static str,
    /// Names of the columns after the first.
    pub columns: Vec<&'static str>,
    /// Quantity with its unit, and its cells.
    pub rows: Vec<(String, Vec<String>)>,
}

/// All tables.
pub fn tables(runs: &Runs) -> [Table; 3] {
    [paper(runs), backlash_shaft(runs), estimators(runs)]
}

/// How the cells of a row come from a run.
#[derive(Clone, Copy)]
enum Value {
    /// With this number of decimals.
    Of(Metric, usize),
    /// Thickness of the hysteresis on plants with this reduction ratio.
    Thickness(f64),
}

use Value::{Of, Thickness};

fn cells(laws: &Laws, value: Value) -> [String; 3] {
    laws.each().map(|(_, _, run)| match value {
        Of(metric, decimals) => written(run.metrics.get(metric), decimals),
        Thickness(ratio) => written(thickness(run, ratio), 3),
    })
}

fn paper(runs: &Runs) -> Table {
    let Runs { smooth, friction, shaft, sine, ratio, .. } = runs;
    let settle_time = Of(Metric::SettleTime, 2);
    let static_error = Of(Metric::StaticError, 4);
    let overshoot = Of(Metric::Overshoot, 3);
    let lost_motion = Of(Metric::LostMotion, 4);
    let rms = Of(Metric::DisturbingTorqueRmsError, 3);
    let hunting = Of(Metric::Hunting, 4);
    let variation = Of(Metric::TorqueTotalVariation, 0);
    // The quantity; the paper before and after, "-" where it states nothing; ours.
    let lines = [
        ("smooth: time into 0.05 rad (s), figure 7", ["about 13", "about 5.2"], smooth, settle_time),
        ("smooth: static error (rad), figure 8", ["-", "-"], smooth, static_error),
        ("smooth: overshoot (rad)", ["-", "-"], smooth, overshoot),
        ("smooth: hysteresis of the step (rad), figure 13", ["thick", "thinner"], smooth, Thickness(*ratio)),
        ("sine, shaft: lost motion (rad), figure 13", ["-", "-"], sine, lost_motion),
        ("smooth: rms of w_hat - w (N m), figure 14", ["-", "linear"], smooth, rms),
        ("friction: static error (rad), figure 15", ["about 0.32", "eliminated"], friction, static_error),
        ("shaft: static error (rad), figure 15", ["about 0.32", "eliminated"], shaft, static_error),
        ("friction: overshoot (rad)", ["-", "-"], friction, overshoot),
        ("friction: hunting (rad), figure 16", ["oscillates", "none"], friction, hunting),
        ("friction: torque variation (N m), figure 17", ["noisy", "cleaner"], friction, variation),
        ("shaft: torque variation (N m), figure 17", ["noisy", "cleaner"], shaft, variation),
    ];
    let rows = lines.into_iter().map(|(what, paper, laws, value)| {
        let [before, after, beyond] = cells(laws, value);
        let [paper_before, paper_after] = paper.map(str::to_owned);
        (what.to_owned(), vec![paper_before, before, paper_after, after, beyond])
    });
    Table {
        title: "paper / here / beyond",
        columns: vec!["paper before", "here before", "paper after", "here after", "beyond"],
        rows: rows.collect(),
    }
}

const LAWS: [&str; 3] = ["before", "after", "beyond"];

fn backlash_shaft(runs: &Runs) -> Table {
    let Runs { shaft, sine, .. } = runs;
    let lines = [
        ("time into 0.05 rad (s)", shaft, Metric::SettleTime, 2),
        ("time into 2 % (s)", shaft, Metric::SettleTime2Pct, 2),
        ("time into 1 % (s)", shaft, Metric::SettleTime1Pct, 2),
        ("static error (rad)", shaft, Metric::StaticError, 4),
        ("hunting, last 10 s (rad)", shaft, Metric::Hunting, 4),
        ("overshoot (rad)", shaft, Metric::Overshoot, 3),
        ("total variation of torque (N m)", shaft, Metric::TorqueTotalVariation, 0),
        ("effort (N^2 m^2 s)", shaft, Metric::Effort, 1),
        ("slow sine: lost motion (rad)", sine, Metric::LostMotion, 4),
        ("slow sine: total variation of torque (N m)", sine, Metric::TorqueTotalVariation, 0),
    ];
    let row = |(what, laws, metric, decimals): (&str, _, _, _)| {
        (what.to_owned(), cells(laws, Of(metric, decimals)).to_vec())
    };
    Table {
        title: "the backlash shaft: Stribeck friction, lag, delay, 4000 counts",
        columns: LAWS.to_vec(),
        rows: lines.into_iter().map(row).collect(),
    }
}

fn estimators(runs: &Runs) -> Table {
    let Runs { smooth, friction, shaft, sine, .. } = runs;
    let scores = [
        ("j_hat into 0.02 rad of j0 for good (s)", Metric::DeadZoneSettleTime, 2),
        ("bias of j_hat, last 5 s (rad)", Metric::DeadZoneBias, 4),
        ("largest error of j_hat once right (rad)", Metric::DeadZoneLargestError, 3),
        ("rms of w_hat - w (N m)", Metric::DisturbingTorqueRmsError, 3),
        ("bias of w_hat (N m)", Metric::DisturbingTorqueBias, 3),
    ];
    let plants = [("smooth", smooth), ("friction", friction), ("shaft", shaft), ("sine", sine)];
    let rows = plants.into_iter().flat_map(|(plant, laws)| {
        scores.map(|(what, metric, decimals)| {
            (format!("{plant}: {what}"), cells(laws, Of(metric, decimals)).to_vec())
        })
    });
    Table {
        title: "the estimates of gap and disturbing torque (before estimates nothing: j_hat = j0, w_hat = 0)",
        columns: LAWS.to_vec(),
        rows: rows.collect(),
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = [""].iter().chain(&self.columns).map(ToString::to_string).collect::<Vec<_>>();
        let rows = self.rows.iter().map(|(what, cells)| [std::slice::from_ref(what), &cells[..]].concat());
        let lines = aligned(&[head].into_iter().chain(rows).collect::<Vec<_>>(), |column| column > 0);
        write!(f, "{}\n{}", self.title, lines.join("\n"))
    }
}
