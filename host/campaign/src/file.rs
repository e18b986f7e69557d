//! The campaign file: its keys, and what contradicts itself.

use std::collections::BTreeSet;

use lashloop_bench::scenario::declare::Settings as _;
use lashloop_bench::scenario::key::Keys;
use lashloop_bench::scenario::{ScenarioErrors, Section, settings_file};
use lashloop_plant::metrics::Metric;

use crate::axis::Axis;
pub use crate::settings::{
    CampaignFile, Derived, Divisor, EvidenceSettings, Expectation, Limit, Method, Part, Statistic,
    VariantSettings,
};
use crate::settings::{Condition, FIRST, Judge, LAST, MISSING, StatisticKeys};
use crate::sobol::DIMENSIONS;
use crate::soundness;

impl CampaignFile {
    /// Reads a text. `name` is the file's name in errors.
    ///
    /// # Errors
    /// The text isn't TOML, or has keys that are unknown, missing or out of range; all errors at once.
    pub fn from_str(name: &str, text: &str) -> Result<Self, ScenarioErrors> {
        settings_file::from_str(name, text, |root| {
            let mut file = Self::read(root);
            share_axes(root, &mut file);
            check(root, &file);
            file
        })
    }

    /// Every key of a campaign file.
    #[must_use]
    pub fn keys() -> Keys {
        Section::keys_of(Self::read)
    }
}

/// Gives parts the axes of the earlier parts that they name.
fn share_axes(root: &Section<'_>, file: &mut CampaignFile) {
    for at in 0..file.parts.len() {
        let (earlier, later) = file.parts.split_at_mut(at);
        let part = &mut later[0];
        let Some(name) = &part.axes_of else { continue };
        let Some(of) = earlier.iter().find(|part| part.name == *name) else {
            root.reject_section(format!(
                "has part {} with axes_of = \"{name}\", and no earlier part of this name",
                part.name
            ));
            continue;
        };
        part.axes.splice(0..0, of.axes.iter().cloned());
        if let Some(problem) = unfit(part) {
            root.reject_section(format!("has part {}, which {problem}", part.name));
        }
    }
}

/// What is wrong with the axes of a part together.
fn unfit(part: &Part) -> Option<String> {
    if part.method == Method::Sobol && part.axes.len() > DIMENSIONS {
        return Some(format!("has more than {DIMENSIONS} axes; take method = \"latin-hypercube\""));
    }
    if part.method == Method::List
        && part.axes.windows(2).any(|pair| pair[0].values.len() != pair[1].values.len())
    {
        return Some("is a list whose axes differ in their number of values; make them equal".to_owned());
    }
    if let Some(problem) = soundness::points(part.method, &part.axes) {
        return Some(problem);
    }
    let keys: Vec<_> = part.axes.iter().flat_map(|axis| &axis.keys).collect();
    let twice = keys.iter().enumerate().find(|(at, key)| keys[..*at].contains(key));
    twice.map(|(_, key)| format!("has {key} in two axes; each key has one"))
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
            root.reject_section(format!("has two {what} of the name {name}; each needs its own"));
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
            root.reject_section(format!(
                "names {column} in [[expect]], which is neither a metric nor a [[derive]] column"
            ));
        }
        if let (Some(_), Some(problem)) = (expectation.confidence, soundness::population(file, expectation)) {
            root.reject_section(format!("has an expectation with confidence, {problem}"));
        }
        let parts = file.parts.iter().map(|part| &part.name);
        let variants = file.variants.iter().map(|variant| &variant.name);
        for (what, named, known) in [
            ("part", &expectation.part, parts.collect::<Vec<_>>()),
            ("variant", &expectation.variant, variants.collect()),
        ] {
            if let Some(name) = named.as_ref().filter(|name| !known.contains(name)) {
                root.reject_section(format!(
                    "has an expectation on {what} {name}, and no [[{what}]] of this name"
                ));
            }
        }
    }
    match &file.evidence.of {
        None if file.evidence.worst > 0 => root.reject_section("has evidence.worst without evidence.of"),
        Some(of) if !columns.contains(of) => {
            root.reject_section(format!(
                "names {of} in [evidence], which is neither a metric nor a [[derive]] column"
            ));
        }
        _ => {}
    }
}

impl Part {
    pub(crate) fn checked(self, part: &mut Section<'_>) -> Self {
        match self.points {
            None if self.method.is_sampled() => part.reject_section("samples without points; add points"),
            Some(_) if !self.method.is_sampled() => {
                part.reject("points", "belongs to a sampled part; grid and list have points per axis");
            }
            _ => {}
        }
        if let Some(problem) = unfit(&self) {
            part.reject_section(problem);
        }
        self
    }
}

impl Condition {
    /// The metric and its limit.
    pub(crate) fn checked(self, section: &mut Section<'_>) -> Option<(Metric, f64)> {
        if self.only_if.is_some() != self.at_most.is_some() {
            section.reject_section("must give both only_if and at_most, or none of them");
        }
        self.only_if.zip(self.at_most)
    }
}

impl StatisticKeys {
    pub(crate) fn checked(self, section: &mut Section<'_>) -> Statistic {
        let Self { metric: column, quantile, max, below, pass } = self;
        let limit = match (max, below) {
            (Some(max), None) => Some(Limit::Max(max)),
            (None, Some(below)) => Some(Limit::Below(below)),
            _ => None,
        };
        match (column, quantile, limit, pass) {
            (Some(column), Some(quantile), Some(limit), None) => {
                Statistic::Quantile { column, quantile, limit }
            }
            (None, None, None, Some(least)) => Statistic::Pass { least },
            _ => {
                section.reject_section("must give metric, quantile and either max or below; or pass alone");
                Statistic::Pass { least: 0.0 }
            }
        }
    }
}

impl Expectation {
    pub(crate) fn checked(self, section: &mut Section<'_>) -> Self {
        let is_shown = self.judge == Judge::Interval;
        if is_shown && self.confidence.is_none() {
            section.reject("judge", "needs an interval; add confidence");
        }
        let is_whole = match self.what {
            Statistic::Quantile { quantile, .. } => quantile >= 1.0,
            Statistic::Pass { least } => least >= 1.0,
        };
        if is_shown && is_whole {
            let problem =
                "can't be met: no number of runs bounds the whole population; take quantile or pass < 1";
            section.reject("judge", problem);
        }
        self
    }
}
