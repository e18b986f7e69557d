//! The scenario of an FMU: resolved, as the file `scenario.toml` of its resources.

use std::fs;
use std::path::{Path, PathBuf};

use lashloop::Bench;
use lashloop_bench::run::digest::sha256;
use lashloop_bench::scenario::{Override, Scenario, unit};
use toml_edit::{DocumentMut, Item, Table, Value as Toml};

use crate::description::Version;
use crate::error::ExportError;
use crate::part::Part;
use crate::variable::{Role, Value, Variable};

pub(crate) const SCENARIO: &str = "scenario.toml";
/// The table of the reference, if it has one.
pub(crate) const TABLE: &str = "reference.csv";
/// Which half of the loop the FMU is, and for which FMI: `plant 2.0`.
pub(crate) const PART: &str = "part.txt";
/// An importer sets parameters for reasons of its own, so that no value is a likely mistake, and nothing is judged.
const NO_JUDGEMENT: [&str; 2] = [r#"meant=["start", "mismatch", "large-angle"]"#, "expect=[]"];
/// Characters of the token, which ties description and resources together.
const TOKEN: usize = 32;

/// The scenario of an FMU.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Source {
    pub(crate) part: Part,
    version: Version,
    /// The scenario in TOML with every default.
    pub(crate) text: String,
    /// The table of its reference.
    pub(crate) table: Option<Vec<u8>>,
    /// Where the files are, for the reader of the scenario.
    folder: PathBuf,
}

impl Source {
    /// The source for a scenario that was read.
    pub(crate) fn of(scenario: &Scenario, part: Part, version: Version) -> Result<Self, ExportError> {
        let text = scenario.to_toml().map_err(|error| ExportError::Damaged(error.to_string()))?;
        Ok(Self { part, version, text, table: None, folder: PathBuf::new() })
    }

    /// The source as it is in the resources, with the table of the reference.
    pub(crate) fn packed(self) -> Result<Self, ExportError> {
        let mut document: DocumentMut = self.text.parse().unwrap_or_default();
        let file = document.get("reference").and_then(|it| it.get("file")).and_then(Item::as_str);
        let Some(file) = file else { return Ok(self) };
        let table = Some(read(Path::new(file))?);
        document["reference"]["file"] = TABLE.into();
        Ok(Self { text: document.to_string(), table, ..self })
    }

    /// The source in the resources of an unpacked FMU.
    pub(crate) fn in_resources(folder: &Path) -> Result<Self, ExportError> {
        let text = |name: &str| {
            let bytes = read(&folder.join(name))?;
            String::from_utf8(bytes).map_err(|error| ExportError::Damaged(format!("{name}: {error}")))
        };
        let named = text(PART)?;
        let words = named.split_once(' ');
        let known = words.and_then(|(part, version)| Some((Part::named(part)?, Version::named(version)?)));
        let (part, version) = known.ok_or_else(|| ExportError::Damaged(format!("{PART} has {named:?}")))?;
        let table = folder.join(TABLE);
        let table = table.is_file().then(|| read(&table)).transpose()?;
        Ok(Self { part, version, text: text(SCENARIO)?, table, folder: folder.to_owned() })
    }

    /// The content of [`PART`].
    pub(crate) fn kind(&self) -> String {
        format!("{} {}", self.part.name(), self.version.name())
    }

    /// What description and library agree on: the same scenario, part and versions. Importers take FMUs with one token for the
    /// same, and may unpack only one of them.
    pub(crate) fn token(&self) -> String {
        let table = self.table.as_deref().map(sha256).unwrap_or_default();
        let all = format!("{}\n{}\n{table}\n{}", env!("CARGO_PKG_VERSION"), self.kind(), self.text);
        sha256(all.as_bytes())[..TOKEN].to_owned()
    }

    /// The scenario with changed values: `plant.dead_zone_rad=0.2`.
    pub(crate) fn scenario(&self, changes: &[String]) -> Result<Scenario, ExportError> {
        let changes = changes.iter().map(String::as_str).chain(NO_JUDGEMENT);
        let overrides: Vec<_> = changes.map(|change| Override::Set(change.to_owned())).collect();
        let name = self.folder.join(SCENARIO);
        let plants = Bench::new().plants();
        Ok(Scenario::from_str_with(&name.to_string_lossy(), &self.text, &overrides, &plants)?)
    }

    /// The single values of these sections as parameters, named by their keys, without those in `fixed`.
    pub(crate) fn parameters(&self, sections: &[&str], fixed: &[&str]) -> Vec<Variable> {
        let mut parameters = Vec::new();
        let document: DocumentMut = self.text.parse().unwrap_or_default();
        for section in sections {
            let found = section.split('.').try_fold(document.as_item(), |item, name| item.get(name));
            match found {
                Some(Item::Table(table)) => collect(table, section, fixed, &mut parameters),
                Some(Item::Value(value)) => parameters.extend(parameter(section, value)),
                _ => {}
            }
        }
        parameters
    }
}

fn read(path: &Path) -> Result<Vec<u8>, ExportError> {
    fs::read(path).map_err(|source| ExportError::File { path: path.to_owned(), source })
}

fn collect(table: &Table, section: &str, fixed: &[&str], parameters: &mut Vec<Variable>) {
    for (name, item) in table {
        let key = format!("{section}.{name}");
        match item {
            Item::Table(inside) => collect(inside, &key, fixed, parameters),
            Item::Value(value) if !fixed.contains(&&*key) => parameters.extend(parameter(&key, value)),
            _ => {}
        }
    }
}

/// A parameter for a value; `None` for a list, and for a number that FMI 2.0 can't hold.
fn parameter(key: &str, value: &Toml) -> Option<Variable> {
    let start = match value {
        Toml::Float(number) => Value::Real(*number.value()),
        Toml::Integer(number) => Value::Integer((*number.value()).try_into().ok()?),
        Toml::Boolean(is_on) => Value::Boolean(*is_on.value()),
        Toml::String(text) => Value::Text(text.value().clone()),
        _ => return None,
    };
    let unit = unit::of(key.rsplit('.').next().unwrap_or(key));
    Some(Variable::new(Role::Parameter, key, unit, start, ""))
}

/// A value as TOML.
pub(crate) fn spelled(value: &Value) -> String {
    match value {
        Value::Real(number) => Toml::from(*number).to_string(),
        Value::Integer(number) => number.to_string(),
        Value::Boolean(is_on) => is_on.to_string(),
        Value::Text(text) => Toml::from(text.as_str()).to_string(),
    }
}
