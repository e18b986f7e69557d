//! The campaign file: its keys, and what contradicts itself.

use std::collections::BTreeSet;

use lashloop_bench::scenario::key::{Choice, Keys};
use lashloop_bench::scenario::{ScenarioErrors, Section, settings_file};
use lashloop_plant::metrics::Metric;

use crate::axis::{Axis, AxisValue, Range, Scale, Values};
pub use crate::settings::{
    CampaignFile, Derived, EvidenceSettings, Expectation, Limit, Method, Part, Statistic, VariantSettings,
};
use crate::settings::{FAILURES, FIRST, LAST, MAX_CASES, MISSING};
use crate::sobol::DIMENSIONS;
use crate::soundness;

impl CampaignFile {
    /// Reads a text. `name` is the file's name in errors.
    ///
    /// # Errors
    /// The text isn't TOML, or has keys that are unknown, missing or out of range; all errors at once.
    pub fn from_str(name: &str, text: &str) -> Result<Self, ScenarioErrors> {
        settings_file::from_str(name, text, read)
    }

    /// Every key of a campaign file.
    #[must_use]
    pub fn keys() -> Keys {
        settings_file::keys(|root| {
            read(root);
        })
    }
}

fn read(root: &mut Section<'_>) -> CampaignFile {
    let title = root.doc("One line for reports.").text("title", Some("a text in quotes"));
    let scenario = root
        .doc("Scenario of every variant that has none of its own; relative to the file.")
        .text("scenario", None)
        .map(str::to_owned);
    let seed = root.doc("Seed of every random stream.").integer("seed", 1_u64, 0..=i64::MAX.cast_unsigned());
    let set = read_settings(root);
    let variants = root
        .doc("A law or another choice: every row of a part is run once with each variant.")
        .sections("variant", |section| VariantSettings {
            name: read_name(section, "Name in tables."),
            scenario: section
                .doc("Scenario in place of the campaign's; relative to the file.")
                .text("scenario", None)
                .map(str::to_owned),
            set: read_settings(section),
        });
    let parts = root.doc("A set of points.").sections("part", read_part);
    let derived = root.doc("A further column, computed from a metric.").sections("derive", read_derived);
    let expectations = root.doc("A limit on a statistic over runs.").sections("expect", read_expectation);
    let evidence = root.doc("Runs that are run again with a record.").section("evidence", |section| {
        EvidenceSettings {
            worst: section
                .doc("Number of runs with the largest magnitude of `of`; a missing value exceeds every number.")
                .integer("worst", 0_u64, 0..=1000),
            of: section.doc("Metric or derived column.").text("of", None).map(str::to_owned),
            failures: section
                .doc("Number of runs whose verdict is not PASS, in the order of cases; the report has the number of further ones.")
                .integer("failures", FAILURES, 0..=10_000),
        }
    });
    let file = CampaignFile {
        title: title.unwrap_or_default().to_owned(),
        scenario,
        seed,
        set,
        variants,
        parts,
        derived,
        expectations,
        evidence,
    };
    check(root, &file);
    file
}

