//! The charts of one run: which ones its signals permit.

use std::slice;

use lashloop_bench::fault::timeline::FaultRecord;
use lashloop_plant::metrics::DRIVE_PREFIX;
use lashloop_record::trace::{TELEMETRY_TIME, TIME};

use super::annotations;
use super::chosen_panels::Panels;
use super::data::{Chart, Data, Mark, PER_CHART, Part, Series, Shade, coloured};
use super::input::Run;
use crate::steps::{round_trip_us, row_of_step};

/// Most intervals of contact of a page.
const MOST_INTERVALS: usize = 3_000;
/// Half the height of the chart of the enlarged gap, in half gaps.
const ENLARGED: f64 = 1.25;
/// Largest twist, in half gaps, whose own chart still shows the gap.
const COARSE: f64 = 3.0;
/// The torque of the law, before the drive's limits.
const REQUESTED: &str = "drive.requested_torque_nm";
/// Columns that no chart shows for themselves.
const INTERNAL: [&str; 3] = [TIME, TELEMETRY_TIME, "contact"];

/// One column over another: title, their names, label and unit of their axes.
type Over = (&'static str, [&'static str; 2], [(&'static str, &'static str); 2]);

pub(super) const PHASE_PLANE: Over = (
    "Phase plane",
    ["error_rad", "load_velocity_rad_s"],
    [("position error", "rad"), ("load velocity", "rad/s")],
);
/// The backlash itself: torque passes outside the gap only.
pub(super) const HYSTERESIS: Over = (
    "Hysteresis of gap and shaft",
    ["twist_rad", "transmitted_torque_nm"],
    [("twist", "rad"), ("transmitted torque", "N m")],
);
const LOST_MOTION: Over = (
    "Hysteresis of the loop",
    ["reference_rad", "load_position_rad"],
    [("reference", "rad"), ("load position", "rad")],
);

/// The charts of a single run, behind those that the user chooses.
pub(super) fn charts(run: &Run, panels: &Panels) -> (Data, Vec<Constant>) {
    Data::fitted(slice::from_ref(run), |data| draw(run, data, panels))
}

fn draw(run: &Run, mut data: Data, panels: &Panels) -> (Data, Vec<Constant>) {
    panels.draw(&mut data, slice::from_ref(run));
    let mut page = Charts { run, data, shown: Vec::new() };
    page.position();
    page.own();
    page.error();
    page.torque();
    page.twist();
    page.estimates();
    page.phase_plane();
    page.trail(HYSTERESIS, "transmitted torque");
    page.lost_motion();
    page.timing();
    let constants = page.further();
    let marks = marks(run);
    let mut data = page.data;
    for number in 0..data.charts.len() {
        if data.charts[number].axes.is_some() {
            continue;
        }
        let names = data.names(&data.charts[number]);
        let expected = names.iter().flat_map(|name| annotations::of_signal(run, name)).collect::<Vec<_>>();
        let chart = &mut data.charts[number];
        chart.bands.extend(expected);
        chart.marks.clone_from(&marks);
    }
    (data, constants)
}

/// A signal that kept one value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Constant {
    pub(super) name: String,
    pub(super) value: f64,
    pub(super) unit: String,
}

struct Charts<'a> {
    run: &'a Run,
    data: Data,
    /// Columns that have a chart.
    shown: Vec<String>,
}

