//! Scenarios: the run, its plant, the drive's settings, and the expected results.
//!
//! ```text
//! file ──▶ tree (values with origins) ──▶ overrides of the command line ──▶ reader ──▶ Scenario
//! ```
//!
//! A scenario is a TOML file. Every key has its unit in its name, and every number has a range. An unknown key is rejected,
//! because a key without effect is worse than none. All errors of a file are reported at once, each in one sentence.
//!
//! | section | content | module |
//! |---|---|---|
//! | `title`, `description` | what the scenario shows | this one |
//! | `meant` | traps that are meant | `traps` |
//! | `[run]` `[encoders]` `[line]` `[link]` `[allow]` `[telemetry]` `[record]` | settings of the bench | [`mod@sections`] |
//! | `[scope]` | what the drive captures | [`mod@scope`] |
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
pub mod declare;
pub mod electrical;
pub mod environment;
mod error;
pub mod expectation;
pub mod fault;
mod file;
pub mod key;
mod key_error;
mod origin;
mod overrides;
pub mod plant;
mod plant_keys;
pub mod range;
mod reader;
mod reference;
pub mod scope;
pub mod sections;
pub mod settings_file;
mod spelling;
pub mod sweep;
pub mod tables;
mod traps;
mod tree;
pub mod unit;

use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

pub use self::declare::Scalar;
pub use self::error::{ScenarioError, ScenarioErrors};
pub use self::key_error::KeyError;
pub use self::origin::Origin;
pub use self::overrides::Override;
pub use self::reader::Section;
pub use self::sections::RunMode;
pub(crate) use self::spelling::nearest;
pub use self::traps::Trap;

use self::bench::BenchSettings;
use self::controller::ControllerSettings;
use self::declare::{Field, any_text, choices, plain, section, sections, skipped, text};
use self::expectation::{Expectation, PlannedRun};
use self::fault::InjectedFault;
use self::key::Keys;
use self::plant::PlantSettings;
use self::reference::ReferenceKeys;
use self::scope::ScopeSettings;
use self::sections::{
    Allowance, EncoderSettings, LineSettings, LinkSettings, RecordSettings, RunSettings, TelemetrySettings,
};
use self::sweep::Sweep;
use self::tables::{GivenTables, Tables};
use self::traps::{Facts, Nominal};
use self::tree::Table;
use crate::settings;
use lashloop_plant::Plants;
use lashloop_plant::metrics::SignalTable;
use lashloop_plant::reference::Reference;

/// What a scenario is read with.
#[derive(Clone, Copy)]
struct ReadWith<'a> {
    /// The file as the user named it.
    name: &'a str,
    plants: &'a Plants,
    tables: Tables<'a>,
}

