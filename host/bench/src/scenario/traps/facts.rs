//! Numbers of a scenario that was read, with their places.

use lashloop_plant::reference::Reference;

use crate::scenario::controller::ParameterSetting;
use crate::scenario::error::ScenarioError;
use crate::scenario::reader::Number;
use crate::scenario::tree::Table;

/// What the checks need of a scenario that was read.
pub(in crate::scenario) struct Facts<'a> {
    /// The document.
    pub(in crate::scenario) tree: &'a Table,
    /// The numbers in force.
    pub(in crate::scenario) numbers: &'a [Number],
    pub(in crate::scenario) reference: &'a Reference,
    pub(in crate::scenario) parameters: &'a [ParameterSetting],
    /// Whether options of the command line changed the file.
    pub(in crate::scenario) is_overridden: bool,
}

impl Facts<'_> {
    /// The number in force of a key, such as `plant.initial.load_position_rad`.
    pub(super) fn number(&self, path: &str) -> Option<&Number> {
        self.numbers.iter().find(|number| number.path == path)
    }

    /// An error at a key that isn't a number, if the scenario gives the key.
    pub(super) fn error_at(&self, path: &str, reason: String) -> Option<ScenarioError> {
        Some(ScenarioError::rejected(&self.tree.find(path)?.origin, path, "this file", reason))
    }

    /// All numbers in rad of a section.
    pub(super) fn angles(&self, section: &str) -> impl Iterator<Item = &Number> {
        self.numbers.iter().filter(move |number| {
            number.unit == "rad" && number.path.rsplit_once('.').is_some_and(|(inside, _)| inside == section)
        })
    }
}

impl Number {
    pub(super) fn error(&self, reason: String) -> ScenarioError {
        let found =
            if self.is_given { format!("{}", self.value) } else { format!("the default of {}", self.value) };
        ScenarioError::rejected(&self.origin, &self.path, found, reason)
    }
}
