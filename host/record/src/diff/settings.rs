//! What was set for a run: the scenario's keys, the parameters in force, drive, bench and host.
//!
//! Keys are those of the files, so that a further entry of the manifest is compared without a change here.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use serde_json::Value;

use super::record_files::RecordFiles;

/// What a setting belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// A key of the scenario.
    Scenario,
    /// A parameter in force of the drive.
    Parameter,
    /// The run outside the scenario: clock, mode, law and seed of a record without its scenario.
    Run,
    /// Device, firmware and the files that ran as the drive.
    Drive,
    /// Version and build of the bench.
    Bench,
    /// The machine.
    Host,
}

/// A setting of several records.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// What it belongs to.
    pub group: Group,
    /// Its key.
    pub key: String,
    /// The value in each record; `None` in a record that lacks the key.
    pub values: Vec<Option<String>>,
}

impl Setting {
    /// Whether all records have the same value.
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.values.windows(2).all(|pair| pair[0] == pair[1])
    }
}

/// The settings that all these records can have, in the order of groups and keys: an older one lacks manifest and scenario.
#[must_use]
pub fn settings(records: &[RecordFiles]) -> Vec<Setting> {
    let all_have = |file: fn(&RecordFiles) -> &Option<Value>| records.iter().all(|it| file(it).is_some());
    let (has_manifest, has_scenario) = (all_have(|it| &it.manifest), all_have(|it| &it.scenario));
    let of = |files: &RecordFiles| {
        let manifest = if has_manifest { &files.manifest } else { &files.summary };
        Settings::new(manifest.as_ref(), files.scenario.as_ref().filter(|_| has_scenario))
    };
    side_by_side(&records.iter().map(of).collect::<Vec<_>>())
}

fn side_by_side(records: &[Settings]) -> Vec<Setting> {
    let keys: BTreeSet<_> = records.iter().flat_map(|it| it.0.keys()).collect();
    let setting = |key: &(Group, String)| Setting {
        group: key.0,
        key: key.1.clone(),
        values: records.iter().map(|it| it.0.get(key).cloned()).collect(),
    };
    keys.into_iter().map(setting).collect()
}

/// The settings of a record.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Settings(BTreeMap<(Group, String), String>);

/// Entries of a manifest or summary that are no settings, or repeat the scenario's keys.
const NO_SETTINGS: [&str; 9] = [
    "command_line",
    "working_directory",
    "started",
    "overrides",
    "signals",
    "plant_signals",
    "warnings",
    "telemetry",
    "device_description",
];
/// Entries that are keys of the scenario too.
const OF_SCENARIO: [&str; 6] = ["seed", "mode", "law", "controller", "period_us", "telemetry_every_steps"];

impl Settings {
    /// `manifest` is that of the record, or the summary of an older one; `scenario` the resolved scenario.
    fn new(manifest: Option<&Value>, scenario: Option<&Value>) -> Self {
        let mut settings = Self::default();
        if let Some(scenario) = scenario {
            settings.flatten(Group::Scenario, "", scenario);
        }
        for (key, value) in manifest.and_then(Value::as_object).into_iter().flatten() {
            match (&**key, value) {
                (key, _) if NO_SETTINGS.contains(&key) => {}
                (key, _) if scenario.is_some() && (key == "scenario" || OF_SCENARIO.contains(&key)) => {}
                ("scenario", Value::Object(scenario)) => {
                    settings.flatten(Group::Run, "scenario", scenario.get("name").unwrap_or(&Value::Null));
                }
                ("plant_files", files) => settings.take_files(Group::Run, Some(files)),
                ("parameters", Value::Array(parameters)) => settings.take_parameters(parameters),
                ("evidence", Value::Object(evidence)) => {
                    settings.take_files(Group::Drive, evidence.get("files"));
                    settings.flatten(
                        Group::Bench,
                        "build",
                        evidence.get("bench_build").unwrap_or(&Value::Null),
                    );
                }
                ("versions", Value::Object(versions)) => {
                    for (key, version) in versions {
                        let group = if key.starts_with("firmware") { Group::Drive } else { Group::Bench };
                        settings.flatten(group, key, version);
                    }
                }
                ("device", device) => settings.flatten(Group::Drive, key, device),
                ("host", host) => settings.flatten(Group::Host, "", host),
                ("format", format) => settings.flatten(Group::Bench, "record.format", format),
                (key, value) if manifest.is_some_and(is_manifest) || OF_SCENARIO.contains(&key) => {
                    settings.flatten(Group::Run, key, value);
                }
                // The rest of a summary are results.
                _ => {}
            }
        }
        settings
    }

