//! The picture of `lashloop plot`: what one run or several side by side did, from their records.

use std::ops::RangeInclusive;

use crate::plot::{Axis, Figure, Panel, Role, Series};
use lashloop_bench::record::reader::{ReadError, Record, Table};

/// Why records can't be drawn.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// A record can't be used.
    #[error(transparent)]
    Record(#[from] ReadError),
    /// No run has a step in the part of its time that is to be shown.
    #[error("there is nothing from {from_s} s {}; the records end at {end_s} s", to(*until_s))]
    Nothing {
        /// Beginning of the part.
        from_s: f64,
        /// End of the part.
        until_s: f64,
        /// Time of the last step of all runs.
        end_s: f64,
    },
}

fn to(until_s: f64) -> String {
    if until_s.is_finite() { format!("to {until_s} s") } else { "on".to_owned() }
}

/// Faults that are marked; more would hide the curves.
const MARKED: usize = 6;

/// Position, its error, torque, gap, estimate and timing of some runs, each with its name, over a part of their time in s.
///
/// # Errors
/// A record lacks a column, or none has a step in that part.
pub fn figure(runs: &[(String, Record)], shown_s: &RangeInclusive<f64>) -> Result<Figure, DrawError> {
    let runs = runs
        .iter()
        .enumerate()
        .map(|(number, (name, record))| Run::new(number, name, record, shown_s))
        .collect::<Result<Vec<_>, _>>()?;
    if runs.iter().all(|run| run.rows.is_empty()) {
        let ends = runs.iter().filter_map(|run| run.record.trace.column("time_s").ok()?.last().copied());
        return Err(DrawError::Nothing {
            from_s: *shown_s.start(),
            until_s: *shown_s.end(),
            end_s: ends.fold(f64::NAN, f64::max),
        });
    }
    let title = match &runs[..] {
        [run] => format!("Record of {}", run.name),
        runs => format!("{} records", runs.len()),
    };
    let caption: Vec<_> = runs.iter().map(Run::caption).collect();
    let mut figure = Figure::new(title, caption.join("\n"), 2)
        .panel(position(&runs)?)
        .panel(of_all(&runs, "Position error", ("load less reference", "rad"), |run| {
            let (load, wanted) = (run.trace("load_position_rad")?, run.trace("reference_rad")?);
            Ok(load.iter().zip(&wanted).map(|(load, wanted)| load - wanted).collect())
        })?)
        .panel(of_all(&runs, "Control torque", ("torque", "N m"), |run| run.trace("torque_nm"))?)
        .panel(gap(&runs)?)
        .panel(estimate(&runs)?);
    if runs.iter().any(|run| run.record.timing.is_some()) {
        figure = figure.panel(of_all(&runs, "Round trip", ("sample to torque", "us"), |run| {
            let mut sum_us = run.timing("send_us")?;
            for part in ["line_and_device_us", "compute_us", "receive_us"] {
                sum_us.iter_mut().zip(run.timing(part)?).for_each(|(sum_us, part_us)| *sum_us += part_us);
            }
            Ok(sum_us)
        })?);
    }
    Ok(figure)
}

/// One run and the part of it that is shown.
struct Run<'a> {
    role: Role,
    name: &'a str,
    record: &'a Record,
    rows: std::ops::Range<usize>,
    time_s: &'a [f64],
}

impl<'a> Run<'a> {
    fn new(
        number: usize,
        name: &'a str,
        record: &'a Record,
        shown_s: &RangeInclusive<f64>,
    ) -> Result<Self, ReadError> {
        let time_s = record.trace.column("time_s")?;
        let from = time_s.partition_point(|time_s| time_s < shown_s.start());
        let until = time_s.partition_point(|time_s| time_s <= shown_s.end());
        let rows = from..until.max(from);
        // The two that are easiest to tell apart, then all others.
        let role = match number {
            0 => Role::After,
            1 => Role::Before,
            more => Role::Other(more - 2),
        };
        Ok(Self { role, name, record, time_s: &time_s[rows.clone()], rows })
    }

    fn trace(&self, column: &str) -> Result<Vec<f64>, ReadError> {
        Ok(self.record.trace.column(column)?[self.rows.clone()].to_vec())
    }

    /// A column of the timing, as long as the trace. The two files are written in turn, so that of a run that was killed may
    /// be shorter.
    fn timing(&self, column: &str) -> Result<Vec<f64>, ReadError> {
        let Some(timing) = &self.record.timing else { return Ok(Vec::new()) };
        let values = timing.column(column)?;
        let until = self.rows.end.min(values.len());
        Ok(values[self.rows.start.min(until)..until].to_vec())
    }

