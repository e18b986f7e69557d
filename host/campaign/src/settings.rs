//! A campaign as data: variants, parts, derived columns, expectations.

use lashloop_bench::scenario::declare::{
    Field, Named as _, any_text, by, choice, flat, integer, number, plain, section, sections, text, texts,
};
use lashloop_bench::settings;
use lashloop_plant::metrics::Metric;

use crate::axis::{Axis, MAX_CASES};

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

settings! {
    /// A campaign as its file has it.
    #[derive(Debug, Clone, PartialEq)]
    pub struct CampaignFile {
        /// One line for reports.
        pub title: String = text("a text in quotes"),
        /// Scenario of every variant that has none of its own; relative to the file.
        pub scenario: Option<String> = any_text(),
        /// Seed of every random stream.
        pub seed: u64 = integer(0..=i64::MAX.cast_unsigned()).or(1),
        /// Values instead of the scenario's, each as after `--set`.
        pub set: Vec<String> = settings(),
        /// A law or another choice: every row of a part is run once with each variant.
        pub variants as "variant": Vec<VariantSettings> = sections(plain),
        /// A set of points.
        pub parts as "part": Vec<Part> = sections(Part::checked),
        /// A further column, computed from a metric.
        pub derived as "derive": Vec<Derived> = sections(plain),
        /// A limit on a statistic over runs.
        pub expectations as "expect": Vec<Expectation> = sections(Expectation::checked),
        /// Runs that are run again with a record.
        pub evidence: EvidenceSettings = section(plain),
    }
}

fn settings() -> impl Field<Value = Vec<String>> {
    texts("a list of texts in quotes").or(Vec::new())
}

fn name() -> impl Field<Value = String> {
    text("a name in quotes").map(|name, section| {
        if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)) {
            section.reject("name", "isn't a name; it must consist of letters, digits, '-', '_' and '.'");
        }
        name
    })
}

settings! {
    /// `[[variant]]`: every row of a part is run once with each.
    #[derive(Debug, Clone, PartialEq, Eq)]
    pub struct VariantSettings {
        /// Name in tables.
        pub name: String = name(),
        /// Scenario instead of the campaign's; relative to the file.
        pub scenario: Option<String> = any_text(),
        /// Values instead of the scenario's, each as after `--set`.
        pub set: Vec<String> = settings(),
        /// Keys of axes that don't exist here, such as parameters of other laws; the scenario keeps its own value.
        pub omit: Vec<String> = texts("a list of texts in quotes").or(Vec::new()),
    }
}

settings! {
    /// `[[part]]`: a set of points.
    #[derive(Debug, Clone, PartialEq)]
    pub struct Part {
        /// Name in tables.
        pub name: String = name(),
        /// How the values of the axes are combined.
        pub method: Method = choice().or(Method::Grid),
        /// Values instead of the scenario's in every case of the part, each as after `--set`.
        pub set: Vec<String> = settings(),
        /// Points of a sampled part.
        pub points: Option<u64> = integer(1..=MAX_CASES).optional(),
        /// An earlier part whose axes this part has before its own.
        pub axes_of: Option<String> = any_text(),
        /// Keys that vary together.
        pub axes as "axis": Vec<Axis> = by(|part| {
            let is_sampled = part.text("method").and_then(Method::named).is_some_and(Method::is_sampled);
            sections(move |keys, axis| Axis::checked(keys, axis, is_sampled))
        }),
    }
}

settings! {
    /// How the values of the axes are combined.
    pub enum Method {
        /// every combination; the last axis varies fastest
        "grid" => Grid,
        /// the first values of all axes, then the second ones
        "list" => List,
        /// `points` independent points; row i has the i-th number of each key's stream
        "random" => Random,
        /// `points` points; each of as many strata of an axis has one
        "latin-hypercube" => LatinHypercube,
        /// `points` points of a Sobol sequence; best with a power of two
        "sobol" => Sobol,
    }
}

impl Method {
    /// Whether the part has a number of points, and each axis a range or a list to draw from.
    #[must_use]
    pub const fn is_sampled(self) -> bool {
        matches!(self, Self::Random | Self::LatinHypercube | Self::Sobol)
    }
}

