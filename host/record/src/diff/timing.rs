//! Link and timing of two runs side by side. They differ from run to run, so no comparison judges them.

use serde::Serialize;

use crate::summary::Summary;

/// A figure of link or timing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TimingDifference {
    /// What it counts or measures, with its unit.
    pub name: &'static str,
    /// The values; `None` where the summary has none.
    pub values: [Option<f64>; 2],
}

/// A figure by its name.
type Figure = (&'static str, fn(&Summary) -> Option<f64>);

const FIGURES: [Figure; 11] = [
    ("wall-clock time, s", |it| Some(it.wall_s)),
    ("lateness p50, us", |it| it.timing.lateness_us.map(|us| us.p50)),
    ("lateness p99, us", |it| it.timing.lateness_us.map(|us| us.p99)),
    ("lateness max, us", |it| it.timing.lateness_us.map(|us| us.max)),
    ("round trip p50, us", |it| it.timing.round_trip_us.map(|us| us.p50)),
    ("round trip p99, us", |it| it.timing.round_trip_us.map(|us| us.p99)),
    ("round trip max, us", |it| it.timing.round_trip_us.map(|us| us.max)),
    ("missed steps", |it| Some(it.timing.missed as f64)),
    ("steps without an answer", |it| Some(it.timing.unanswered as f64)),
    ("damaged frames", |it| Some(it.link.crc_errors as f64)),
    ("resumes", |it| Some(it.link.resumes as f64)),
];

/// The figures that at least one summary has and that differ.
pub(super) fn compare(summaries: [Option<&Summary>; 2]) -> Vec<TimingDifference> {
    FIGURES
        .into_iter()
        .map(|(name, figure)| TimingDifference { name, values: summaries.map(|it| it.and_then(figure)) })
        .filter(|it| it.values[0] != it.values[1])
        .collect()
}
