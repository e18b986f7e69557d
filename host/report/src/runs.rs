//! The figure of `lashloop plot`: records and captures of one or several runs.

use std::ops::RangeInclusive;

use lashloop_record::columns::Columns;
use lashloop_record::reader::{ReadError, Record};
use lashloop_record::timing::TimingRow;
use lashloop_record::trace::TIME;

use crate::chosen::{self, Source};
pub use crate::draw_error::DrawError;
use crate::steps::{round_trip_us, row_of_step};
use lashloop_plot::{Axis, Figure, Panel, Role, Series};

/// What is plotted.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Range of time, in s.
    pub shown_s: RangeInclusive<f64>,
    /// Signals that get a panel of their own. `*` stands for any characters.
    pub signals: Vec<String>,
    /// Signals that share a panel, as far as they share a unit. With such a choice the standard panels are omitted.
    pub panels: Vec<Vec<String>>,
}

/// What a figure is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// The record of a run.
    Record(Box<Record>),
    /// The steps of a capture.
    Capture {
        /// The axis first: `time_s`, or the number of the step.
        columns: Columns,
        /// Why the capture ends early, if it does.
        torn: Option<String>,
    },
    /// A table in a file, such as what a drive has captured; the time first.
    Table(Columns),
}

/// Largest number of marked faults; more would hide the curves.
const MARKED: usize = 6;

const DEAD_ZONE_RAD: &str = "dead_zone_rad";
const ESTIMATE_RAD: &str = "drive.dead_zone_estimate_rad";
const TWIST_RAD: &str = "twist_rad";

/// The chosen panels of named inputs. Without a choice, these are the standard panels: position, position error, torque and
/// timing of records, twist of those with a gap, estimate of those with an estimator; and all signals of captures, by unit.
///
/// # Errors
/// A record lacks a column that every run has, no input has a selected signal, or none has a step in the range.
pub fn figure(inputs: &[(String, Input)], selection: &Selection) -> Result<Figure, DrawError> {
    let shown_s = &selection.shown_s;
    let mut runs = Vec::new();
    let mut captures = Vec::new();
    for (number, (name, input)) in inputs.iter().enumerate() {
        match input {
            Input::Record(record) => runs.push(Run::new(number, name, record, shown_s)?),
            Input::Capture { columns, torn } => {
                let origin = format!("from the frames of a capture.{}", after_space(torn.as_deref()));
                captures.push(Capture::new(name, columns, "steps", origin, shown_s));
            }
            Input::Table(columns) => {
                captures.push(Capture::new(name, columns, "rows", "of a table.".to_owned(), shown_s));
            }
        }
    }
    let sources: Vec<Source<'_>> = inputs
        .iter()
        .filter_map(|(name, _)| {
            let run = runs.iter().find(|run| run.name == name).map(Run::source);
            run.or_else(|| captures.iter().find(|capture| capture.name == name).map(Capture::source))
        })
        .collect();
    check_axes(&sources)?;
    if sources.iter().all(|source| source.columns.is_empty()) {
        let ends_s = runs.iter().map(|run| run.end_s).chain(captures.iter().map(|capture| capture.end_s));
        return Err(DrawError::Nothing {
            from_s: *shown_s.start(),
            until_s: *shown_s.end(),
            end_s: ends_s.fold(f64::NAN, f64::max),
        });
    }
    let title = match inputs {
        [(name, Input::Record(_))] => format!("Record of {name}"),
        [(name, Input::Capture { .. } | Input::Table(_))] => format!("Capture {name}"),
        inputs if captures.is_empty() => format!("{} records", inputs.len()),
        inputs => format!("{} records and captures", inputs.len()),
    };
    let caption: Vec<_> =
        runs.iter().map(Run::caption).chain(captures.iter().map(Capture::caption)).collect();
    let mut panels = Vec::new();
    if selection.panels.is_empty() && captures.is_empty() {
        panels.extend(standard(&runs));
    }
    panels.extend(chosen::apart(&sources, &selection.signals)?);
    for names in &selection.panels {
        panels.extend(chosen::together(&sources, names)?);
    }
    if panels.is_empty() {
        panels = chosen::together(&sources, &["*".to_owned()])?;
    }
    if selection.panels.is_empty() && captures.is_empty() {
        panels.push(round_trip(&runs));
    }
    let columns = panels.len().min(2);
    Ok(panels.into_iter().fold(Figure::new(title, caption.join("\n"), columns), Figure::panel))
}