    fn flatten(&mut self, group: Group, path: &str, value: &Value) {
        let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            Value::Null => {}
            Value::Object(entries) => {
                for (key, value) in entries {
                    self.flatten(group, &below(key), value);
                }
            }
            Value::Array(items) if items.iter().any(Value::is_object) => {
                for (index, item) in items.iter().enumerate() {
                    self.flatten(group, &format!("{path}[{index}]"), item);
                }
            }
            value => {
                self.0.insert((group, path.to_owned()), plain(value));
            }
        }
    }

    fn take_parameters(&mut self, parameters: &[Value]) {
        for parameter in parameters {
            let text = |key: &str| parameter.get(key).map(plain).unwrap_or_default();
            let number = format!("{} {}", text("value"), text("unit")).trim_end().to_owned();
            let value = parameter.get("choice").and_then(Value::as_str).map_or(number, str::to_owned);
            self.0.insert((Group::Parameter, text("name")), value);
        }
    }

    /// By the file's name: its folder is no property of the run.
    fn take_files(&mut self, group: Group, files: Option<&Value>) {
        for file in files.and_then(Value::as_array).into_iter().flatten() {
            let text = |key: &str| file.get(key).map(plain).unwrap_or_default();
            let path = text("path");
            let name = path.rsplit('/').next().unwrap_or(&path);
            // Two files may share their name: those of a drive have an order.
            let key = |number: usize| match number {
                1 => format!("sha256 of {name}"),
                number => format!("sha256 of {name} ({number})"),
            };
            let free = (1..).map(key).find(|key| !self.0.contains_key(&(group, key.clone())));
            self.0.extend(free.map(|key| ((group, key), text("sha256"))));
        }
    }
}

/// A summary has results too.
fn is_manifest(value: &Value) -> bool {
    value.get("verdict").is_none()
}

/// A text without its quotes, so that a value reads as a user writes it after `--set`.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn found(a: &Settings, b: &Settings) -> Vec<(Group, String, Option<String>, Option<String>)> {
        let differing = side_by_side(&[a.clone(), b.clone()]).into_iter().filter(|it| !it.is_same());
        differing
            .map(|Setting { group, key, values }| (group, key, values[0].clone(), values[1].clone()))
            .collect()
    }

    fn some(text: &str) -> Option<String> {
        Some(text.to_owned())
    }

    #[test]
    fn keys_of_the_scenario_and_parameters_differ_by_name() {
        let of = |kp: f64, fault: Value, parameters: Value| {
            let scenario = json!({"controller": {"name": "pd", "parameters": {"kp": kp}}, "fault": fault});
            let manifest = json!({
                "format": 2, "seed": 1, "command_line": [kp.to_string()], "working_directory": kp.to_string(), "started": kp.to_string(),
                "parameters": parameters
            });
            Settings::new(Some(&manifest), Some(&scenario))
        };
        let parameter = |name: &str, value: f64| json!({"name": name, "value": value, "unit": "N m"});
        let a = of(5.0, json!([]), json!([parameter("kp", 5.0), parameter("limit", 1.0)]));
        let b = of(6.0, json!([{"step": 3}]), json!([parameter("limit", 1.0), parameter("kp", 6.0)]));
        assert_eq!(
            found(&a, &b),
            [
                (Group::Scenario, "controller.parameters.kp".to_owned(), some("5.0"), some("6.0")),
                (Group::Scenario, "fault".to_owned(), some("[]"), None),
                (Group::Scenario, "fault[0].step".to_owned(), None, some("3")),
                (Group::Parameter, "kp".to_owned(), some("5.0 N m"), some("6.0 N m")),
            ]
        );
        assert_eq!(found(&a, &a), []);
    }

    #[test]
    fn builds_files_and_machine_have_groups_of_their_own() {
        let of = |build: &str, folder: &str, kernel: &str| {
            let manifest = json!({
                "device": "qemu", "host": {"kernel": kernel, "cores": 2}, "clock": "lockstep",
                "evidence": {"files": [{"path": format!("{folder}/drive.elf"), "sha256": build}], "bench_build": "b", "warnings": [folder]},
                "versions": {"lashloop": "0.1.0", "firmware_build": build}
            });
            Settings::new(Some(&manifest), None)
        };
        assert_eq!(
            found(&of("1", "/a", "6.1"), &of("2", "/b", "6.2")),
            [
                (Group::Drive, "firmware_build".to_owned(), some("1"), some("2")),
                (Group::Drive, "sha256 of drive.elf".to_owned(), some("1"), some("2")),
                (Group::Host, "kernel".to_owned(), some("6.1"), some("6.2")),
            ]
        );
    }

    #[test]
    fn two_files_of_one_name_are_both_compared() {
        let of = |second: &str| {
            let file = |path: &str, sha256: &str| json!({"path": path, "sha256": sha256});
            let files = json!([file("/a/main.py", "1"), file("/b/main.py", second)]);
            Settings::new(Some(&json!({"plant_files": files})), None)
        };
        let name = "sha256 of main.py (2)".to_owned();
        assert_eq!(found(&of("2"), &of("3")), [(Group::Run, name, some("2"), some("3"))]);
    }

    #[test]
    fn an_older_record_gives_law_seed_and_versions_but_no_results() {
        let of = |law: &str, steps: u32| json!({"verdict": "PASS", "controller": law, "seed": 1, "steps": steps, "metrics": {"m": steps}, "scenario": "a.toml"});
        let [a, b] = [of("pd", 1), of("merzouki", 2)].map(|summary| Settings::new(Some(&summary), None));
        assert_eq!(found(&a, &b), [(Group::Run, "controller".to_owned(), some("pd"), some("merzouki"))]);
    }
}
