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
//! | `meant` | traps that are meant | `traps` |
//! | `[run]` `[encoders]` `[line]` `[link]` `[allow]` `[telemetry]` `[record]` | settings of the bench | [`sections`] |
//! | `[bench]` | what lies at the drive's pins in bench mode | [`mod@bench`] |
//! | `[plant]` | a registered model, its keys and its initial state | [`plant`], [`environment`] |
//! | `[controller]` | the law and the drive's parameters | [`controller`] |
//! | `[reference]` | the commanded position | [`lashloop_plant::reference`] |
//! | `[[fault]]` | faults to inject | [`fault`] |
//! | `[[expect]]` | bounds on metrics | [`expectation`] |
//! | `[sweep]` | cases of `lashloop test` | [`sweep`], [`cases`] |

pub mod bench;
pub mod cases;
mod catalogue;
pub mod controller;
pub mod environment;
mod error;
pub mod expectation;
pub mod fault;
mod file;
mod former_names;
pub mod key;
mod key_error;
mod keys;
mod origin;
mod overrides;
pub mod plant;
mod plant_keys;
pub mod range;
mod reader;
mod reference;
mod run_mode;
pub mod sections;
pub mod settings_file;
mod spelling;
pub mod sweep;
pub mod tables;
mod traps;
mod tree;
mod unit;

use std::path::Path;

use serde::Serialize;

pub use self::error::{ScenarioError, ScenarioErrors};
pub use self::former_names::present_law;
pub use self::key_error::KeyError;
pub use self::origin::Origin;
pub use self::overrides::Override;
pub use self::reader::{Scalar, Section};
pub use self::run_mode::RunMode;
pub use self::traps::Trap;

use self::bench::BenchSettings;
use self::catalogue::Catalogue;
use self::controller::ControllerSettings;
use self::expectation::{Expectation, PlannedRun};
use self::fault::InjectedFault;
use self::key::Keys;
use self::plant::PlantSettings;
use self::sections::{
    Allowance, EncoderSettings, LineSettings, LinkSettings, RecordSettings, RunSettings, TelemetrySettings,
};
use self::tables::{GivenTables, Tables};
use self::traps::{Facts, Meant, Nominal};
use self::tree::Table;
use lashloop_plant::Plants;
use lashloop_plant::metrics::SignalTable;
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
    /// Traps that are meant.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meant: Vec<Trap>,
    /// Duration, control period and seed.
    pub run: RunSettings,
    /// The plant.
    pub plant: PlantSettings,
    /// Resolution and noise of the encoders.
    pub encoders: EncoderSettings,
    /// The law and its parameters.
    pub controller: ControllerSettings,
    /// Encoders and power stage at the drive's pins, in bench mode.
    #[serde(skip_serializing_if = "BenchSettings::is_empty")]
    pub bench: BenchSettings,
    /// The commanded position.
    pub reference: Reference,
    /// The modelled line from the law to the motor.
    pub line: LineSettings,
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
    /// What the drive's defaults have to equal.
    #[serde(skip)]
    nominal: Nominal,
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
        let text = file::read(path, "scenario")?;
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
        let known = Self::catalogue(plants);
        let (tree, errors) = overrides::read_tree(&name.into(), text, overrides, &known)?;
        Self::from_tree(name, tree, errors, !overrides.is_empty(), plants, &GivenTables::new())
    }

    /// Reads a document. `errors` are those found before; `is_overridden` means that values differ from the file.
    fn from_tree(
        name: &str,
        mut tree: Table,
        mut errors: Vec<ScenarioError>,
        is_overridden: bool,
        plants: &Plants,
        given: &GivenTables,
    ) -> Result<Self, ScenarioErrors> {
        former_names::replace(&mut tree);
        let directory = Path::new(name).parent().unwrap_or(Path::new(""));
        let start = Origin::File { file: name.into(), line: 1, column: 1 };
        let tables = Tables { directory, given };
        let document = reader::read_document(&tree, start, |root| read(root, name, tables, plants));
        let (mut scenario, meant) = document.result;
        errors.extend(document.errors);
        if errors.is_empty() {
            let facts = Facts {
                keys: &document.keys,
                reference: &scenario.reference,
                parameters: &scenario.controller.parameters,
                is_overridden,
            };
            errors = traps::check(&facts, &meant);
            errors.extend(expectation::unmeasurable(&scenario.planned_run(), None));
            scenario.nominal = Nominal::new(&facts);
        }
        if errors.is_empty() { Ok(scenario) } else { Err(ScenarioErrors::new(errors)) }
    }

    /// Compares the plant with the drive's own parameters: ratio, gap and inertias, as far as `[controller.parameters]` leaves
    /// them to the drive. `default_of` gives the default of the drive's parameter of a name; `None` if the drive, or the law
    /// in force, has no such parameter.
    ///
    /// # Errors
    /// The plant differs, and the scenario has no `meant = ["mismatch"]`.
    pub fn check_drive(&self, default_of: impl Fn(&str) -> Option<f64>) -> Result<(), ScenarioErrors> {
        if self.meant.contains(&Trap::Mismatch) {
            return Ok(());
        }
        let errors = self.nominal.check(default_of);
        if errors.is_empty() { Ok(()) } else { Err(ScenarioErrors::new(errors)) }
    }

    /// Checks that a run with these signals can measure every expectation, and that the units of signals are right.
    ///
    /// # Errors
    /// Every expectation that the run can't measure, at its place in the scenario.
    pub fn check_expectations(&self, signals: &SignalTable) -> Result<(), ScenarioErrors> {
        let errors = expectation::unmeasurable(&self.planned_run(), Some(signals));
        if errors.is_empty() { Ok(()) } else { Err(errors.into()) }
    }

    fn planned_run(&self) -> PlannedRun<'_> {
        PlannedRun {
            expectations: &self.expectations,
            run: &self.run,
            plant: &self.plant,
            controller: &self.controller,
            reference: &self.reference,
            telemetry: &self.telemetry,
        }
    }

    /// Every key that a scenario can have.
    #[must_use]
    pub fn keys() -> Keys {
        Self::keys_with(&plant::standard())
    }

    /// As [`keys`](Self::keys), with these plant models to choose from.
    #[must_use]
    pub fn keys_with(plants: &Plants) -> Keys {
        Self::catalogue(plants).all()
    }

    fn catalogue(plants: &Plants) -> Catalogue<'_> {
        Catalogue::new(|root| {
            read(root, "", Tables { directory: Path::new(""), given: &GivenTables::new() }, plants);
        })
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

