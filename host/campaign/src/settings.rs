//! A campaign as data: variants, parts, derived columns, expectations.

use lashloop_plant::metrics::Metric;

use crate::axis::Axis;

/// Cases of a campaign, points of a part, and values of an axis, at most.
pub const MAX_CASES: u64 = 10_000_000;

/// Records of failures by default: some GB at most.
pub const FAILURES: u64 = 100;

/// Columns of the results before the axes.
pub const FIRST: [&str; 4] = ["case", "part", "row", "variant"];
/// Columns after the numbers.
pub const LAST: [&str; 3] = ["verdict", "end", TORQUE_DIGEST];
pub const TORQUE_DIGEST: &str = "torque_sha256";
/// Column of `results.parquet` with the reasons of the missing numbers of a row, `column=reason` with `;` between; without
/// metrics that don't apply to the run.
pub const MISSING: &str = "missing";

/// A campaign as its file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignFile {
    pub title: String,
    /// Scenario of the variants that have none of their own; relative to the file.
    pub scenario: Option<String>,
    pub seed: u64,
    /// Settings of every case.
    pub set: Vec<String>,
    pub variants: Vec<VariantSettings>,
    pub parts: Vec<Part>,
    pub derived: Vec<Derived>,
    pub expectations: Vec<Expectation>,
    pub evidence: EvidenceSettings,
}

/// `[[variant]]`: every row of a part is run once with each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VariantSettings {
    pub name: String,
    pub scenario: Option<String>,
    pub set: Vec<String>,
}

/// `[[part]]`: a set of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    pub name: String,
    pub method: Method,
    /// Points of a sampled part.
    pub points: Option<u64>,
    pub axes: Vec<Axis>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Grid,
    List,
    Random,
    LatinHypercube,
    Sobol,
}

impl Method {
    /// Whether the part has a number of points, and each axis a range or a list to draw from.
    #[must_use]
    pub const fn is_sampled(self) -> bool {
        matches!(self, Self::Random | Self::LatinHypercube | Self::Sobol)
    }
}

/// `[[derive]]`: a column computed from a metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    pub name: String,
    pub metric: Metric,
    /// The metric is divided by the larger of this number and one count of an encoder, in rad.
    pub per: Option<f64>,
    /// Key with the counts per revolution of that encoder.
    pub or_count_of: Option<String>,
    /// Only runs count in which this metric is at most a limit.
    pub only_if: Option<(Metric, f64)>,
}

/// `[[expect]]`: a limit on a statistic over runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    pub part: Option<String>,
    pub variant: Option<String>,
    pub what: Statistic,
    /// Two-sided, below 1.
    pub confidence: Option<f64>,
    /// The whole interval must meet the limit.
    pub shown: bool,
}

impl Expectation {
    /// Whether the runs of a part and variant count.
    #[must_use]
    pub fn is_of(&self, part: &str, variant: &str) -> bool {
        self.part.iter().all(|name| name == part) && self.variant.iter().all(|name| name == variant)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Statistic {
    /// Quantile of the magnitude of a column.
    Quantile { column: String, quantile: f64, limit: Limit },
    /// Fraction of the runs whose verdict is PASS, at least.
    Pass { least: f64 },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// The value may equal it.
    Max(f64),
    /// The value must be smaller.
    Below(f64),
}

/// `[evidence]`: runs whose records are kept.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EvidenceSettings {
    /// Runs with the largest magnitude of a column.
    pub worst: u64,
    pub of: Option<String>,
    /// Runs whose verdict is not PASS, the first ones.
    pub failures: u64,
}

impl CampaignFile {
    /// Columns of results that are numbers: every metric, then the derived ones.
    #[must_use]
    pub fn number_columns(&self) -> Vec<String> {
        let metrics = Metric::ALL.iter().map(|metric| metric.name().to_owned());
        metrics.chain(self.derived.iter().map(|derived| derived.name.clone())).collect()
    }
}
