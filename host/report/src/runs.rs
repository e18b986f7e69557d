//! The figure of `lashloop plot`: the records of one or several runs.

use std::ops::RangeInclusive;

use crate::plot::{Axis, Figure, Panel, Role, Series};
use lashloop_bench::record::reader::{ReadError, Record};
use lashloop_bench::record::row::Row;
use lashloop_bench::record::timing::TimingRow;
use lashloop_bench::record::trace::TraceRow;

/// Why records can't be plotted.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// A record can't be used.
    #[error(transparent)]
    Record(#[from] ReadError),
    /// No run has a step in the selected range.
    #[error("no step lies in the range from {from_s} s {}; the records end at {end_s} s", to(*until_s))]
    Nothing {
        /// Start of the range, in s.
        from_s: f64,
        /// End of the range, in s.
        until_s: f64,
        /// Time of the last step of all runs, in s.
        end_s: f64,
    },
}

fn to(until_s: f64) -> String {
    if until_s.is_finite() { format!("to {until_s} s") } else { "on".to_owned() }
}

/// Largest number of marked faults; more would hide the curves.
const MARKED: usize = 6;

/// Position, position error, torque, gap, estimate and timing of named runs, over a range of time in s.
///
/// # Errors
/// A record lacks a column, or none has a step in the range.
pub fn figure(runs: &[(String, Record)], shown_s: &RangeInclusive<f64>) -> Result<Figure, DrawError> {
    let runs = runs
        .iter()
        .enumerate()
        .map(|(number, (name, record))| Run::new(number, name, record, shown_s))
        .collect::<Result<Vec<_>, _>>()?;
    if runs.iter().all(|run| run.trace.is_empty()) {
        return Err(DrawError::Nothing {
            from_s: *shown_s.start(),
            until_s: *shown_s.end(),
            end_s: runs.iter().map(|run| run.end_s).fold(f64::NAN, f64::max),
        });
    }
    let title = match &runs[..] {
        [run] => format!("Record of {}", run.name),
        runs => format!("{} records", runs.len()),
    };
    let caption: Vec<_> = runs.iter().map(Run::caption).collect();
    let mut figure = Figure::new(title, caption.join("\n"), 2)
        .panel(position(&runs))
        .panel(of_all(&runs, "Position error", Axis::new("load less reference", "rad"), |row| {
            row.load_position_rad - row.reference_rad
        }))
        .panel(of_all(&runs, "Control torque", Axis::new("torque", "N m"), |row| row.torque_nm))
        .panel(gap(&runs))
        .panel(estimate(&runs));
    if runs.iter().any(|run| run.timing.is_some()) {
        figure = figure.panel(round_trip(&runs));
    }
    Ok(figure)
}

/// One run and its rows in the range.
struct Run<'a> {
    role: Role,
    name: &'a str,
    record: &'a Record,
    /// Step of the first row in the range.
    first_step: usize,
    trace: Vec<TraceRow>,
    /// All rows. After a killed run it may be shorter than the trace, because the two files are written in turn.
    timing: Option<Vec<TimingRow>>,
    /// Time of the last row of the record.
    end_s: f64,
}

impl<'a> Run<'a> {
    fn new(
        number: usize,
        name: &'a str,
        record: &'a Record,
        shown_s: &RangeInclusive<f64>,
    ) -> Result<Self, ReadError> {
        let mut trace = TraceRow::read(&record.trace)?;
        let end_s = trace.last().map_or(f64::NAN, |row| row.time_s);
        trace.truncate(trace.partition_point(|row| row.time_s <= *shown_s.end()));
        let first_step = trace.partition_point(|row| row.time_s < *shown_s.start());
        trace.drain(..first_step);
        let timing = record.timing.as_ref().map(TimingRow::read).transpose()?;
        // The two most distinct colours first.
        let role = match number {
            0 => Role::After,
            1 => Role::Before,
            more => Role::Other(more - 2),
        };
        Ok(Self { role, name, record, first_step, trace, timing, end_s })
    }

    fn column(&self, value: impl Fn(&TraceRow) -> f64) -> Vec<f64> {
        self.trace.iter().map(value).collect()
    }

    fn time_s(&self) -> Vec<f64> {
        self.column(|row| row.time_s)
    }

    fn series(&self, values: Vec<f64>) -> Series {
        Series::new(self.name, self.role, self.time_s(), values)
    }

