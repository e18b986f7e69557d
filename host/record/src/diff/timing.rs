//! Link and timing of two runs side by side. They differ from run to run, so no comparison judges them.

use serde::Serialize;
use serde_json::Value;

/// A figure of link or timing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TimingDifference {
    /// What it counts or measures, with its unit.
    pub name: &'static str,
    /// The values; `None` where the summary has none.
    pub values: [Option<f64>; 2],
}

/// Name, and the path in a summary.
const FIGURES: [(&str, &[&str]); 11] = [
    ("wall-clock time, s", &["wall_s"]),
    ("lateness p50, us", &["timing", "lateness_us", "p50"]),
    ("lateness p99, us", &["timing", "lateness_us", "p99"]),
    ("lateness max, us", &["timing", "lateness_us", "max"]),
    ("round trip p50, us", &["timing", "round_trip_us", "p50"]),
    ("round trip p99, us", &["timing", "round_trip_us", "p99"]),
    ("round trip max, us", &["timing", "round_trip_us", "max"]),
    ("missed steps", &["timing", "missed"]),
    ("steps without an answer", &["timing", "unanswered"]),
    ("damaged frames", &["link", "crc_errors"]),
    ("resumes", &["link", "resumes"]),
];

/// The figures that at least one summary has and that differ.
pub(super) fn compare(summaries: [Option<&Value>; 2]) -> Vec<TimingDifference> {
    let figure = |summary: Option<&Value>, path: &[&str]| {
        path.iter().try_fold(summary?, |value, key| value.get(key))?.as_f64()
    };
    FIGURES
        .into_iter()
        .map(|(name, path)| TimingDifference { name, values: summaries.map(|it| figure(it, path)) })
        .filter(|it| it.values[0] != it.values[1])
        .collect()
}