/// What is wrong with the sections together.
fn check(root: &Section<'_>, file: &CampaignFile) {
    if file.parts.is_empty() {
        root.reject_section("has no part; add [[part]] with name, method and axes");
    }
    if file.scenario.is_none()
        && (file.variants.is_empty() || file.variants.iter().any(|variant| variant.scenario.is_none()))
    {
        root.reject_section("has no scenario; add scenario = \"FILE.toml\", or one to each [[variant]]");
    }
    let repeated = |what: &str, names: Vec<&str>| {
        let twice = names.iter().enumerate().find(|(at, name)| names[..*at].contains(name));
        if let Some((_, name)) = twice {
            root.reject_section(&format!("has two {what} of the name {name}; each needs its own"));
        }
    };
    repeated("parts", file.parts.iter().map(|part| part.name.as_str()).collect());
    repeated("variants", file.variants.iter().map(|variant| variant.name.as_str()).collect());
    let columns = file.number_columns();
    let axes: BTreeSet<_> = file.parts.iter().flat_map(|part| &part.axes).map(Axis::name).collect();
    let others = FIRST.into_iter().chain(LAST).chain([MISSING]).chain(axes);
    repeated("columns", others.chain(columns.iter().map(String::as_str)).collect());
    for expectation in &file.expectations {
        if let Statistic::Quantile { column, .. } = &expectation.what
            && !columns.contains(column)
        {
            root.reject_section(&format!("expects of {column}, which is no metric and no [[derive]]"));
        }
        if let (Some(_), Some(problem)) = (expectation.confidence, soundness::population(file, expectation)) {
            root.reject_section(&format!("has an expectation with confidence, {problem}"));
        }
        let parts = file.parts.iter().map(|part| &part.name);
        let variants = file.variants.iter().map(|variant| &variant.name);
        for (what, named, known) in [
            ("part", &expectation.part, parts.collect::<Vec<_>>()),
            ("variant", &expectation.variant, variants.collect()),
        ] {
            if let Some(name) = named.as_ref().filter(|name| !known.contains(name)) {
                root.reject_section(&format!(
                    "has an expectation on {what} {name}, and no [[{what}]] of this name"
                ));
            }
        }
    }
    match &file.evidence.of {
        None if file.evidence.worst > 0 => root.reject_section("has evidence.worst without evidence.of"),
        Some(of) if !columns.contains(of) => {
            root.reject_section(&format!("has evidence of {of}, which is no metric and no [[derive]]"));
        }
        _ => {}
    }
}

fn read_name(section: &mut Section<'_>, doc: &str) -> String {
    let name = section.doc(doc).text("name", Some("a name in quotes")).unwrap_or_default();
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)) {
        section.reject("name", "is no name; it must consist of letters, digits, '-', '_' and '.'".to_owned());
    }
    name.to_owned()
}

fn read_settings(section: &mut Section<'_>) -> Vec<String> {
    let settings = section
        .doc("Values in place of the scenario's, each as after `--set`.")
        .texts("set", None)
        .unwrap_or_default();
    settings.into_iter().map(str::to_owned).collect()
}

fn read_part(part: &mut Section<'_>) -> Part {
    let name = read_name(part, "Name in tables.");
    let choice = |name, doc| Choice { name, doc };
    let method = part
        .doc("How the values of the axes are combined.")
        .choice_docs(vec![
            choice("grid", "every combination; the last axis varies fastest"),
            choice("list", "the first values of all axes, then the second ones"),
            choice("random", "`points` independent points; row i has the i-th number of each key's stream"),
            choice("latin-hypercube", "`points` points; each of as many strata of an axis has one"),
            choice("sobol", "`points` points of a Sobol sequence; best with a power of two"),
        ])
        .choice(
            "method",
            Method::Grid,
            &[
                ("grid", Method::Grid),
                ("list", Method::List),
                ("random", Method::Random),
                ("latin-hypercube", Method::LatinHypercube),
                ("sobol", Method::Sobol),
            ],
        )
        .unwrap_or(Method::Grid);
    let points = part.doc("Points of a sampled part.").optional_integer("points", 1..=MAX_CASES);
    let axes = part.doc("Keys that vary together.").sections("axis", |axis| read_axis(axis, method));
    match points {
        None if method.is_sampled() => part.reject_section("samples without points; add points"),
        Some(_) if !method.is_sampled() => {
            part.reject("points", "belongs to a sampled part; grid and list have points per axis".to_owned());
        }
        _ => {}
    }
    if method == Method::Sobol && axes.len() > DIMENSIONS {
        part.reject_section(&format!("has more than {DIMENSIONS} axes; take method = \"latin-hypercube\""));
    }
    if method == Method::List && axes.windows(2).any(|pair| pair[0].values.len() != pair[1].values.len()) {
        part.reject_section("is a list whose axes differ in their number of values; make them equal");
    }
    if let Some(problem) = soundness::points(method, &axes) {
        part.reject_section(&problem);
    }
    let keys: Vec<_> = axes.iter().flat_map(|axis| &axis.keys).collect();
    if let Some((_, key)) = keys.iter().enumerate().find(|(at, key)| keys[..*at].contains(key)) {
        part.reject_section(&format!("has {key} in two axes; each key has one"));
    }
    Part { name, method, points, axes }
}

