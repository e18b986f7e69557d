//! Scenarios: the run, its plant, the drive's settings, and the expected results.
//!
//! ```text
//! file ──▶ tree (values with origins) ──▶ overrides of the command line ──▶ former names ──▶ reader ──▶ Scenario
//! ```
//!
//! A scenario is a TOML file. Every key has its unit in its name, and every number has a range. An unknown key is rejected,
//! because a key without effect is worse than none. All errors of a file are reported at once, each in one sentence.
//!
//! | section | content | module |
//! |---|---|---|
//! | `title`, `description` | what the scenario shows | this one |
//! | `[run]` `[encoders]` `[link]` `[allow]` `[telemetry]` `[record]` | settings of the bench | [`sections`] |
//! | `[plant]` | a registered model, its keys and its initial state | [`plant`], [`environment`] |
//! | `[controller]` | the law and the drive's parameters | [`controller`] |
//! | `[reference]` | the commanded position | [`lashloop_plant::reference`] |
//! | `[[fault]]` | faults to inject | [`fault`] |
//! | `[[expect]]` | bounds on metrics | [`expectation`] |

pub mod controller;
pub mod environment;
mod error;
pub mod expectation;
pub mod fault;
mod former_names;
mod key_error;
mod keys;
mod origin;
mod overrides;
pub mod plant;
mod plant_keys;
mod range;
mod reader;
mod reference;
pub mod sections;
mod spelling;
mod tree;
mod unit;

use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

pub use self::former_names::present_law;
pub use self::error::{ScenarioError, ScenarioErrors};
pub use self::key_error::KeyError;
pub use self::origin::Origin;
pub use self::overrides::Override;

use self::controller::ControllerSettings;
use self::expectation::Expectation;
use self::fault::InjectedFault;
use self::plant::PlantSettings;
use self::reader::Section;
use self::sections::{
    Allowance, EncoderSettings, LinkSettings, RecordSettings, RunSettings, TelemetrySettings,
};
use lashloop_plant::Plants;
use lashloop_plant::reference::Reference;

/// A scenario in which every key has a value in its allowed range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scenario {
    /// The file as the user named it.
    #[serde(skip)]
    pub name: String,
    /// One line for lists and reports.
    pub title: String,
    /// What the scenario shows, at any length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Duration, control period and seed.
    pub run: RunSettings,
    /// The plant.
    pub plant: PlantSettings,
    /// Resolution and noise of the encoders.
    pub encoders: EncoderSettings,
    /// The law and its parameters.
    pub controller: ControllerSettings,
    /// The commanded position.
    pub reference: Reference,
    /// Timeouts and line speed.
    pub link: LinkSettings,
    /// Losses that don't invalidate the run.
    pub allow: Allowance,
    /// Signals and rate of the drive's telemetry.
    pub telemetry: TelemetrySettings,
    /// How the record is written.
    pub record: RecordSettings,
    /// Faults to inject.
    #[serde(rename = "fault", skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<InjectedFault>,
    /// Bounds on metrics.
    #[serde(rename = "expect")]
    pub expectations: Vec<Expectation>,
}

impl Scenario {
    /// Reads a file, then applies `overrides` in their order.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML, or has keys that are unknown, missing or out of range; all errors at once.
    pub fn from_file(path: &Path, overrides: &[Override]) -> Result<Self, ScenarioErrors> {
        Self::from_file_with(path, overrides, &plant::standard())
    }

    /// As [`from_file`](Self::from_file), with these plant models to choose from.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file).
    pub fn from_file_with(
        path: &Path,
        overrides: &[Override],
        plants: &Plants,
    ) -> Result<Self, ScenarioErrors> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ScenarioError::Read { path: path.to_owned(), source })?;
        Self::from_str_with(&path.to_string_lossy(), &text, overrides, plants)
    }

    /// Reads a text. `name` is the file's name in errors, and relative paths in the text start at its directory.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file), except for reading the file.
    pub fn from_str(name: &str, text: &str, overrides: &[Override]) -> Result<Self, ScenarioErrors> {
        Self::from_str_with(name, text, overrides, &plant::standard())
    }

    /// As [`from_str`](Self::from_str), with these plant models to choose from.
    ///
    /// # Errors
    /// As [`from_str`](Self::from_str).
    pub fn from_str_with(
        name: &str,
        text: &str,
        overrides: &[Override],
        plants: &Plants,
    ) -> Result<Self, ScenarioErrors> {
        let file: Arc<str> = name.into();
        let mut tree = tree::parse_file(&file, text)?;
        let mut errors: Vec<_> =
            overrides.iter().filter_map(|option| option.apply(&mut tree).err()).collect();
        former_names::replace(&mut tree);
        let directory = Path::new(name).parent().unwrap_or(Path::new(""));
        let start = Origin::File { file, line: 1 };
        match reader::read_document(&tree, start, |root| read(root, name, directory, plants)) {
            Ok(scenario) if errors.is_empty() => {
                let errors = expectation::unmeasurable(&scenario, None);
                if errors.is_empty() { Ok(scenario) } else { Err(ScenarioErrors::new(errors)) }
            }
            Ok(_) => Err(ScenarioErrors::new(errors)),
            Err(found) => {
                errors.extend(found);
                Err(ScenarioErrors::new(errors))
            }
        }
    }

    /// The scenario as a file with every default written out. It reads back as the same scenario, except that the path of a
    /// table is relative to the working directory.
    ///
    /// # Errors
    /// The path of a table isn't UTF-8, or a whole number exceeds TOML's signed 64 bits.
    pub fn to_toml(&self) -> Result<String, toml_edit::ser::Error> {
        toml_edit::ser::to_string_pretty(self)
    }
}

fn read(root: &mut Section<'_>, name: &str, directory: &Path, plants: &Plants) -> Scenario {
    let plant = root.section("plant", |section| plant::read(section, plants));
    let run = root.section("run", sections::read_run);
    let faults = root.sections("fault", |section| fault::read(section, &plant.model, plants, &run));
    Scenario {
        name: name.to_owned(),
        title: root.text("title", Some("a text in quotes")).unwrap_or_default().to_owned(),
        description: root.text("description", None).map(str::to_owned),
        run,
        plant,
        encoders: root.section("encoders", EncoderSettings::read),
        controller: root.section("controller", controller::read),
        reference: root.section("reference", |section| reference::read(section, directory)),
        link: root.section("link", sections::read_link),
        allow: root.section("allow", Allowance::read),
        telemetry: root.section("telemetry", TelemetrySettings::read),
        record: root.section("record", RecordSettings::read),
        faults,
        expectations: root.sections("expect", expectation::read),
    }
}