settings! {
    /// A scenario in which every key has a value in its allowed range.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct Scenario with(with: ReadWith<'_>) {
        /// The file as the user named it.
        #[serde(skip)]
        pub name: String = skipped(|_| with.name.to_owned()),
        /// One line for lists and reports.
        pub title: String = text("a text in quotes"),
        /// What the scenario shows, at any length.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub description: Option<String> = any_text(),
        /// Traps that are meant. Without its entry, a trap is an error before the run; an entry that the file doesn't need
        /// is an error too.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub meant: Vec<Trap> = choices().map(traps::check_meant),
        /// Duration, control period and seed.
        pub run: RunSettings = section(RunSettings::checked),
        /// The mechanics: load, motor, and what is between them.
        pub plant: PlantSettings = plant::field(with.plants, with.tables.directory),
        /// Resolution and noise of the encoders.
        pub encoders: EncoderSettings = section(plain),
        /// The drive's control law and parameters.
        pub controller: ControllerSettings = section(plain),
        /// Encoders and power stage at the drive's pins, as parameters of the drive: [stages.md](hardware/stages.md). In HIL mode
        /// the section has no effect; an absent key keeps the drive's default.
        #[serde(skip_serializing_if = "BenchSettings::is_empty")]
        pub bench: BenchSettings = section(plain),
        /// The commanded load position.
        pub reference: Reference = section(|keys: ReferenceKeys, section| keys.reference(section, with.tables)),
        /// A modelled line from the law to the motor, in the plant's time. It repeats bit for bit, unlike a real line.
        pub line: LineSettings = section(plain),
        /// Timeouts and line speed.
        pub link: LinkSettings = section(LinkSettings::checked),
        /// Limits beyond which a run is INVALID, because it doesn't judge the drive.
        pub allow: Allowance = section(plain),
        /// Telemetry of the drive.
        pub telemetry: TelemetrySettings = section(plain),
        /// Signals that the drive captures around an event, at the rate of its loop. Their rows are scope.csv in the record.
        #[serde(skip_serializing_if = "ScopeSettings::is_off")]
        pub scope: ScopeSettings = section(plain),
        /// How the record is written.
        pub record: RecordSettings = section(plain),
        /// A fault to inject; [faults.md](faults.md) has what each kind does and how it is detected.
        #[serde(rename = "fault", skip_serializing_if = "Vec::is_empty")]
        pub faults as "fault": Vec<InjectedFault> = sections(InjectedFault::checked),
        /// Bounds on a metric that the run must meet to pass.
        #[serde(rename = "expect")]
        pub expectations as "expect": Vec<Expectation> = sections(Expectation::checked),
        /// Cases of `lashloop test`; [suites.md](suites.md) has examples. Other commands reject a scenario with a sweep.
        #[serde(skip)]
        sweep: () = section(Sweep::rejected),
        /// A torque that the motor gets on top of the drive's, for each step, in N m; none beyond its end. A measurement of the
        /// loop sets it. It has no key, and it acts on a simulated plant only.
        #[serde(skip)]
        pub excitation_nm: Arc<[f32]> = skipped(|_| Arc::default()),
        /// What the drive's defaults have to equal.
        #[serde(skip)]
        nominal: Nominal = skipped(|_| Nominal::default()),
    }
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
        let known = || Self::keys_with(plants);
        let (tree, errors) = overrides::read_tree(&name.into(), text, overrides, &known)?;
        Self::from_tree(name, tree, errors, !overrides.is_empty(), plants, &GivenTables::new())
    }

    /// Reads a document. `errors` are those found before; `is_overridden` means that values differ from the file.
    fn from_tree(
        name: &str,
        tree: Table,
        mut errors: Vec<ScenarioError>,
        is_overridden: bool,
        plants: &Plants,
        given: &GivenTables,
    ) -> Result<Self, ScenarioErrors> {
        let directory = Path::new(name).parent().unwrap_or(Path::new(""));
        let start = Origin::File { file: name.into(), line: 1, column: 1 };
        let with = ReadWith { name, plants, tables: Tables { directory, given } };
        let document = reader::read_document(&tree, start, |root| {
            let scenario = Self::read(root, with);
            scenario.check(root, plants);
            scenario
        });
        let mut scenario = document.result;
        errors.extend(document.errors);
        if errors.is_empty() {
            let facts = Facts {
                tree: &tree,
                numbers: &document.numbers,
                reference: &scenario.reference,
                parameters: &scenario.controller.parameters,
                is_overridden,
            };
            errors = traps::check(&facts, &scenario.meant);
            errors.extend(expectation::unmeasurable(&scenario.planned_run(), None));
            scenario.nominal = Nominal::new(&facts);
        }
        if errors.is_empty() { Ok(scenario) } else { Err(ScenarioErrors::new(errors)) }
    }

    /// Reports what sections rule out in others.
    fn check(&self, root: &Section<'_>, plants: &Plants) {
        if !self.run.mode.is_hil() {
            bench::check(root, &self.plant, &self.encoders, &self.line, &self.link);
        }
        for (fault, inside) in self.faults.iter().zip(root.each_inside("fault")) {
            fault.check_run(&inside, &self.plant.model, plants, &self.run);
        }
    }

    /// Compares the plant with the drive's own parameters: ratio, gap and inertias, as far as `[controller.parameters]`
    /// leaves
    /// them to the drive. `default_of` gives the default of the drive's parameter of a name; `None` if the drive, or the
    /// law
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
        let tables = Tables { directory: Path::new(""), given: &GivenTables::new() };
        Section::keys_of(|root| Self::read(root, ReadWith { name: "", plants, tables }))
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
