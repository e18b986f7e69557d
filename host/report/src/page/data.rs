//! What a page gives to its script: encoded columns of each run, and charts that refer to them.

use serde::Serialize;

use super::codec::{Encoded, STEPS};
use super::input::Run;
use super::typeset;

/// Most rows of all runs of a page. A run of 25 s at 1 kHz has 25,000.
const MOST_ROWS: usize = 90_000;
/// Digits of all columns of a page up to which it stays below 3 MB, with tables, style and scripts. The coarsest rounding may
/// give more, for a record of many signals that are all noise: no signal is left out.
const MOST_DIGITS: usize = 2_600_000;

/// Groups of steps of a curve that are one group of a trail, which keeps up to four rows of each: a trail is 10^3 pixels long.
pub(super) const TRAIL_GROUP: usize = 4;

/// Signals of one unit that a chart shows at once: it has a colour for each.
pub(super) const PER_CHART: usize = 8;

/// Index of a column of a run.
pub(super) type ColumnId = usize;

/// The data of all charts of a page.
#[derive(Debug, Serialize)]
pub(super) struct Data {
    runs: Vec<RunData>,
    pub(super) charts: Vec<Chart>,
    /// Steps to which the values of a column are rounded.
    #[serde(skip)]
    pub(super) steps: f64,
}

#[derive(Debug, Serialize)]
struct RunData {
    time: Encoded,
    columns: Vec<Encoded>,
    #[serde(skip)]
    names: Vec<String>,
    /// Steps that become two rows, their smallest and their largest value; below 3 each step is a row.
    #[serde(skip)]
    steps_per_pair: usize,
}

/// A chart of one page.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Chart {
    pub(super) title: String,
    pub(super) unit: String,
    /// Part of the page.
    #[serde(skip)]
    pub(super) part: Part,
    pub(super) series: Vec<Series>,
    pub(super) shades: Vec<Shade>,
    pub(super) marks: Vec<Mark>,
    pub(super) bands: Vec<Band>,
    pub(super) notes: Vec<Mark>,
    /// Range of the vertical axis; `None` for that of the curves.
    pub(super) range: Option<[f64; 2]>,
    /// Names of both axes; `None` for a chart over time.
    pub(super) axes: Option<Axes>,
}

/// Where a chart stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Motion,
    Timing,
    Further,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) run: usize,
    #[serde(flatten)]
    pub(super) points: Points,
    /// `None` for the next colour.
    pub(super) style: Option<String>,
    #[serde(rename = "isHeld")]
    pub(super) is_held: bool,
    #[serde(rename = "isDashed")]
    pub(super) is_dashed: bool,
}

/// The columns of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub(super) enum Points {
    /// Over the times of the run.
    OverTime { y: ColumnId },
    /// One column over another.
    Trail(Trail),
}

/// The columns of one quantity over another. All have the same rows, so that each point is one of the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) struct Trail {
    /// Times; `None` for those of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    t: Option<ColumnId>,
    x: ColumnId,
    y: ColumnId,
}

/// Times at which something held, as pairs of start and end in s.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Shade {
    pub(super) name: &'static str,
    pub(super) intervals: Vec<f64>,
}

/// Limits of the values over a part of the time in s.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Band {
    pub(super) name: String,
    /// Whether the scenario expects them, or they only explain.
    #[serde(rename = "isExpected")]
    pub(super) is_expected: bool,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) low: Option<f64>,
    pub(super) high: Option<f64>,
}

