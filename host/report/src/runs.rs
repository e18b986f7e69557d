//! The figure of `lashloop plot`: the records of one or several runs.

use std::ops::RangeInclusive;

use lashloop_bench::names::UnknownName;
use lashloop_record::columns::Columns;
use lashloop_record::reader::{ReadError, Record, Table};
use lashloop_record::timing::TimingRow;

use crate::plot::{Axis, Figure, Panel, Role, Series};

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
    /// No record has the signal.
    #[error("{name}: {reason}")]
    Signal {
        /// The signal as the user named it.
        name: String,
        /// The names there are.
        reason: UnknownName,
    },
    /// Two records have the signal in different units.
    #[error(
        "{name} is in {} in {record} and in {} in {other_record}; plot them apart",
        named(unit),
        named(other)
    )]
    Units {
        /// The signal.
        name: String,
        /// A record.
        record: String,
        /// Its unit.
        unit: String,
        /// Another record.
        other_record: String,
        /// Its unit.
        other: String,
    },
}

fn to(until_s: f64) -> String {
    if until_s.is_finite() { format!("to {until_s} s") } else { "on".to_owned() }
}

fn named(unit: &str) -> &str {
    if unit.is_empty() { "no unit" } else { unit }
}

/// What is plotted of the records.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Range of time, in s.
    pub shown_s: RangeInclusive<f64>,
    /// Columns of the traces that get a panel of their own, in addition to the standard ones.
    pub signals: Vec<String>,
}

/// Largest number of marked faults; more would hide the curves.
const MARKED: usize = 6;

const DEAD_ZONE_RAD: &str = "dead_zone_rad";
const ESTIMATE_RAD: &str = "drive.dead_zone_estimate_rad";
const TWIST_RAD: &str = "twist_rad";

