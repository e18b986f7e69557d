//! Where a run comes from: the command line, the scenario's file, and what was set in its place.

use std::env;
use std::path::Path;

use lashloop_bench::regular_file;
use lashloop_bench::run::digest::sha256;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_plant::Plants;
use serde::{Deserialize, Serialize};
use toml_edit::{DocumentMut, Item, Value};

/// Where a run comes from.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RunSource {
    /// The words of the command line.
    pub command_line: Vec<String>,
    /// Folder that relative paths of the command line start from.
    pub working_directory: Option<String>,
    /// SHA-256 of the scenario's file in hexadecimal; `None` for a scenario without a file.
    pub scenario_sha256: Option<String>,
    /// What was set instead of the file's values.
    pub overrides: Vec<Overridden>,
    /// The rig file as the user named it.
    pub rig: Option<String>,
}

/// A key that was set instead of the scenario's value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Overridden {
    /// Path of the key, such as `plant.dead_zone_rad`.
    pub key: String,
    /// The value as it was set.
    pub value: String,
    /// The value of the file, or the default; `None` if the scenario has none.
    pub was: Option<String>,
}

impl RunSource {
    /// The source of a run of this process.
    #[must_use]
    pub fn new(scenario: &Path, overrides: &[Override], plants: &Plants) -> Self {
        let text = regular_file::read(scenario).ok();
        let of_file = || String::from_utf8(text.clone()?).ok()?.parse::<DocumentMut>().ok();
        let before = of_file().filter(|_| !overrides.is_empty()).map(|mut document| {
            document.remove("sweep");
            with_defaults(scenario, &document, plants).unwrap_or(document)
        });
        Self {
            command_line: command_line(),
            working_directory: working_directory(),
            scenario_sha256: text.as_deref().map(sha256),
            overrides: overrides.iter().map(|it| Overridden::new(it, before.as_ref())).collect(),
            rig: None,
        }
    }
}

/// The document with the defaults; `None` if it isn't a scenario without overrides.
fn with_defaults(path: &Path, document: &DocumentMut, plants: &Plants) -> Option<DocumentMut> {
    let name = path.to_str()?;
    let scenario = Scenario::from_str_with(name, &document.to_string(), &[], plants).ok()?;
    scenario.to_toml().ok()?.parse().ok()
}

/// The working directory of this process; `None` if it was removed.
#[must_use]
pub fn working_directory() -> Option<String> {
    env::current_dir().ok().map(|folder| folder.display().to_string())
}

impl Overridden {
    fn new(set: &Override, before: Option<&DocumentMut>) -> Self {
        let (key, value) = match set {
            Override::Set(assignment) => assignment.split_once('=').unwrap_or((assignment, "")),
            Override::Controller(name) => ("controller.name", name.as_str()),
            Override::Mode(mode) => ("run.mode", mode.as_str()),
        };
        let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
        let was = before.and_then(|document| at(document.as_item(), &key));
        Self { key, value, was }
    }
}

/// The value of a key as a user writes it.
fn at(root: &Item, path: &str) -> Option<String> {
    let mut item = root;
    for step in path.split('.') {
        item = match step.parse::<usize>() {
            Ok(index) if item.is_array_of_tables() || item.is_array() => item.get(index)?,
            _ => item.get(step)?,
        };
    }
    match item {
        Item::Value(Value::String(text)) => Some(text.value().clone()),
        item => Some(item.to_string().trim().to_owned()),
    }
}

/// The command line of this process, as a record may show it. Bytes that aren't UTF-8 are replaced.
#[must_use]
pub fn command_line() -> Vec<String> {
    std::env::args_os().map(|argument| without_secret(argument.to_string_lossy().into_owned())).collect()
}

/// An argument as a record may show it: others read records.
fn without_secret(argument: String) -> String {
    match argument.split_once('=') {
        Some((option @ "--live-token", _)) => format!("{option}=***"),
        _ => argument,
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use lashloop_bench::scenario::plant::standard;

    #[test]
    fn an_override_names_the_value_of_the_file_or_the_default() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smooth-after.toml"));
        let set = |text: &str| Override::Set(text.to_owned());
        let overrides = [
            set("plant.dead_zone_rad = 0.2"),
            set("run.warm_up_steps=5"),
            set("expect.0.max=9"),
            set("controller.parameters.no_such=1"),
            Override::Controller("pd".to_owned()),
        ];
        let source = RunSource::new(path, &overrides, &standard());
        let was: Vec<_> =
            source.overrides.iter().map(|it| (&*it.key, &*it.value, it.was.as_deref())).collect();
        let want = [
            ("plant.dead_zone_rad", "0.2", Some("0.16")),
            ("run.warm_up_steps", "5", Some("0")),
            ("expect.0.max", "9", Some("5.24")),
            ("controller.parameters.no_such", "1", None),
            ("controller.name", "pd", Some("merzouki")),
        ];
        assert_eq!(was, want);
        assert_eq!(source.scenario_sha256.map(|it| it.len()), Some(64));
        let folder = tempfile::tempdir().expect("a folder");
        let swept = folder.path().join("swept.toml");
        let sweep = "[[sweep.axis]]\nkey = \"encoders.noise_counts\"\nvalues = [0.1, 0.2]\n";
        fs::write(&swept, fs::read_to_string(path).expect("a scenario") + sweep).expect("a scenario");
        let source = RunSource::new(&swept, &[set("encoders.noise_counts=0.1")], &standard());
        assert_eq!(source.overrides[0].was.as_deref(), Some("0.0"), "the default");
    }
}