impl Charts<'_> {
    /// The signal as a series; `None` if the run lacks it.
    fn series(&mut self, label: &str, name: &str) -> Option<Series> {
        let values = self.run.column(name)?;
        let column = self.data.column(0, name, || values.to_vec());
        self.shown.push(name.to_owned());
        Some(Series::new(label, 0, column))
    }

    fn push(&mut self, chart: Chart) {
        if !chart.series.is_empty() {
            self.data.charts.push(chart);
        }
    }

    fn position(&mut self) {
        let reference = self.series("reference", "reference_rad").map(|it| it.style("reference").dashed());
        let load = self.series("load", "load_position_rad").map(|it| it.style("c0"));
        let mut chart = Chart::new("Load position", "rad", [load, reference].into_iter().flatten().collect());
        let (notes, bands) = annotations::of_step(self.run);
        chart.notes = notes;
        chart.bands.extend(bands);
        self.push(chart);
    }

    /// The drive's own signals: those that no other chart has, a chart for each unit.
    fn own(&mut self) {
        let estimates = estimates(self.run);
        let is_estimate = |name: &str| estimates.iter().any(|(it, _)| it == name);
        let signals = self.run.record.trace.signals();
        let own = signals.iter().filter(|it| is_own(&it.name) && !is_estimate(&it.name));
        let own: Vec<_> = own.map(|it| (it.name.to_string(), it.unit.to_string())).collect();
        for (unit, names) in self.changing(own).0 {
            self.of_unit(&unit, &names, "Drive's own signals", Part::Motion);
        }
    }

    fn error(&mut self) {
        let Some(error_rad) = error_rad(self.run) else { return };
        let column = self.data.column(0, "error_rad", || error_rad);
        let series = Series::new("load minus reference", 0, column).style("c0");
        self.push(Chart::new("Position error", "rad", vec![series]));
    }

    fn torque(&mut self) {
        let torque = self.series("torque", "torque_nm").map(|it| it.style("c0").held());
        let is_same = self.run.column("torque_nm") == self.run.column(REQUESTED);
        let requested = (!is_same).then(|| self.series("requested by the law", REQUESTED)).flatten();
        let requested = requested.map(|it| it.style("c1").held());
        let transmitted = self.series("transmitted", "transmitted_torque_nm").map(|it| it.style("c2"));
        let series = [requested, torque, transmitted].into_iter().flatten().collect();
        self.push(Chart::new("Torque", "N m", series));
    }

    /// Twist, with the edges of the gap, and the times in contact.
    fn twist(&mut self) {
        let Some(twist) = self.series("twist", "twist_rad") else { return };
        let mut series = vec![twist.style("c0")];
        if let Some(half_gap_rad) = self.run.column("dead_zone_rad") {
            self.shown.push("dead_zone_rad".to_owned());
            series.extend(edges_of_gap(&mut self.data, 0, half_gap_rad));
        }
        let mut chart = Chart::new("Twist and gap", "rad", series);
        chart.shades.extend(
            self.run.column("contact").map(|contact| Shade {
                name: "in contact",
                intervals: intervals(self.run.times_s(), contact),
            }),
        );
        let enlarged = enlarged(slice::from_ref(self.run), &chart);
        self.push(chart);
        self.data.charts.extend(enlarged);
    }

    /// Each estimate of the drive next to its truth: `drive.X_estimate_UNIT` and `X_UNIT`.
    fn estimates(&mut self) {
        for (estimate, truth) in estimates(self.run) {
            let unit = self.run.record.trace.unit(&estimate).unwrap_or_default().to_owned();
            let series = [
                self.series("estimate", &estimate).map(|it| it.style("c1").held()),
                self.series("truth", &truth).map(|it| it.style("c0")),
            ];
            let title = format!("Estimate: {}", spelled(&truth, &unit));
            self.push(Chart::new(title, unit, series.into_iter().flatten().collect()));
        }
    }

    fn phase_plane(&mut self) {
        if self.trail(PHASE_PLANE, "trajectory") {
            self.shown.push("load_velocity_rad_s".to_owned());
        }
    }

    /// Load over reference, if the reference moves: the width of the loop is the lost motion.
    fn lost_motion(&mut self) {
        let reference_rad = self.run.column("reference_rad").unwrap_or_default();
        if reference_rad.windows(2).any(|pair| pair[0] != pair[1]) {
            self.trail(LOST_MOTION, "load");
        }
    }

    fn trail(&mut self, over: Over, label: &str) -> bool {
        trail(&mut self.data, slice::from_ref(self.run), over, Some(label))
    }

    fn timing(&mut self) {
        let timing = &self.run.timing;
        let steps = self.run.times_s().len();
        let padded = |mut values: Vec<f64>| {
            values.resize(steps, f64::NAN);
            values
        };
        let lateness = || timing.iter().map(|row| row.lateness_us).collect::<Vec<_>>();
        let trip = timing.iter().map(round_trip_us).collect::<Vec<_>>();
        let mut series = Vec::new();
        if trip.iter().any(|value| value.is_finite()) {
            let column = self.data.column(0, "round_trip_us", || padded(trip));
            series.push(Series::new("round trip", 0, column).style("c0").held());
        }
        if timing.iter().any(|row| row.lateness_us > 0.0) {
            let column = self.data.column(0, "lateness_us", || padded(lateness()));
            series.push(Series::new("lateness", 0, column).style("c1").held());
        }
        self.push(Chart::new("Lateness and round trip", "us", series).in_part(Part::Timing));
    }

    /// All signals that no other chart has, in groups of one unit. Those that never change are returned.
    fn further(&mut self) -> Vec<Constant> {
        let signals = self.run.record.trace.signals().iter();
        let left =
            signals.filter(|it| !INTERNAL.contains(&&*it.name) && !self.shown.contains(&it.name.to_string()));
        let left = left.map(|it| (it.name.to_string(), it.unit.to_string())).collect();
        let (groups, constants) = self.changing(left);
        for (unit, names) in groups {
            self.of_unit(&unit, &names, "Signals", Part::Further);
        }
        constants
    }

    /// Signals in groups of one unit, and those that never change.
    fn changing(&self, signals: Vec<(String, String)>) -> (Vec<(String, Vec<String>)>, Vec<Constant>) {
        let mut constants = Vec::new();
        let mut groups: Vec<(String, Vec<String>)> = Vec::new();
        for (name, unit) in signals {
            let Some(values) = self.run.column(&name) else { continue };
            if values.iter().all(|value| *value == values[0]) {
                constants.push(Constant { name, value: values[0], unit });
                continue;
            }
            match groups.iter_mut().find(|(known, names)| *known == unit && names.len() < PER_CHART) {
                Some((_, names)) => names.push(name),
                None => groups.push((unit, vec![name])),
            }
        }
        (groups, constants)
    }

    /// A chart of signals of one unit.
    fn of_unit(&mut self, unit: &str, names: &[String], what: &str, part: Part) {
        let series = names.iter().filter_map(|name| self.series(name, name)).collect();
        let title = match names {
            [name] => name.clone(),
            _ if unit.is_empty() => format!("{what} without a unit"),
            _ => format!("{what} in {unit}"),
        };
        self.push(Chart::new(title, unit, series).in_part(part));
    }
}