settings! {
    /// `[[derive]]`: a column computed from a metric.
    #[derive(Debug, Clone, PartialEq)]
    pub struct Derived {
        /// Name of the column.
        pub name: String = name(),
        /// Metric that the column is computed from.
        pub metric: Metric = choice().optional().map(|metric, section| {
            if metric.is_none() {
                section.reject_section("is computed from nothing; add metric");
            }
            // The stand-in of a missing metric; the file is rejected.
            metric.unwrap_or(Metric::ALL[0])
        }),
        /// The metric is divided by this number, or by one count of the encoder of `or_count_of` if that is larger.
        pub per: Option<f64> = number(1e-12..=1e12).optional(),
        /// Key with the counts per revolution of an encoder.
        pub or_count_of: Option<String> = any_text(),
        /// The metric is divided by this quantity of the run.
        pub over: Option<Divisor> = choice().optional(),
        /// Only runs count in which this metric is at most a limit.
        pub only_if: Option<(Metric, f64)> = flat(Condition::checked),
    }
}

settings! {
    /// A quantity of a run that a metric is divided by.
    pub enum Divisor {
        /// the shortest settling time that the motor of the run's own plant can reach; only for the plant `backlash-shaft` at rest
        /// and a constant reference, without load torque, wear or `[plant.electrical]`
        "minimum-settle-time" => MinimumSettleTime,
    }
}

settings! {
    /// The keys of a condition.
    pub(crate) struct Condition {
        /// Only runs count in which this metric is at most `at_most`.
        pub(crate) only_if: Option<Metric> = choice().optional(),
        /// Limit of `only_if`.
        pub(crate) at_most: Option<f64> = number(-1e12..=1e12).optional(),
    }
}

settings! {
    /// `[[expect]]`: a limit on a statistic over runs.
    #[derive(Debug, Clone, PartialEq)]
    pub struct Expectation {
        /// Part whose runs count; all parts if absent.
        pub part: Option<String> = any_text(),
        /// Variant whose runs count; all variants if absent.
        pub variant: Option<String> = any_text(),
        /// What is limited.
        pub what: Statistic = flat(StatisticKeys::checked),
        /// Level of a two-sided confidence interval, of one variant on one sampled part: order statistics for a quantile,
        /// Clopper-Pearson for a fraction.
        pub confidence: Option<f64> = number(0.5..=0.999_999).optional(),
        /// What must meet the limit.
        pub judge: Judge = choice().or(Judge::Value),
    }
}

settings! {
    /// The keys of what is limited.
    pub(crate) struct StatisticKeys {
        /// Metric or derived column.
        pub(crate) metric: Option<String> = any_text(),
        /// Quantile of the magnitude, by nearest rank; a missing value ranks behind every number.
        pub(crate) quantile: Option<f64> = number(1e-6..=1.0).optional(),
        /// Largest allowed value.
        pub(crate) max: Option<f64> = number(-1e12..=1e12).optional(),
        /// Value that must not be reached.
        pub(crate) below: Option<f64> = number(-1e12..=1e12).optional(),
        /// Smallest allowed fraction of runs whose verdict is PASS, instead of a metric.
        pub(crate) pass: Option<f64> = number(0.0..=1.0).optional(),
    }
}

settings! {
    /// What must meet a limit.
    pub enum Judge {
        /// the value over the runs of the campaign
        "value" => Value,
        /// the whole confidence interval: the limit is shown, not only met; needs `confidence`, and a quantile or fraction below 1
        "interval" => Interval,
    }
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

settings! {
    /// `[evidence]`: runs whose records are kept.
    #[derive(Debug, Clone, Default, PartialEq, Eq)]
    pub struct EvidenceSettings {
        /// Number of runs with the largest magnitude of `of`; a missing value exceeds every number.
        pub worst: u64 = integer(0..=1000).or(0),
        /// Metric or derived column.
        pub of: Option<String> = any_text(),
        /// Number of runs whose verdict is not PASS, in the order of cases; the report has the number of further ones.
        pub failures: u64 = integer(0..=10_000).or(FAILURES),
    }
}

impl CampaignFile {
    /// Columns of results that are numbers: every metric, then the derived ones.
    #[must_use]
    pub fn number_columns(&self) -> Vec<String> {
        let metrics = Metric::ALL.iter().map(|metric| metric.name().to_owned());
        metrics.chain(self.derived.iter().map(|derived| derived.name.clone())).collect()
    }
}