fn read_axis(axis: &mut Section<'_>, method: Method) -> Axis {
    let key = axis.doc("Path of the key, such as `plant.dead_zone_rad`.").text("key", None);
    let keys = axis.doc("Paths of several keys that take one value.").texts("keys", None);
    let keys: Vec<_> = match (key, keys) {
        (Some(key), None) => vec![key.to_owned()],
        (None, Some(keys)) if !keys.is_empty() => keys.into_iter().map(str::to_owned).collect(),
        _ => {
            axis.reject_section("must give either key, or keys");
            Vec::new()
        }
    };
    let label = axis.doc("Name of the quantity in tables.").text("label", None).map(str::to_owned);
    let unit = axis.doc("Unit in tables.").text("unit", None).unwrap_or_default().to_owned();
    let listed = axis
        .doc("Values, in place of a range.")
        .optional_scalars("values", "a list of numbers, booleans or texts");
    let bound = -1e12..=1e12;
    let min = axis.doc("Lower end of the range.").optional_number("min", "", bound.clone());
    let max = axis.doc("Upper end of the range.").optional_number("max", "", bound);
    let points = axis
        .doc("Points of the range in a grid or a list, both ends included.")
        .optional_integer("points", 2..=MAX_CASES);
    let choice = |name, doc| Choice { name, doc };
    let scale = axis
        .doc("Spacing in the range.")
        .choice_docs(vec![
            choice("linear", "equal differences"),
            choice("logarithmic", "equal ratios"),
            choice(
                "whole",
                "equal differences, rounded to whole numbers; of a sampled part each end has half the weight of the others",
            ),
        ])
        .choice(
            "scale",
            Scale::Linear,
            &[("linear", Scale::Linear), ("logarithmic", Scale::Logarithmic), ("whole", Scale::Whole)],
        )
        .unwrap_or(Scale::Linear);
    let times = axis
        .doc("Key whose value in the scenario, or in an earlier axis of this part, multiplies each value.")
        .text("times", None)
        .map(str::to_owned);
    let values = match (listed, min, max) {
        (Some(listed), None, None) => Values::Listed(listed.into_iter().map(AxisValue::from).collect()),
        (None, Some(min), Some(max)) => {
            if min >= max {
                axis.reject("max", format!("is no upper end; it must be > {min}"));
            }
            if scale == Scale::Whole && (min.fract() != 0.0 || max.fract() != 0.0) {
                axis.reject("scale", format!("needs whole ends, and the range is {min} to {max}"));
            }
            if scale == Scale::Logarithmic && min <= 0.0 {
                axis.reject("min", "has no logarithm; it must be > 0".to_owned());
            }
            match points {
                None if !method.is_sampled() => axis.reject_section("has a range without points; add points"),
                Some(_) if method.is_sampled() => {
                    axis.reject("points", "is given twice: part.points is for every axis".to_owned());
                }
                _ => {}
            }
            Values::Range(Range { min, max, scale, points })
        }
        _ => {
            axis.reject_section("must give either values, or both min and max");
            Values::Listed(vec![AxisValue::Number(0.0)])
        }
    };
    if let Values::Listed(listed) = &values
        && listed.iter().filter_map(AxisValue::number).any(|number| !number.is_finite())
    {
        axis.reject("values", "has a number that is not finite; remove it".to_owned());
    }
    let is_text =
        matches!(&values, Values::Listed(listed) if listed.iter().any(|value| value.number().is_none()));
    if times.is_some() && is_text {
        axis.reject("times", "multiplies numbers, and this axis has other values".to_owned());
    }
    Axis { keys, label, unit, values, times }
}

