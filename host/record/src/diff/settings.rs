//! What was set for a run: the scenario's keys, the parameters in force, drive, bench and host.

use std::collections::{BTreeMap, BTreeSet};

use lashloop_bench::device::{Evidence, FileHash};
use serde::Serialize;
use serde_json::Value;

use super::record_files::RecordFiles;
use crate::manifest::{Manifest, ParameterInForce};
use crate::summary::Versions;

/// What a setting belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// A key of the scenario.
    Scenario,
    /// A parameter in force of the drive.
    Parameter,
    /// The run outside the scenario: clock, rig and the files of the plant.
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

/// The settings of these records, in the order of groups and keys.
#[must_use]
pub fn settings(records: &[RecordFiles]) -> Vec<Setting> {
    let of = |files: &RecordFiles| Settings::new(&files.record.manifest, &files.scenario);
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

impl Settings {
    fn new(manifest: &Manifest, scenario: &Value) -> Self {
        let mut settings = Self::default();
        settings.flatten(Group::Scenario, "", scenario);
        // Every entry, so that a further one is compared or left out on purpose.
        let Manifest {
            format,
            clock,
            real_time,
            rig,
            device,
            evidence: Evidence { files, bench_build, warnings: _ },
            plant_files,
            host,
            versions: Versions { lashloop, protocol, firmware, firmware_build, firmware_dirty },
            parameters,
            // The scenario has these.
            scenario: _,
            seed: _,
            mode: _,
            law: _,
            period_us: _,
            telemetry_every_steps: _,
            // These set nothing.
            command_line: _,
            working_directory: _,
            started: _,
            overrides: _,
            device_description: _,
            signals: _,
            plant_signals: _,
        } = manifest;
        settings.take_parameters(parameters);
        settings.take(Group::Run, "clock", clock);
        settings.take(Group::Run, "real_time", real_time);
        settings.take(Group::Run, "rig", rig);
        settings.take_files(Group::Run, plant_files);
        settings.take(Group::Drive, "device", device);
        settings.take(Group::Drive, "firmware", firmware);
        settings.take(Group::Drive, "firmware_build", firmware_build);
        settings.take(Group::Drive, "firmware_dirty", firmware_dirty);
        settings.take_files(Group::Drive, files);
        settings.take(Group::Bench, "build", bench_build);
        settings.take(Group::Bench, "lashloop", lashloop);
        settings.take(Group::Bench, "protocol", protocol);
        settings.take(Group::Bench, "record.format", format);
        settings.take(Group::Host, "", host);
        settings
    }

    fn take(&mut self, group: Group, path: &str, value: &impl Serialize) {
        // No map in it has keys other than texts.
        self.flatten(group, path, &serde_json::to_value(value).unwrap_or_default());
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

    fn take_parameters(&mut self, parameters: &[ParameterInForce]) {
        for ParameterInForce { name, value, choice, unit, .. } in parameters {
            let number = || format!("{value} {unit}").trim_end().to_owned();
            self.0.insert((Group::Parameter, name.clone()), choice.clone().unwrap_or_else(number));
        }
    }

    /// By the file's name: its folder isn't a property of the run.
    fn take_files(&mut self, group: Group, files: &[FileHash]) {
        for FileHash { path, sha256 } in files {
            let name = path.rsplit('/').next().unwrap_or(path);
            // Two files may share their name: those of a drive have an order.
            let key = |number: usize| match number {
                1 => format!("sha256 of {name}"),
                number => format!("sha256 of {name} ({number})"),
            };
            let free = (1..).map(key).find(|key| !self.0.contains_key(&(group, key.clone())));
            let hash = sha256.clone().unwrap_or_else(|| "unknown".to_owned());
            self.0.extend(free.map(|key| ((group, key), hash)));
        }
    }
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
    use crate::manifest::Number;
    use crate::manifest::tests::manifest;

    fn found(a: &Settings, b: &Settings) -> Vec<(Group, String, Option<String>, Option<String>)> {
        let differing = side_by_side(&[a.clone(), b.clone()]).into_iter().filter(|it| !it.is_same());
        differing
            .map(|Setting { group, key, values }| (group, key, values[0].clone(), values[1].clone()))
            .collect()
    }

    fn some(text: &str) -> Option<String> {
        Some(text.to_owned())
    }

    fn file(path: &str, sha256: &str) -> FileHash {
        FileHash { path: path.to_owned(), sha256: some(sha256) }
    }

    #[test]
    fn keys_of_the_scenario_and_parameters_differ_by_name() {
        let parameter = |name: &str, value: f32| ParameterInForce {
            name: name.to_owned(),
            value: Number::Real(value),
            choice: None,
            unit: "N m".to_owned(),
            default: Number::Real(0.0),
            of_law: true,
        };
        let of = |kp: f32, fault: Value, parameters: [ParameterInForce; 2]| {
            let scenario = json!({"controller": {"name": "pd", "parameters": {"kp": kp}}, "fault": fault});
            let text = kp.to_string();
            let manifest = Manifest {
                command_line: vec![text.clone()],
                working_directory: Some(text.clone()),
                started: text,
                parameters: parameters.into(),
                ..manifest()
            };
            Settings::new(&manifest, &scenario)
        };
        let a = of(5.0, json!([]), [parameter("kp", 5.0), parameter("limit", 1.0)]);
        let b = of(6.0, json!([{"step": 3}]), [parameter("limit", 1.0), parameter("kp", 6.0)]);
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
            let mut manifest = manifest();
            manifest.host.kernel = kernel.to_owned();
            manifest.evidence.files = vec![file(&format!("{folder}/drive.elf"), build)];
            manifest.evidence.warnings = vec![folder.to_owned()];
            manifest.versions.firmware_build = some(build);
            Settings::new(&manifest, &json!({}))
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
            let plant_files = vec![file("/a/main.py", "1"), file("/b/main.py", second)];
            Settings::new(&Manifest { plant_files, ..manifest() }, &json!({}))
        };
        let name = "sha256 of main.py (2)".to_owned();
        assert_eq!(found(&of("2"), &of("3")), [(Group::Run, name, some("2"), some("3"))]);
    }
}
