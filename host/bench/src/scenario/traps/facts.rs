//! Numbers of a scenario that was read, with their places.

use lashloop_plant::reference::Reference;

use crate::scenario::controller::ParameterSetting;
use crate::scenario::error::ScenarioError;
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
use crate::scenario::reader::SectionKeys;

/// What the checks need of a scenario that was read.
pub(in crate::scenario) struct Facts<'a> {
    pub(in crate::scenario) keys: &'a SectionKeys,
    pub(in crate::scenario) reference: &'a Reference,
    pub(in crate::scenario) parameters: &'a [ParameterSetting],
    /// Whether options of the command line changed the file.
    pub(in crate::scenario) is_overridden: bool,
}

/// A number of a section and its place in the file.
#[derive(Debug, Clone)]
pub(super) struct Number {
    /// The whole path of the key.
    pub(super) path: String,
    pub(super) value: f64,
    /// Where the key is given; for a default, where its section begins.
    origin: Origin,
    pub(super) is_given: bool,
}

impl Facts<'_> {
    /// The section of a path such as `plant.initial`.
    fn section(&self, path: &str) -> Option<&SectionKeys> {
        path.split('.').try_fold(self.keys, |section, step| {
            section.keys.iter().find(|known| known.key.name == step)?.inside.as_ref()
        })
    }

    /// The number in force of a key, such as `plant.initial.load_position_rad`.
    pub(super) fn number(&self, path: &str) -> Option<Number> {
        let (sections, name) = path.rsplit_once('.')?;
        let section = self.section(sections)?;
        let known = section.keys.iter().find(|known| known.key.name == name)?;
        Some(Number {
            path: path.to_owned(),
            value: known.number?,
            origin: known.origin.clone().unwrap_or_else(|| section.origin.clone()),
            is_given: known.origin.is_some(),
        })
    }

    /// An error at a key that is no number, if the scenario gives the key.
    pub(super) fn error_at(&self, path: &str, reason: String) -> Option<ScenarioError> {
        let (section, name) = path.rsplit_once('.')?;
        let section = self.section(section)?;
        let known = section.keys.iter().find(|known| known.key.name == name)?;
        let error = KeyError::Rejected { found: "this file".to_owned(), reason };
        Some(ScenarioError::Key {
            origin: known.origin.clone()?,
            key: path.to_owned(),
            error: Box::new(error),
        })
    }

    /// All numbers in rad of a section.
    pub(super) fn angles(&self, path: &str) -> Vec<Number> {
        let section = self.section(path);
        let names =
            section.into_iter().flat_map(|section| &section.keys).filter(|known| known.key.unit == "rad");
        names.filter_map(|known| self.number(&format!("{path}.{}", known.key.name))).collect()
    }
}

impl Number {
    pub(super) fn error(&self, reason: String) -> ScenarioError {
        let found =
            if self.is_given { format!("{}", self.value) } else { format!("the default of {}", self.value) };
        ScenarioError::Key {
            origin: self.origin.clone(),
            key: self.path.clone(),
            error: Box::new(KeyError::Rejected { found, reason }),
        }
    }
}
