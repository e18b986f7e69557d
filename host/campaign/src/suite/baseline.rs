//! Baselines: metric values with tolerances, in a file next to the scenario.
//!
//! ```toml
//! [[case]]
//! settings = ["plant.dead_zone_rad=0.2"]
//! [case.metrics]
//! settle_time_s = { value = 5.104, tolerance = 0.1 }
//! ```
//!
//! The case of a scenario without a sweep has no settings.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::check::Check;
use lashloop_bench::atomic_file::{WriteError, write_whole};
use lashloop_bench::number::six_digits;
use lashloop_bench::regular_file;
use lashloop_plant::metrics::Metric;
use serde::{Deserialize, Serialize};

/// End of the names of baselines.
pub const ENDING: &str = ".baseline.toml";

/// Tolerance of a new entry: this fraction of its value, and at least the smallest one, in the metric's unit.
const TOLERANCE: f64 = 0.02;
const SMALLEST_TOLERANCE: f64 = 1e-4;

const HEAD: &str = "\
# Written by `lashloop test --update`. A run fails if a metric leaves value +- tolerance.
# Tolerances may be edited; a metric without an entry is not compared.

";

#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    #[error("{}: can't be read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{}:{line}: {problem}; correct it, or remove the file and call `lashloop test --update`", path.display())]
    Malformed { path: PathBuf, line: usize, problem: String },
}

impl BaselineError {
    /// File, line and what is wrong.
    #[must_use]
    pub fn place(&self) -> (String, usize, String) {
        match self {
            Self::Read { path, source } => {
                (path.display().to_string(), 1, format!("can't be read: {source}"))
            }
            Self::Malformed { path, line, problem } => (path.display().to_string(), *line, problem.clone()),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    pub value: f64,
    pub tolerance: f64,
}

/// The metrics of one case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseBaseline {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    settings: Vec<String>,
    metrics: BTreeMap<String, Entry>,
}

/// The baselines of a scenario's cases.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    #[serde(rename = "case", default)]
    cases: Vec<CaseBaseline>,
}

/// The baseline of a scenario: `a.baseline.toml` next to `a.toml`.
#[must_use]
pub fn path_of(scenario: &Path) -> PathBuf {
    let stem = scenario.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    scenario.with_file_name(stem + ENDING)
}

impl Baseline {
    /// Reads a baseline; `None` if the file doesn't exist.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML of this form, or names no metric.
    pub fn read(path: &Path) -> Result<Option<Self>, BaselineError> {
        let text = match regular_file::read_text(path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(BaselineError::Read { path: path.to_owned(), source }),
        };
        let malformed = |line, problem| BaselineError::Malformed { path: path.to_owned(), line, problem };
        let baseline: Self = toml_edit::de::from_str(&text).map_err(|error| {
            let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
            malformed(line, error.message().replace('\n', "; "))
        })?;
        for (name, entry) in baseline.cases.iter().flat_map(|case| &case.metrics) {
            let line = || 1 + text.lines().position(|line| line.contains(name.as_str())).unwrap_or(0);
            if unit_of(name).is_none() {
                return Err(malformed(line(), format!("{name} isn't a metric")));
            }
            if !(entry.value.is_finite() && entry.tolerance >= 0.0 && entry.tolerance.is_finite()) {
                let problem = format!("{name}: value and tolerance must be finite, and the tolerance >= 0");
                return Err(malformed(line(), problem));
            }
        }
        Ok(Some(baseline))
    }

    /// The baseline of a case.
    #[must_use]
    pub fn case(&self, settings: &[String]) -> Option<&CaseBaseline> {
        self.cases.iter().find(|case| case.settings == settings)
    }

    /// Takes the metrics of a run as values. A case that has a baseline keeps its metrics and their tolerances. Returns the
    /// metrics that the run has no value for; their entries stay as they are.
    pub fn update(&mut self, settings: &[String], metrics: &BTreeMap<String, f64>) -> Vec<String> {
        let Some(case) = self.cases.iter_mut().find(|case| case.settings == settings) else {
            let entry = |(name, value): (&String, &f64)| (name.clone(), Entry::new(*value));
            let metrics = metrics.iter().map(entry).collect();
            self.cases.push(CaseBaseline { settings: settings.to_vec(), metrics });
            return Vec::new();
        };
        let mut without_value = Vec::new();
        for (name, entry) in &mut case.metrics {
            match metrics.get(name) {
                Some(value) => entry.value = six_digits(*value),
                None => without_value.push(name.clone()),
            }
        }
        without_value
    }

    /// Removes cases that the scenario no longer has.
    pub fn retain(&mut self, is_case: impl Fn(&[String]) -> bool) {
        self.cases.retain(|case| is_case(&case.settings));
    }

    /// Writes the file.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_whole(path, ".baseline-", |file| file.write_all(self.to_text().as_bytes()))
    }

    fn to_text(&self) -> String {
        let mut text = HEAD.to_owned();
        for CaseBaseline { settings, metrics } in &self.cases {
            text += "[[case]]\n";
            if !settings.is_empty() {
                let quoted: Vec<_> =
                    settings.iter().map(|it| toml_edit::Value::from(it.as_str()).to_string()).collect();
                text += &format!("settings = [{}]\n", quoted.join(", "));
            }
            text += "[case.metrics]\n";
            for (name, Entry { value, tolerance }) in metrics {
                text += &format!("{name} = {{ value = {value:?}, tolerance = {tolerance:?} }}\n");
            }
            text.push('\n');
        }
        text.truncate(text.trim_end().len());
        text + "\n"
    }
}