fn metric(section: &mut Section<'_>, key: &'static str, doc: &str) -> Option<Metric> {
    let metrics: Vec<_> = Metric::ALL.iter().map(|metric| (metric.name(), *metric)).collect();
    section.doc(doc).optional_choice(key, &metrics)
}

fn read_derived(section: &mut Section<'_>) -> Derived {
    let name = read_name(section, "Name of the column.");
    let source = metric(section, "metric", "Metric that the column is computed from.");
    if source.is_none() {
        section.reject_section("is computed from nothing; add metric");
    }
    let per = section
        .doc("The metric is divided by this number, or by one count of the encoder of `or_count_of` if that is larger.")
        .optional_number("per", "", 1e-12..=1e12);
    let or_count_of = section
        .doc("Key with the counts per revolution of an encoder.")
        .text("or_count_of", None)
        .map(str::to_owned);
    let condition = metric(section, "only_if", "Only runs count in which this metric is at most `at_most`.");
    let at_most = section.doc("Limit of `only_if`.").optional_number("at_most", "", -1e12..=1e12);
    let only_if = match (condition, at_most) {
        (Some(metric), Some(limit)) => Some((metric, limit)),
        (None, None) => None,
        _ => {
            section.reject_section("must give both only_if and at_most, or none of them");
            None
        }
    };
    // The stand-in of a missing metric; the file is rejected.
    Derived { name, metric: source.unwrap_or(Metric::ALL[0]), per, or_count_of, only_if }
}

fn read_expectation(section: &mut Section<'_>) -> Expectation {
    let mut name = |key, doc: &str| section.doc(doc).text(key, None).map(str::to_owned);
    let part = name("part", "Part whose runs count; all parts if absent.");
    let variant = name("variant", "Variant whose runs count; all variants if absent.");
    let column = name("metric", "Metric or derived column.");
    let quantile = section
        .doc("Quantile of the magnitude, by nearest rank; a missing value ranks behind every number.")
        .optional_number("quantile", "", 1e-6..=1.0);
    let max = section.doc("Largest allowed value.").optional_number("max", "", -1e12..=1e12);
    let below = section.doc("Value that must not be reached.").optional_number("below", "", -1e12..=1e12);
    let pass = section
        .doc("Smallest allowed fraction of runs whose verdict is PASS, in place of a metric.")
        .optional_number("pass", "", 0.0..=1.0);
    let confidence = section
        .doc("Level of a two-sided confidence interval, of one variant on one sampled part: order statistics for a quantile, Clopper-Pearson for a fraction.")
        .optional_number("confidence", "", 0.5..=0.999_999);
    let choice = |name, doc| Choice { name, doc };
    let shown = section
        .doc("What must meet the limit.")
        .choice_docs(vec![
            choice("value", "the value over the runs of the campaign"),
            choice(
                "interval",
                "the whole confidence interval: the limit is shown, not only met; needs `confidence`, and a quantile or fraction below 1",
            ),
        ])
        .choice("judge", false, &[("value", false), ("interval", true)])
        .unwrap_or(false);
    if shown && confidence.is_none() {
        section.reject("judge", "needs an interval; add confidence".to_owned());
    }
    let limit = match (max, below) {
        (Some(max), None) => Some(Limit::Max(max)),
        (None, Some(below)) => Some(Limit::Below(below)),
        _ => None,
    };
    let what = match (column, quantile, limit, pass) {
        (Some(column), Some(quantile), Some(limit), None) => Statistic::Quantile { column, quantile, limit },
        (None, None, None, Some(least)) => Statistic::Pass { least },
        _ => {
            section.reject_section("must give metric, quantile and either max or below; or pass alone");
            Statistic::Pass { least: 0.0 }
        }
    };
    let is_whole = match what {
        Statistic::Quantile { quantile, .. } => quantile >= 1.0,
        Statistic::Pass { least } => least >= 1.0,
    };
    if shown && is_whole {
        let problem =
            "can't be met: no number of runs bounds the whole population; take quantile or pass < 1";
        section.reject("judge", problem.to_owned());
    }
    Expectation { part, variant, what, confidence, shown }
}