/// Adds a chart of one column over another, in every run that has both, and under their names without a label. Whether there
/// is such a run.
pub(super) fn trail(data: &mut Data, runs: &[Run], (title, names, axes): Over, label: Option<&str>) -> bool {
    let mut series = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let values = |name: &str| match name {
            "error_rad" => error_rad(run),
            name => run.column(name).map(<[f64]>::to_vec),
        };
        let Some((x, y)) = values(names[0]).zip(values(names[1])) else { continue };
        let trail = data.trail(number, run.times_s(), (names[0], &x), (names[1], &y));
        series.push(coloured(number, Series::trail(label.unwrap_or(&run.name), number, trail)));
    }
    let is_drawn = !series.is_empty();
    if is_drawn {
        data.charts.push(Chart::new(title, "", series).axes(axes[0], axes[1]));
    }
    is_drawn
}

/// Load position less reference.
pub(super) fn error_rad(run: &Run) -> Option<Vec<f64>> {
    let (load, reference) = run.column("load_position_rad").zip(run.column("reference_rad"))?;
    Some(load.iter().zip(reference).map(|(load, reference)| load - reference).collect())
}

/// Estimates of the drive, each with the truth of the same name.
pub(super) fn estimates(run: &Run) -> Vec<(String, String)> {
    let pair = |name: &str| {
        let truth = name.strip_prefix("drive.")?.replacen("_estimate", "", 1);
        (name.contains("_estimate") && run.column(name).is_some() && run.column(&truth).is_some())
            .then(|| (name.to_owned(), truth))
    };
    run.record.trace.signals().iter().filter_map(|signal| pair(&signal.name)).collect()
}

/// Whether a signal is one of the drive's that no chart has by its meaning, estimates apart.
pub(super) fn is_own(name: &str) -> bool {
    name.starts_with(DRIVE_PREFIX) && name != REQUESTED
}