impl CaseBaseline {
    /// The metrics of a run against their baseline, and a sentence for each that left its tolerance.
    #[must_use]
    pub fn check(&self, metrics: &BTreeMap<String, f64>) -> (Vec<Check>, Vec<String>) {
        let (mut checks, mut reasons) = (Vec::new(), Vec::new());
        for (name, entry) in &self.metrics {
            let (value, unit) = (metrics.get(name).copied(), unit_of(name).unwrap_or_default());
            let (min, max) = (entry.value - entry.tolerance, entry.value + entry.tolerance);
            let ok = value.is_some_and(|value| (min..=max).contains(&value));
            if !ok {
                let value =
                    value.map_or("no value".to_owned(), |value| format!("{} {unit}", six_digits(value)));
                let Entry { value: baseline, tolerance } = entry;
                reasons
                    .push(format!("{name}: {value}; leaves its baseline {baseline} +- {tolerance} {unit}"));
            }
            let name = format!("{name}, baseline");
            checks.push(Check { name, value, min: Some(min), max: Some(max), unit: unit.to_owned(), ok });
        }
        (checks, reasons)
    }
}

impl Entry {
    fn new(value: f64) -> Self {
        let tolerance = (TOLERANCE * value.abs()).max(SMALLEST_TOLERANCE);
        let two_digits = format!("{tolerance:.1e}").parse().unwrap_or(tolerance);
        Self { value: six_digits(value), tolerance: two_digits }
    }
}

fn unit_of(metric: &str) -> Option<&'static str> {
    Metric::ALL.iter().find(|it| it.name() == metric).map(|it| it.unit())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn metrics(settle_time_s: f64) -> BTreeMap<String, f64> {
        [("settle_time_s".to_owned(), settle_time_s), ("overshoot_rad".to_owned(), 0.0)].into()
    }

    #[test]
    fn a_metric_that_leaves_its_tolerance_is_named_with_value_baseline_and_tolerance() {
        let mut baseline = Baseline::default();
        assert!(baseline.update(&[], &metrics(5.104)).is_empty());
        let case = baseline.case(&[]).expect("the case");
        assert_eq!(case.check(&metrics(5.2)).1, Vec::<String>::new(), "within 2 %");
        let (checks, reasons) = case.check(&metrics(5.3));
        assert_eq!(reasons, ["settle_time_s: 5.3 s; leaves its baseline 5.104 +- 0.1 s"]);
        assert_eq!(checks.iter().filter(|check| !check.ok).count(), 1);
        let without = case.check(&BTreeMap::new()).1;
        assert!(without[1].starts_with("settle_time_s: no value; leaves"), "{without:?}");
    }

    #[test]
    fn an_update_keeps_edited_tolerances_and_removed_metrics() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.baseline.toml");
        let edited = "[[case]]\nsettings = [\"run.seed=1\"]\n[case.metrics]\nsettle_time_s = { value = 5, tolerance = 0.5 }\n";
        fs::write(&path, edited).expect("a file");
        let mut baseline = Baseline::read(&path).expect("a baseline").expect("a file");
        let seeds = [vec!["run.seed=1".to_owned()], vec!["run.seed=2".to_owned()]];
        for settings in &seeds {
            assert!(baseline.update(settings, &metrics(6.0)).is_empty());
        }
        baseline.write(&path).expect("written");
        let read = Baseline::read(&path).expect("a baseline").expect("a file");
        assert_eq!(read, baseline);
        let entries = |index: usize| read.case(&seeds[index]).expect("a case").metrics.clone();
        assert_eq!(entries(0), [("settle_time_s".to_owned(), Entry { value: 6.0, tolerance: 0.5 })].into());
        assert_eq!(entries(1)["settle_time_s"], Entry { value: 6.0, tolerance: 0.12 });
        assert_eq!(entries(1)["overshoot_rad"], Entry { value: 0.0, tolerance: 1e-4 });
        // A metric without a value keeps its entry.
        let before = baseline.clone();
        assert_eq!(baseline.update(&seeds[0], &BTreeMap::new()), ["settle_time_s"]);
        assert_eq!(baseline, before);
    }

    #[test]
    fn a_wrong_baseline_is_named_by_file_and_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.baseline.toml");
        for (text, want) in [
            ("[[case]]\nsetings = []\n", "toml:2: unknown field `setings`"),
            ("[[case]]\n[case.metrics]\nsettle_time_s = 5\n", "toml:3: "),
            (
                "[[case]]\n[case.metrics]\nsettling = { value = 5, tolerance = 1 }\n",
                "toml:3: settling isn't a metric",
            ),
            ("[[case]]\n[case.metrics]\nsettle_time_s = { value = 5, tolerance = -1 }\n", "tolerance >= 0"),
        ] {
            fs::write(&path, text).expect("a file");
            let error = Baseline::read(&path).expect_err("a wrong file").to_string();
            assert!(error.contains(want), "{error}");
        }
        assert_eq!(Baseline::read(&folder.path().join("b")).expect("no file"), None);
    }
}