    fn series(&self, values: Vec<f64>) -> Series {
        Series::new(self.name, self.role, self.time_s.to_vec(), values)
    }

    fn caption(&self) -> String {
        let Record { trace, timing, summary } = self.record;
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
        match timing.as_ref().map(|timing| timing.column("answered").unwrap_or_default()) {
            None => text += "; there is no timing.csv.",
            Some(answered) => {
                let known = answered.len();
                if known < trace.len() {
                    text += &format!("; timing.csv tells of {known} of them");
                }
                match answered.iter().filter(|flag| **flag == 0.0).count() {
                    0 if known == 0 => text += ".",
                    0 => text += ", all answered.",
                    count => text += &format!(", {count} without an answer in time."),
                }
            }
        }
        if trace.is_torn() || timing.as_ref().is_some_and(Table::is_torn) {
            text += " The record ends within a row, which is left out.";
        }
        text
    }
}

/// A curve of every run over time.
fn of_all(
    runs: &[Run<'_>],
    title: &str,
    (quantity, unit): (&str, &str),
    values: impl Fn(&Run<'_>) -> Result<Vec<f64>, ReadError>,
) -> Result<Panel, ReadError> {
    let panel = Panel::new(title, Axis::new("time", "s"), Axis::new(quantity, unit));
    runs.iter().try_fold(panel, |panel, run| Ok(panel.series(run.series(values(run)?))))
}

/// Adds curves that may be the same for several runs; those are drawn once.
fn each_once(panel: Panel, curves: Vec<Series>) -> Panel {
    let same =
        |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.total_cmp(b).is_eq());
    let mut drawn: Vec<Series> = Vec::new();
    for curve in curves {
        if !drawn.iter().any(|other| same(&curve.x, &other.x) && same(&curve.y, &other.y)) {
            drawn.push(curve);
        }
    }
    drawn.into_iter().fold(panel, Panel::series)
}

fn beside(
    panel: Panel,
    runs: &[Run<'_>],
    (label, role): (&str, Role),
    column: &str,
) -> Result<Panel, ReadError> {
    let curve = |run: &Run<'_>| Ok(Series::new(label, role, run.time_s.to_vec(), run.trace(column)?));
    Ok(each_once(panel, runs.iter().map(curve).collect::<Result<_, _>>()?))
}

/// The load and where it is wanted, with the faults of the scenario.
fn position(runs: &[Run<'_>]) -> Result<Panel, ReadError> {
    let panel = Panel::new("Load position", Axis::new("time", "s"), Axis::new("load position", "rad"));
    let mut panel = beside(panel, runs, ("reference", Role::Reference), "reference_rad")?;
    for run in runs {
        let load_rad = run.trace("load_position_rad")?;
        let faults = run.record.summary.iter().flat_map(|summary| &summary.faults);
        let marks: Vec<_> = faults
            .filter_map(|fault| {
                let row = fault.step.checked_sub(run.rows.start)?;
                Some((fault.kind.clone(), *run.time_s.get(row)?, load_rad[row]))
            })
            .take(MARKED)
            .collect();
        panel = panel.series(run.series(load_rad));
        for (kind, at_s, at_rad) in marks {
            panel = panel.mark(kind, run.role, at_s, at_rad);
        }
    }
    Ok(panel)
}

/// Motor position less the reduced one of the load: outside the edges of the gap the motor drives the load.
fn gap(runs: &[Run<'_>]) -> Result<Panel, ReadError> {
    let panel = of_all(runs, "Twist and the gap", ("twist", "rad"), |run| run.trace("twist_rad"))?;
    let mut edges: Vec<Series> = Vec::new();
    for run in runs {
        let dead_zone_rad = run.trace("dead_zone_rad")?;
        let other_side = dead_zone_rad.iter().map(|dead_zone_rad| -dead_zone_rad);
        // One curve for both sides; what is no number parts them.
        let x = [run.time_s, &[f64::NAN], run.time_s].concat();
        let y = dead_zone_rad.iter().copied().chain([f64::NAN]).chain(other_side).collect();
        edges.push(Series::new("edges of the gap", Role::Limit, x, y));
    }
    Ok(each_once(panel, edges))
}

fn estimate(runs: &[Run<'_>]) -> Result<Panel, ReadError> {
    let panel = of_all(runs, "Dead-zone estimate", ("dead-zone amplitude", "rad"), |run| {
        run.trace("dead_zone_estimate_rad")
    })?;
    beside(panel, runs, ("true", Role::Reference), "dead_zone_rad")
}
