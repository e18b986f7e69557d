//! The numbers: what the paper says, what comes out here, and what the law beyond it does.

use std::fmt;

use lashloop_plant::metrics::Metric;

use super::curves::written;
use super::hysteresis::thickness;
use super::laws::{Laws, Run, Runs};

/// Lines of numbers under a title, for a terminal as text and for the page as cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// What the numbers are of.
    pub title: &'static str,
    /// Names of the columns after the first.
    pub columns: Vec<&'static str>,
    /// What a line is about, with its unit, and its cells.
    pub rows: Vec<(String, Vec<String>)>,
}

/// All tables.
pub fn tables(runs: &Runs) -> [Table; 3] {
    [paper(runs), bench(runs), estimators(runs)]
}

/// The value of a line for one run.
type Value<'a> = &'a dyn Fn(&Run) -> String;

fn cells(laws: &Laws, value: Value) -> [String; 3] {
    laws.each().map(|(_, _, run)| value(run))
}

fn metric(metric: Metric, decimals: usize) -> impl Fn(&Run) -> String {
    move |run| written(run.metrics.get(metric), decimals)
}

fn paper(runs: &Runs) -> Table {
    const SILENT: &str = "-";
    let Runs { smooth, friction, bench, sine, ratio, .. } = runs;
    let thickness = |run: &Run| written(thickness(run, *ratio), 3);
    let lines: [(&str, &str, &str, &Laws, Value); 12] = [
        (
            "smooth: time into 0.05 rad (s), figure 7",
            "about 13",
            "about 5.2",
            smooth,
            &metric(Metric::SettleTime, 2),
        ),
        ("smooth: static error (rad), figure 8", SILENT, SILENT, smooth, &metric(Metric::StaticError, 4)),
        ("smooth: overshoot (rad)", SILENT, SILENT, smooth, &metric(Metric::Overshoot, 3)),
        ("smooth: hysteresis of the step (rad), figure 13", "thick", "thinner", smooth, &thickness),
        ("sine, bench: lost motion (rad), figure 13", SILENT, SILENT, sine, &metric(Metric::LostMotion, 4)),
        (
            "smooth: rms of w_hat - w (N m), figure 14",
            SILENT,
            "linear",
            smooth,
            &metric(Metric::DisturbingTorqueRmsError, 3),
        ),
        (
            "friction: static error (rad), figure 15",
            "about 0.32",
            "eliminated",
            friction,
            &metric(Metric::StaticError, 4),
        ),
        (
            "bench: static error (rad), figure 15",
            "about 0.32",
            "eliminated",
            bench,
            &metric(Metric::StaticError, 4),
        ),
        ("friction: overshoot (rad)", SILENT, SILENT, friction, &metric(Metric::Overshoot, 3)),
        ("friction: hunting (rad), figure 16", "oscillates", "none", friction, &metric(Metric::Hunting, 4)),
        (
            "friction: torque variation (N m), figure 17",
            "noisy",
            "cleaner",
            friction,
            &metric(Metric::TorqueTotalVariation, 0),
        ),
        (
            "bench: torque variation (N m), figure 17",
            "noisy",
            "cleaner",
            bench,
            &metric(Metric::TorqueTotalVariation, 0),
        ),
    ];
    Table {
        title: "paper / here / beyond",
        columns: vec!["paper before", "here before", "paper after", "here after", "beyond"],
        rows: lines
            .into_iter()
            .map(|(what, paper_before, paper_after, laws, value)| {
                let [before, after, beyond] = cells(laws, value);
                (
                    what.to_owned(),
                    vec![paper_before.to_owned(), before, paper_after.to_owned(), after, beyond],
                )
            })
            .collect(),
    }
}

const LAWS: [&str; 3] = ["before", "after", "beyond"];

fn bench(runs: &Runs) -> Table {
    let Runs { bench, sine, .. } = runs;
    let lines: [(&str, &Laws, Value); 10] = [
        ("time into 0.05 rad (s)", bench, &metric(Metric::SettleTime, 2)),
        ("time into 2 % (s)", bench, &metric(Metric::SettleTime2Pct, 2)),
        ("time into 1 % (s)", bench, &metric(Metric::SettleTime1Pct, 2)),
        ("static error (rad)", bench, &metric(Metric::StaticError, 4)),
        ("hunting, last 10 s (rad)", bench, &metric(Metric::Hunting, 4)),
        ("overshoot (rad)", bench, &metric(Metric::Overshoot, 3)),
        ("total variation of torque (N m)", bench, &metric(Metric::TorqueTotalVariation, 0)),
        ("effort (N^2 m^2 s)", bench, &metric(Metric::Effort, 1)),
        ("slow sine: lost motion (rad)", sine, &metric(Metric::LostMotion, 4)),
        ("slow sine: total variation of torque (N m)", sine, &metric(Metric::TorqueTotalVariation, 0)),
    ];
    Table {
        title: "the bench: backlash, Stribeck friction, lag, delay, 4000 counts",
        columns: LAWS.to_vec(),
        rows: lines
            .into_iter()
            .map(|(what, laws, value)| (what.to_owned(), cells(laws, value).to_vec()))
            .collect(),
    }
}

fn estimators(runs: &Runs) -> Table {
    let Runs { smooth, friction, bench, sine, .. } = runs;
    let scores: [(&str, Value); 5] = [
        ("j_hat into 0.02 rad of j0 for good (s)", &metric(Metric::DeadZoneSettleTime, 2)),
        ("bias of j_hat, last 5 s (rad)", &metric(Metric::DeadZoneBias, 4)),
        ("largest error of j_hat once right (rad)", &metric(Metric::DeadZoneLargestError, 3)),
        ("rms of w_hat - w (N m)", &metric(Metric::DisturbingTorqueRmsError, 3)),
        ("bias of w_hat (N m)", &metric(Metric::DisturbingTorqueBias, 3)),
    ];
    let plants = [("smooth", smooth), ("friction", friction), ("bench", bench), ("sine", sine)];
    Table {
        title: "the estimates of gap and disturbing torque (before estimates nothing: j_hat = j0, w_hat = 0)",
        columns: LAWS.to_vec(),
        rows: plants
            .iter()
            .flat_map(|(plant, laws)| {
                scores
                    .iter()
                    .map(move |(what, value)| (format!("{plant}: {what}"), cells(laws, value).to_vec()))
            })
            .collect(),
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = self.rows.iter().map(|(what, _)| what.chars().count()).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|(_, cells)| cells.get(column));
            cells.map(String::len).chain([self.columns[column].len()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        writeln!(f, "{}", self.title)?;
        write!(f, "{:first$}", "")?;
        for (name, width) in self.columns.iter().zip(&widths) {
            write!(f, "  {name:>width$}")?;
        }
        for (what, cells) in &self.rows {
            write!(f, "\n{what:first$}")?;
            for (cell, width) in cells.iter().zip(&widths) {
                write!(f, "  {cell:>width$}")?;
            }
        }
        Ok(())
    }
}