    fn caption(&self) -> String {
        let Record { trace, timing: timing_table, summary } = self.record;
        let mut text = match summary {
            Some(it) => {
                let end = if it.end == "complete" { String::new() } else { format!(", {}", it.end) };
                format!(
                    "{}: {} with {} on {}: {}{end}.",
                    self.name, it.scenario, it.controller, it.device, it.verdict
                )
            }
            None => format!("{}: no summary, so the run ended without a verdict.", self.name),
        };
        text += &format!(" {} steps", trace.len());
        match &self.timing {
            None => text += "; timing.csv is missing.",
            Some(timing) => {
                let known = timing.len();
                if known < trace.len() {
                    text += &format!("; timing.csv covers {known} of them");
                }
                match timing.iter().filter(|row| row.answered == 0.0).count() {
                    0 if known == 0 => text += ".",
                    0 => text += ", all answered.",
                    count => text += &format!(", {count} without an answer in time."),
                }
            }
        }
        if trace.is_torn || timing_table.as_ref().is_some_and(|table| table.is_torn) {
            text += " The last row of the record is incomplete and ignored.";
        }
        text
    }
}

/// A panel over time with a curve of every run.
fn of_all(runs: &[Run<'_>], title: &str, axis: Axis, value: impl Fn(&TraceRow) -> f64) -> Panel {
    let panel = Panel::new(title, Axis::new("time", "s"), axis);
    runs.iter().fold(panel, |panel, run| panel.series(run.series(run.column(&value))))
}

fn round_trip(runs: &[Run<'_>]) -> Panel {
    let panel = Panel::new("Round trip", Axis::new("time", "s"), Axis::new("sample to torque", "us"));
    runs.iter().fold(panel, |panel, run| {
        let timing = run.timing.iter().flatten().skip(run.first_step).take(run.trace.len());
        let sum_us = timing.map(|row| row.send_us + row.line_and_device_us + row.compute_us + row.receive_us);
        panel.series(run.series(sum_us.collect()))
    })
}

/// Adds a curve of every run, and of equal ones only the first.
fn distinct<'a>(
    panel: Panel,
    runs: &'a [Run<'a>],
    label: &str,
    role: Role,
    points: impl Fn(&Run<'a>) -> (Vec<f64>, Vec<f64>),
) -> Panel {
    let same =
        |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.total_cmp(b).is_eq());
    let mut drawn: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for (x, y) in runs.iter().map(points) {
        if !drawn.iter().any(|other| same(&x, &other.0) && same(&y, &other.1)) {
            drawn.push((x, y));
        }
    }
    drawn.into_iter().fold(panel, |panel, (x, y)| panel.series(Series::new(label, role, x, y)))
}

/// Load position and reference, with the faults of the scenario.
fn position(runs: &[Run<'_>]) -> Panel {
    let panel = Panel::new("Load position", Axis::new("time", "s"), Axis::new("load position", "rad"));
    let reference = |run: &Run<'_>| (run.time_s(), run.column(|row| row.reference_rad));
    let mut panel = distinct(panel, runs, "reference", Role::Reference, reference);
    for run in runs {
        panel = panel.series(run.series(run.column(|row| row.load_position_rad)));
        let faults = run.record.summary.iter().flat_map(|summary| &summary.faults);
        let marks = faults.filter_map(|fault| {
            let row = run.trace.get(fault.step.checked_sub(run.first_step)?)?;
            Some((&fault.kind, row))
        });
        for (kind, row) in marks.take(MARKED) {
            panel = panel.mark(kind, run.role, row.time_s, row.load_position_rad);
        }
    }
    panel
}

/// Twist, the motor position less the reduced load position: outside the edges of the gap the motor drives the load.
fn gap(runs: &[Run<'_>]) -> Panel {
    let panel = of_all(runs, "Twist and the gap", Axis::new("twist", "rad"), |row| row.twist_rad);
    distinct(panel, runs, "edges of the gap", Role::Limit, |run| {
        let edge = |sign: f64| run.column(|row| sign * row.dead_zone_rad);
        // One curve for both edges; the NaN separates them.
        let x = [run.time_s(), vec![f64::NAN], run.time_s()].concat();
        (x, [edge(1.0), vec![f64::NAN], edge(-1.0)].concat())
    })
}

fn estimate(runs: &[Run<'_>]) -> Panel {
    let axis = Axis::new("dead-zone amplitude", "rad");
    let panel = of_all(runs, "Dead-zone estimate", axis, |row| row.dead_zone_estimate_rad);
    let true_gap = |run: &Run<'_>| (run.time_s(), run.column(|row| row.dead_zone_rad));
    distinct(panel, runs, "true", Role::Reference, true_gap)
}