/// Position, position error, torque, timing and the selected signals of named runs. Runs of a plant with a gap also get the
/// twist, runs of a drive with an estimator its estimate.
///
/// # Errors
/// A record lacks a column that every run has, none has a selected signal, or none has a step in the range.
pub fn figure(runs: &[(String, Record)], selection: &Selection) -> Result<Figure, DrawError> {
    let shown_s = &selection.shown_s;
    let runs = runs
        .iter()
        .enumerate()
        .map(|(number, (name, record))| Run::new(number, name, record, shown_s))
        .collect::<Result<Vec<_>, _>>()?;
    if runs.iter().all(|run| run.shown.is_empty()) {
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
        .panel(of_all(&runs, "Position error", Axis::new("load less reference", "rad"), |run| {
            let load_and_reference = run.column("load_position_rad").zip(run.column("reference_rad"));
            load_and_reference
                .map(|(load, reference)| load.iter().zip(reference).map(|(a, b)| a - b).collect())
        }))
        .panel(of_all(&runs, "Control torque", Axis::new("torque", "N m"), |run| run.values("torque_nm")));
    if runs.iter().any(|run| run.column(TWIST_RAD).is_some()) {
        figure = figure.panel(gap(&runs));
    }
    if runs.iter().any(|run| run.column(ESTIMATE_RAD).is_some()) {
        figure = figure.panel(estimate(&runs));
    }
    for name in &selection.signals {
        figure = figure.panel(signal(&runs, name)?);
    }
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
    shown: Columns,
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
        let time_s = record.trace.column("time_s")?;
        for column in ["reference_rad", "load_position_rad", "torque_nm"] {
            record.trace.column(column)?;
        }
        let end = time_s.partition_point(|time_s| time_s <= shown_s.end());
        let first_step = time_s[..end].partition_point(|time_s| time_s < shown_s.start());
        let shown = record.trace.columns.select(|row| (first_step..end).contains(&row));
        let timing = record.timing.as_ref().map(Table::rows::<TimingRow>).transpose()?;
        // The two most distinct colours first.
        let role = match number {
            0 => Role::After,
            1 => Role::Before,
            more => Role::Other(more - 2),
        };
        let end_s = time_s.last().copied().unwrap_or(f64::NAN);
        Ok(Self { role, name, record, first_step, shown, timing, end_s })
    }

    /// The rows of a column in the range; `None` if the record has no such column.
    fn column(&self, name: &str) -> Option<&[f64]> {
        self.shown.get(name)
    }

    fn values(&self, name: &str) -> Option<Vec<f64>> {
        self.column(name).map(<[f64]>::to_vec)
    }

    fn time_s(&self) -> Vec<f64> {
        self.values("time_s").unwrap_or_default()
    }

    fn series(&self, values: Vec<f64>) -> Series {
        Series::new(self.name, self.role, self.time_s(), values)
    }

    fn caption(&self) -> String {
        let Record { trace, timing: timing_table, summary, .. } = self.record;
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
        if summary.as_ref().is_some_and(|it| !it.mode.is_hil()) {
            text += " Positions are those of the drive's encoders; a bench has no truth.";
        }
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

/// A panel over time with a curve of every run that has the quantity.
fn of_all(
    runs: &[Run<'_>],
    title: &str,
    axis: Axis,
    quantity: impl Fn(&Run<'_>) -> Option<Vec<f64>>,
) -> Panel {
    let panel = Panel::new(title, Axis::new("time", "s"), axis);
    let curves = runs.iter().filter_map(|run| quantity(run).map(|values| run.series(values)));
    curves.fold(panel, Panel::series)
}

/// A panel with a column of the traces; its unit is the axis'.
fn signal(runs: &[Run<'_>], name: &str) -> Result<Panel, DrawError> {
    let mut units = runs.iter().filter_map(|run| run.shown.unit(name).map(|unit| (run, unit)));
    let Some((first, unit)) = units.next() else {
        let known = runs.iter().flat_map(|run| run.shown.signals()).map(|signal| &*signal.name);
        let mut names = Vec::new();
        for name in known {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let reason = UnknownName::new("the record", "signal", name, names);
        return Err(DrawError::Signal { name: name.to_owned(), reason });
    };
    if let Some((run, other)) = units.find(|(_, other)| *other != unit) {
        return Err(DrawError::Units {
            name: name.to_owned(),
            record: first.name.to_owned(),
            unit: unit.to_owned(),
            other_record: run.name.to_owned(),
            other: other.to_owned(),
        });
    }
    Ok(of_all(runs, name, Axis::new(name, unit), |run| run.values(name)))
}

fn round_trip(runs: &[Run<'_>]) -> Panel {
    of_all(runs, "Round trip", Axis::new("sample to torque", "us"), |run| {
        let timing = run.timing.iter().flatten().skip(run.first_step).take(run.shown.len());
        let sum_us = timing.map(|row| row.send_us + row.line_and_device_us + row.compute_us + row.receive_us);
        Some(sum_us.collect())
    })
}

/// Adds a curve of every run that has one, and of equal ones only the first.
fn distinct<'a>(
    panel: Panel,
    runs: &'a [Run<'a>],
    label: &str,
    role: Role,
    points: impl Fn(&Run<'a>) -> Option<(Vec<f64>, Vec<f64>)>,
) -> Panel {
    let same =
        |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.total_cmp(b).is_eq());
    let mut drawn: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for (x, y) in runs.iter().filter_map(points) {
        if !drawn.iter().any(|other| same(&x, &other.0) && same(&y, &other.1)) {
            drawn.push((x, y));
        }
    }
    drawn.into_iter().fold(panel, |panel, (x, y)| panel.series(Series::new(label, role, x, y)))
}

/// Load position and reference, with the faults of the scenario.
fn position(runs: &[Run<'_>]) -> Panel {
    let panel = Panel::new("Load position", Axis::new("time", "s"), Axis::new("load position", "rad"));
    let reference = |run: &Run<'_>| Some((run.time_s(), run.values("reference_rad")?));
    let mut panel = distinct(panel, runs, "reference", Role::Reference, reference);
    for run in runs {
        let load_rad = run.values("load_position_rad").unwrap_or_default();
        let faults = run.record.summary.iter().flat_map(|summary| &summary.faults);
        let time_s = run.time_s();
        let marks = faults.filter_map(|fault| {
            let row = fault.step.checked_sub(run.first_step)?;
            Some((&fault.kind, *time_s.get(row)?, *load_rad.get(row)?))
        });
        let marks: Vec<_> = marks.take(MARKED).collect();
        panel = panel.series(run.series(load_rad.clone()));
        for (kind, time_s, position_rad) in marks {
            panel = panel.mark(kind, run.role, time_s, position_rad);
        }
    }
    panel
}

/// Twist, the motor position less the reduced load position: outside the edges of the gap the motor drives the load.
fn gap(runs: &[Run<'_>]) -> Panel {
    let panel = of_all(runs, "Twist and the gap", Axis::new("twist", "rad"), |run| run.values(TWIST_RAD));
    distinct(panel, runs, "edges of the gap", Role::Limit, |run| {
        let half_gap_rad = run.column(DEAD_ZONE_RAD)?;
        let edge = |sign: f64| half_gap_rad.iter().map(|half_gap_rad| sign * half_gap_rad).collect();
        // One curve for both edges; the NaN separates them.
        let x = [run.time_s(), vec![f64::NAN], run.time_s()].concat();
        Some((x, [edge(1.0), vec![f64::NAN], edge(-1.0)].concat()))
    })
}

fn estimate(runs: &[Run<'_>]) -> Panel {
    let axis = Axis::new("dead-zone amplitude", "rad");
    let panel = of_all(runs, "Dead-zone estimate", axis, |run| run.values(ESTIMATE_RAD));
    let true_gap = |run: &Run<'_>| Some((run.time_s(), run.values(DEAD_ZONE_RAD)?));
    distinct(panel, runs, "true", Role::Reference, true_gap)
}