fn read(root: &mut Section<'_>, name: &str, tables: Tables<'_>, plants: &Plants) -> (Scenario, Meant) {
    let title = root.doc("One line for lists and reports.").text("title", Some("a text in quotes"));
    let description = root.doc("What the scenario shows, at any length.").text("description", None);
    let meant = traps::read_meant(root);
    let run = root.doc("Duration, control period and seed.").section("run", sections::read_run);
    let plant =
        root.doc("The mechanics: load, motor, and what is between them.").section("plant", |section| {
            let plant = plant::read(section, plants, tables.directory);
            if !run.mode.is_hil() {
                bench::check_plant(section, &plant);
            }
            plant
        });
    let encoders = root.doc("Resolution and noise of the encoders.").section("encoders", |section| {
        let encoders = EncoderSettings::read(section);
        if !run.mode.is_hil() {
            bench::check_encoders(section, &encoders);
        }
        encoders
    });
    let controller =
        root.doc("The drive's control law and parameters.").section("controller", controller::read);
    let bench = root
        .doc("Encoders and power stage at the drive's pins, as parameters of the drive. In HIL mode the section has no effect; an absent key keeps the drive's default.")
        .section("bench", bench::read);
    let reference = root
        .doc("The commanded load position.")
        .section("reference", |section| reference::read(section, tables));
    let link = root.doc("Timeouts and line speed.").section("link", |section| {
        let link = sections::read_link(section);
        if !run.mode.is_hil() {
            bench::check_link(section, &link);
        }
        link
    });
    let line = root
        .doc("A modelled line from the law to the motor, in the plant's time. It repeats bit for bit, unlike a real line.")
        .section("line", |section| {
            let line = LineSettings::read(section);
            if !run.mode.is_hil() {
                bench::check_line(section, &line);
            }
            line
        });
    let allow = root
        .doc("Limits beyond which a run is INVALID, because it doesn't judge the drive.")
        .section("allow", Allowance::read);
    let telemetry = root.doc("Telemetry of the drive.").section("telemetry", TelemetrySettings::read);
    let record = root.doc("How the record is written.").section("record", RecordSettings::read);
    let faults = root
        .doc("A fault to inject; [faults.md](faults.md) has what each kind does and how it is detected.")
        .sections("fault", |section| fault::read(section, &plant.model, plants, &run));
    let expectations =
        root.doc("Bounds on a metric that the run must meet to pass.").sections("expect", expectation::read);
    let sweep = root
        .doc("Cases of `lashloop test`; [suites.md](suites.md) has examples. Other commands reject a scenario with a sweep.")
        .section("sweep", sweep::read);
    if let Some(node) = root.node("sweep") {
        let reason = "cases of a sweep are run by `lashloop test`; for another command remove the section";
        let (found, reason) = (sweep.count().to_string(), reason.to_owned());
        root.error("sweep", node, KeyError::Rejected { found, reason });
    }
    let scenario = Scenario {
        name: name.to_owned(),
        title: title.unwrap_or_default().to_owned(),
        description: description.map(str::to_owned),
        meant: meant.iter().map(|(trap, _)| *trap).collect(),
        run,
        plant,
        encoders,
        controller,
        bench,
        reference,
        line,
        link,
        allow,
        telemetry,
        record,
        faults,
        expectations,
        nominal: Nominal::default(),
    };
    (scenario, meant)
}
