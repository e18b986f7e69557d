//! The cases of a scenario file: one, or those of its sweep.

use std::path::Path;
use std::sync::Arc;

use lashloop_plant::Plants;

use super::declare::{Field, section};
use super::error::{ScenarioError, ScenarioErrors};
use super::origin::Origin;
use super::overrides::{Override, place, read_tree};
use super::reader::read_document;
use super::sweep::{Setting, Sweep};
use super::tables::GivenTables;
use super::tree::Table;
use super::{Scenario, file};

/// A scenario file whose cases can be read one by one.
#[derive(Debug, Clone)]
pub struct Cases {
    name: String,
    /// The document without its sweep.
    tree: Table,
    is_overridden: bool,
    settings: Vec<Vec<Setting>>,
    plants: Plants,
    given: GivenTables,
}

impl Cases {
    /// Reads a file, applies `overrides` in their order, and expands its sweep.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML, or its sweep has errors; all at once. A scenario without a sweep is read by
    /// [`scenario`](Self::scenario).
    pub fn from_file(path: &Path, overrides: &[Override], plants: &Plants) -> Result<Self, ScenarioErrors> {
        let text = file::read(path, "scenario")?;
        Self::from_str(&path.to_string_lossy(), &text, overrides, plants)
    }

    /// As [`from_file`](Self::from_file), of a text. `name` is the file's name in errors.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file), except for reading the file.
    pub fn from_str(
        name: &str,
        text: &str,
        overrides: &[Override],
        plants: &Plants,
    ) -> Result<Self, ScenarioErrors> {
        let file: Arc<str> = name.into();
        let known = || Scenario::keys_with(plants);
        let (mut tree, mut errors) = read_tree(&file, text, overrides, &known)?;
        let settings = match tree.remove("sweep") {
            None => vec![Vec::new()],
            Some(node) => {
                let mut alone = Table::default();
                alone.insert("sweep", node);
                let start = Origin::File { file, line: 1, column: 1 };
                let sweep = section(Sweep::checked);
                let document = read_document(&alone, start, |root| sweep.read("sweep", "", root));
                errors.extend(document.errors);
                if errors.is_empty() { document.result.cases() } else { Vec::new() }
            }
        };
        errors
            .extend(settings.first().into_iter().flatten().filter_map(|setting| given_twice(&tree, setting)));
        if !errors.is_empty() {
            return Err(errors.into());
        }
        let is_overridden = !overrides.is_empty();
        Ok(Self {
            name: name.to_owned(),
            tree,
            is_overridden,
            settings,
            plants: plants.clone(),
            given: GivenTables::new(),
        })
    }

    /// The same cases with these tables instead of their files.
    #[must_use]
    pub fn with_tables(self, given: GivenTables) -> Self {
        Self { given, ..self }
    }

    /// The settings of each case, in their order; none in the case of a scenario without a sweep.
    #[must_use]
    pub fn settings(&self) -> &[Vec<Setting>] {
        &self.settings
    }

    /// The scenario of a case, with its settings in force.
    ///
    /// # Errors
    /// Keys are unknown, missing or out of range; all errors at once.
    pub fn scenario(&self, case: &[Setting]) -> Result<Scenario, ScenarioErrors> {
        let mut tree = self.tree.clone();
        let mut errors = Vec::new();
        for Setting { key, node } in case {
            if let Err(reason) = place(&mut tree, key, node.clone()) {
                errors.push(ScenarioError::rejected(&node.origin, key, &node.value, reason));
            }
        }
        let is_overridden = self.is_overridden || !case.is_empty();
        Scenario::from_tree(&self.name, tree, errors, is_overridden, &self.plants, &self.given)
    }
}

impl Cases {
    /// The scenario with these overrides in force, in addition to those of the file; its sweep is left out.
    ///
    /// # Errors
    /// Keys are unknown, missing or out of range, or an override can't be applied; all errors at once.
    pub fn scenario_with(&self, overrides: &[Override]) -> Result<Scenario, ScenarioErrors> {
        let mut tree = self.tree.clone();
        let known = || Scenario::keys_with(&self.plants);
        let errors = overrides.iter().filter_map(|it| it.apply(&mut tree, &known).err()).collect();
        let is_overridden = self.is_overridden || !overrides.is_empty();
        Scenario::from_tree(&self.name, tree, errors, is_overridden, &self.plants, &self.given)
    }
}

/// The error of a key that the command line sets and the sweep varies.
fn given_twice(tree: &Table, Setting { key, node }: &Setting) -> Option<ScenarioError> {
    let option = tree.find(key)?.origin.replacement()?;
    let reason = "sets a key that [sweep] varies; remove one";
    Some(ScenarioError::rejected(&node.origin, key, option, reason))
}