/// An event, at a time in s.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Mark {
    pub(super) x: f64,
    pub(super) label: String,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct Axes {
    pub(super) x: Axis,
    pub(super) y: Axis,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct Axis {
    pub(super) label: String,
    pub(super) unit: String,
}

impl Series {
    pub(super) fn new(name: impl Into<String>, run: usize, y: ColumnId) -> Self {
        Self::of(name, run, Points::OverTime { y })
    }

    pub(super) fn trail(name: impl Into<String>, run: usize, trail: Trail) -> Self {
        Self::of(name, run, Points::Trail(trail))
    }

    fn of(name: impl Into<String>, run: usize, points: Points) -> Self {
        Self { name: name.into(), run, points, style: None, is_held: false, is_dashed: false }
    }

    pub(super) fn style(mut self, style: impl Into<String>) -> Self {
        self.style = Some(style.into());
        self
    }

    /// Steps from value to value.
    pub(super) fn held(mut self) -> Self {
        self.is_held = true;
        self
    }

    pub(super) fn dashed(mut self) -> Self {
        self.is_dashed = true;
        self
    }
}

/// The colours of a chart, then the same dashed.
pub(super) fn coloured(number: usize, series: Series) -> Series {
    let series = series.style(format!("c{}", number % PER_CHART));
    if number / PER_CHART % 2 == 1 { series.dashed() } else { series }
}

impl Chart {
    pub(super) fn new(title: impl Into<String>, unit: impl Into<String>, series: Vec<Series>) -> Self {
        Self {
            title: title.into(),
            unit: typeset::unit(&unit.into()),
            part: Part::Motion,
            series,
            shades: Vec::new(),
            marks: Vec::new(),
            bands: Vec::new(),
            notes: Vec::new(),
            range: None,
            axes: None,
        }
    }

    pub(super) fn in_part(mut self, part: Part) -> Self {
        self.part = part;
        self
    }

    pub(super) fn axes(mut self, x: (&str, &str), y: (&str, &str)) -> Self {
        let axis = |(label, unit): (&str, &str)| Axis { label: label.to_owned(), unit: unit.to_owned() };
        self.axes = Some(Axes { x: axis(x), y: axis(y) });
        self
    }
}

impl Data {
    /// The data that `make` gives at the finest rounding that fits into a page, or else at the coarsest.
    pub(super) fn fitted<T>(runs: &[Run], make: impl Fn(Self) -> (Self, T)) -> (Self, T) {
        let mut made = make(Self::new(runs, STEPS[0]));
        for steps in STEPS.into_iter().skip(1) {
            if made.0.digits() <= MOST_DIGITS {
                break;
            }
            made = make(Self::new(runs, steps));
        }
        made
    }

    /// Without a chart.
    fn new(runs: &[Run], steps: f64) -> Self {
        let most = MOST_ROWS / runs.len().max(1);
        let of_run = |run: &Run| {
            let times_s = run.times_s();
            let steps_per_pair = (times_s.len() * 2).div_ceil(most.max(1));
            let time = Encoded::of_times(&firsts(times_s, steps_per_pair));
            RunData { time, columns: Vec::new(), names: Vec::new(), steps_per_pair }
        };
        Self { runs: runs.iter().map(of_run).collect(), charts: Vec::new(), steps }
    }

    /// The column of a run with this name, encoded on its first use. `values` has a value for each step, or fewer.
    pub(super) fn column(&mut self, run: usize, name: &str, values: impl FnOnce() -> Vec<f64>) -> ColumnId {
        let (data, steps) = (&mut self.runs[run], self.steps);
        let steps_per_pair = data.steps_per_pair;
        data.once(name, || Encoded::of(&extremes(&values(), steps_per_pair), steps))
    }

    /// The columns of `y` over `x`, given by name and values. A thinned run keeps whole rows: the extremes of two columns
    /// at different times aren't a point of the run.
    pub(super) fn trail(
        &mut self,
        run: usize,
        times_s: &[f64],
        x: (&str, &[f64]),
        y: (&str, &[f64]),
    ) -> Trail {
        let (data, steps) = (&mut self.runs[run], self.steps);
        if data.steps_per_pair <= 2 {
            let [x, y] = [x, y].map(|(name, values)| data.once(name, || Encoded::of(values, steps)));
            return Trail { t: None, x, y };
        }
        let rows = rows_of_trail(x.1, y.1, TRAIL_GROUP * data.steps_per_pair);
        let of = |values: &[f64]| rows.iter().map(|row| values[*row]).collect::<Vec<_>>();
        let name = format!("{} over {}", y.0, x.0);
        let [x, y] = [x, y].map(|(part, values)| {
            data.once(&format!("{part} of {name}"), || Encoded::of(&of(values), steps))
        });
        Trail { t: Some(data.once(&format!("time of {name}"), || Encoded::of_times(&of(times_s)))), x, y }
    }

    /// The names of the columns that a chart over time shows.
    pub(super) fn names(&self, chart: &Chart) -> Vec<String> {
        let name = |series: &Series| match series.points {
            Points::OverTime { y } => self.runs.get(series.run)?.names.get(y).cloned(),
            Points::Trail(_) => None,
        };
        chart.series.iter().filter_map(name).collect()
    }

    fn digits(&self) -> usize {
        self.runs.iter().flat_map(|run| run.columns.iter().chain([&run.time])).map(Encoded::len).sum()
    }

    /// Steps behind each pair of rows, if the page has fewer rows than the record.
    pub(super) fn thinned(&self) -> Option<usize> {
        self.runs.iter().map(|run| run.steps_per_pair).max().filter(|&steps| steps > 2)
    }
}

impl RunData {
    /// The column of this name, encoded on its first use.
    fn once(&mut self, name: &str, encode: impl FnOnce() -> Encoded) -> ColumnId {
        if let Some(at) = self.names.iter().position(|known| known == name) {
            return at;
        }
        self.columns.push(encode());
        self.names.push(name.to_owned());
        self.names.len() - 1
    }
}

/// Rows of a trail: of each group of steps those with the smallest and the largest value of either axis, in their order. A group
/// without a point gives one row without a value, which breaks the curve.
fn rows_of_trail(x: &[f64], y: &[f64], steps: usize) -> Vec<usize> {
    let count = x.len().min(y.len());
    let mut rows = Vec::new();
    for start in (0..count).step_by(steps) {
        let points =
            || (start..count.min(start + steps)).filter(|&row| x[row].is_finite() && y[row].is_finite());
        let mut kept: Vec<_> = [x, y]
            .into_iter()
            .flat_map(|of| {
                let by_value = |a: &usize, b: &usize| of[*a].total_cmp(&of[*b]);
                [points().min_by(by_value), points().max_by(by_value)]
            })
            .flatten()
            .collect();
        kept.sort_unstable();
        kept.dedup();
        rows.extend(if kept.is_empty() { vec![start] } else { kept });
    }
    rows
}

/// Two times of each group of steps.
fn firsts(times_s: &[f64], steps: usize) -> Vec<f64> {
    if steps <= 2 {
        return times_s.to_vec();
    }
    times_s.chunks(steps).flat_map(|group| [group[0], group[group.len() / 2]]).collect()
}

/// Smallest and largest value of each group of steps, in their order.
fn extremes(values: &[f64], steps: usize) -> Vec<f64> {
    if steps <= 2 {
        return values.to_vec();
    }
    let pair = |group: &[f64]| {
        let finite = || group.iter().copied().enumerate().filter(|(_, value)| value.is_finite());
        let low = finite().min_by(|a, b| a.1.total_cmp(&b.1));
        let high = finite().max_by(|a, b| a.1.total_cmp(&b.1));
        match (low, high) {
            (Some(low), Some(high)) if low.0 <= high.0 => [low.1, high.1],
            (Some(low), Some(high)) => [high.1, low.1],
            _ => [f64::NAN; 2],
        }
    };
    values.chunks(steps).flat_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_trail_keeps_the_extremes_of_both_axes_as_points_of_the_run() {
        let x = [0.0, 9.0, 1.0, 2.0, f64::NAN, 0.0, 0.0, 0.0];
        let y = [5.0, 5.0, 7.0, 4.0, 99.0, f64::NAN, 0.0, 1.0];
        assert_eq!(rows_of_trail(&x, &y, 4), [0, 1, 2, 3, 6, 7]);
        assert_eq!(
            rows_of_trail(&x, &y, 2),
            [0, 1, 2, 3, 4, 6, 7],
            "a group without a point breaks the curve"
        );
    }

    #[test]
    fn a_thinned_column_keeps_every_extreme_in_its_order() {
        let values = [0.0, 5.0, 1.0, f64::NAN, 2.0, -3.0, 4.0];
        assert_eq!(extremes(&values, 3), [0.0, 5.0, 2.0, -3.0, 4.0, 4.0]);
        assert_eq!(firsts(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 3), [0.0, 1.0, 3.0, 4.0, 6.0, 6.0]);
        assert!(extremes(&[f64::NAN; 3], 3).iter().all(|value| value.is_nan()));
    }
}