/// A signal's name as words, without its unit.
pub(super) fn spelled(name: &str, unit: &str) -> String {
    let suffix =
        format!("_{}", unit.replace([' ', '/'], if unit.contains('/') { "_" } else { "" }).to_lowercase());
    name.strip_suffix(&suffix).unwrap_or(name).replace('_', " ")
}

/// Start and end of each time in which `flags` is not zero. If there are too many, those with the shortest gaps become one.
fn intervals(times_s: &[f64], flags: &[f64]) -> Vec<f64> {
    let mut intervals: Vec<f64> = Vec::new();
    for (time_s, flag) in times_s.iter().zip(flags) {
        let is_open = intervals.len() % 2 == 1;
        if (*flag != 0.0) != is_open {
            intervals.push((time_s * 1e6).round() / 1e6);
        }
    }
    if intervals.len() % 2 == 1 {
        intervals.extend(times_s.last());
    }
    let mut shortest_gap_s = 1e-3;
    while intervals.len() > 2 * MOST_INTERVALS {
        intervals = joined(&intervals, shortest_gap_s);
        shortest_gap_s *= 2.0;
    }
    intervals
}

/// Intervals without the gaps shorter than this.
fn joined(intervals: &[f64], shortest_gap_s: f64) -> Vec<f64> {
    let mut joined: Vec<f64> = Vec::new();
    for pair in intervals.chunks_exact(2) {
        match joined.last_mut() {
            Some(end_s) if pair[0] - *end_s < shortest_gap_s => *end_s = pair[1],
            _ => joined.extend(pair),
        }
    }
    joined
}

/// The start of each injected fault.
fn marks(run: &Run) -> Vec<Mark> {
    let mark = |fault: FaultRecord| {
        let x = run.times_s()[row_of_step(&run.record, fault.step)?];
        Some(Mark { x, label: fault.kind.into_owned() })
    };
    run.faults().into_iter().filter_map(mark).collect()
}

/// The edges of the gap of a run.
pub(super) fn edges_of_gap(data: &mut Data, run: usize, half_gap_rad: &[f64]) -> [Series; 2] {
    [("upper edge of the gap", "gap_above", 1.0), ("lower edge", "gap_below", -1.0)].map(
        |(label, name, sign)| {
            let edge = || half_gap_rad.iter().map(|half_gap_rad| sign * half_gap_rad).collect();
            Series::new(label, run, data.column(run, name, edge)).style("limit").dashed()
        },
    )
}

/// The chart of the twist of these runs with the largest gap as high as the chart, if a shaft winds much farther than that.
pub(super) fn enlarged(runs: &[Run], chart: &Chart) -> Option<Chart> {
    let largest = |name: &str| {
        let values = runs.iter().filter_map(|run| run.column(name)).flatten();
        values.fold(0.0_f64, |largest, value| largest.max(value.abs()))
    };
    let half_gap_rad = largest("dead_zone_rad");
    let is_coarse = half_gap_rad > 0.0 && largest("twist_rad") > COARSE * half_gap_rad;
    let range = Some([-ENLARGED * half_gap_rad, ENLARGED * half_gap_rad]);
    is_coarse.then(|| Chart { title: "Gap, enlarged".to_owned(), range, ..chart.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_in_contact_are_intervals() {
        let times_s = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(intervals(&times_s, &[0.0, -1.0, -1.0, 0.0, 0.0, 1.0]), [1.0, 3.0, 5.0, 5.0]);
        assert_eq!(intervals(&times_s, &[0.0; 6]), [0.0; 0]);
        let dense: Vec<_> = (0..100_000).map(f64::from).collect();
        let chatter: Vec<_> = (0..100_000).map(|step| f64::from(step % 2)).collect();
        assert!(intervals(&dense, &chatter).len() <= 2 * MOST_INTERVALS);
    }

    #[test]
    fn names_are_spelled_without_their_unit() {
        assert_eq!(spelled("dead_zone_rad", "rad"), "dead zone");
        assert_eq!(spelled("disturbing_torque_nm", "N m"), "disturbing torque");
        assert_eq!(spelled("load_velocity_rad_s", "rad/s"), "load velocity");
    }
}