fn standard(runs: &[Run<'_>]) -> Vec<Panel> {
    let mut panels = vec![
        position(runs),
        of_all(runs, "Position error", Axis::new("load less reference", "rad"), |run| {
            let load_and_reference = run.column("load_position_rad").zip(run.column("reference_rad"));
            load_and_reference
                .map(|(load, reference)| load.iter().zip(reference).map(|(a, b)| a - b).collect())
        }),
        of_all(runs, "Control torque", Axis::new("torque", "N m"), |run| run.values("torque_nm")),
    ];
    if runs.iter().any(|run| run.column(TWIST_RAD).is_some()) {
        panels.push(gap(runs));
    }
    if runs.iter().any(|run| run.column(ESTIMATE_RAD).is_some()) {
        panels.push(estimate(runs));
    }
    panels
}

/// All inputs have to be over time, or all over steps.
fn check_axes(sources: &[Source<'_>]) -> Result<(), DrawError> {
    let Some(first) = sources.first() else { return Ok(()) };
    match sources.iter().find(|source| source.axis() != first.axis()) {
        None => Ok(()),
        Some(other) => {
            let without = if other.axis() == TIME { first } else { other };
            Err(DrawError::Axes { name: without.name.to_owned() })
        }
    }
}

fn after_space(reason: Option<&str>) -> String {
    reason.map_or_else(String::new, |reason| format!(" {reason}."))
}

/// One capture or table, and its rows in the range.
struct Capture<'a> {
    name: &'a str,
    shown: Columns,
    /// What a row is.
    row: &'static str,
    origin: String,
    end_s: f64,
}

impl<'a> Capture<'a> {
    fn new(
        name: &'a str,
        columns: &Columns,
        row: &'static str,
        origin: String,
        shown_s: &RangeInclusive<f64>,
    ) -> Self {
        let axis = columns.signals().first().map_or("", |signal| &signal.name);
        let axis = columns.get(axis).unwrap_or_default();
        let end_s = axis.last().copied().unwrap_or(f64::NAN);
        Self { name, shown: columns.select(|row| shown_s.contains(&axis[row])), row, origin, end_s }
    }

    fn source(&self) -> Source<'_> {
        Source { name: self.name, columns: &self.shown, is_sparse: true }
    }

    fn caption(&self) -> String {
        format!("{}: {} {} {}", self.name, self.shown.len(), self.row, self.origin)
    }
}

/// One run and its rows in the range.
struct Run<'a> {
    role: Role,
    name: &'a str,
    record: &'a Record,
    /// The first row in the range.
    first_row: usize,
    shown: Columns,
    /// All rows.
    timing: Vec<TimingRow>,
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
        let time_s = record.column(TIME)?;
        for column in ["reference_rad", "load_position_rad", "torque_nm"] {
            record.column(column)?;
        }
        let end = time_s.partition_point(|time_s| time_s <= shown_s.end());
        let first_row = time_s[..end].partition_point(|time_s| time_s < shown_s.start());
        let shown = record.trace.select(|row| (first_row..end).contains(&row));
        let timing = record.timing.rows();
        let role = Role::Line { colour: number, dash: number };
        let end_s = time_s.last().copied().unwrap_or(f64::NAN);
        Ok(Self { role, name, record, first_row, shown, timing, end_s })
    }

    fn source(&self) -> Source<'_> {
        Source { name: self.name, columns: &self.shown, is_sparse: false }
    }

    /// The rows of a column in the range; `None` if the record has no such column.
    fn column(&self, name: &str) -> Option<&[f64]> {
        self.shown.get(name)
    }

    fn values(&self, name: &str) -> Option<Vec<f64>> {
        self.column(name).map(<[f64]>::to_vec)
    }

    fn time_s(&self) -> Vec<f64> {
        self.values(TIME).unwrap_or_default()
    }

    fn series(&self, values: Vec<f64>) -> Series {
        Series::new(self.name, self.role, self.time_s(), values)
    }

    fn caption(&self) -> String {
        let Record { manifest, trace, summary, is_torn, .. } = self.record;
        let mut text = match summary {
            Some(it) => {
                let end = it.end.early().map(|end| format!(", {end}")).unwrap_or_default();
                format!(
                    "{}: {} with {} on {}: {}{end}.",
                    self.name, it.scenario, it.controller, it.device, it.verdict
                )
            }
            None => format!("{}: no summary, so the run ended without a verdict.", self.name),
        };
        if !manifest.mode.is_hil() {
            text += " Positions are those of the drive's encoders; a bench has no truth.";
        }
        text += &format!(" {} steps", trace.len());
        match self.timing.iter().filter(|row| row.answered == 0.0).count() {
            0 => text += ", all answered.",
            count => text += &format!(", {count} without an answer in time."),
        }
        if *is_torn {
            text += " The last chunk of the record is incomplete and ignored.";
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

fn round_trip(runs: &[Run<'_>]) -> Panel {
    of_all(runs, "Round trip", Axis::new("sample to torque", "us"), |run| {
        let timing = run.timing.iter().skip(run.first_row).take(run.shown.len());
        Some(timing.map(round_trip_us).collect())
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
            let row = row_of_step(run.record, fault.step)?.checked_sub(run.first_row)?;
            Some((&*fault.kind, *time_s.get(row)?, *load_rad.get(row)?))
        });
        let marks: Vec<_> = marks.take(MARKED).collect();
        panel = panel.series(run.series(load_rad.clone()));
        for (kind, time_s, position_rad) in marks {
            panel = panel.mark(kind, run.role, time_s, position_rad);
        }
    }
    panel
}

/// Twist, the motor position minus the reduced load position: outside the edges of the gap the motor drives the load.
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
