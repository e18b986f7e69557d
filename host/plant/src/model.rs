//! Models of plants: registered values with a name, keys and a way to build the plant.

use std::fmt;
use std::sync::Arc;

use crate::{Key, Plant, PlantError, PlantValues, Release};

type Build = dyn Fn(&Release<'_>) -> Result<Box<dyn Plant>, PlantError> + Send + Sync;

/// What a run may change in a plant. The default is nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Changes {
    /// Whether the plant takes wear and load torque by [`Plant::set_environment`]. Its scenarios then have the sections
    /// `[plant.wear]` and `[plant.load_torque]`, and the faults `gap-growth` and `load-torque`.
    pub environment: bool,
    /// Keys that the fault `stiffness-drop` scales; none if the plant does not take it.
    pub stiffness: &'static [&'static str],
    /// Keys that the fault `friction-change` scales; none if the plant does not take it.
    pub friction: &'static [&'static str],
}

/// A model of a plant. A scenario chooses it by `plant.model` and gives its keys in `[plant]`.
#[derive(Clone)]
pub struct PlantModel {
    name: &'static str,
    summary: &'static str,
    keys: Vec<Key>,
    changes: Changes,
    build: Arc<Build>,
}

impl PlantModel {
    /// A model. `summary` is one sentence for documents, `build` makes a plant from values that lie in the ranges of `keys`.
    pub fn new(
        name: &'static str,
        summary: &'static str,
        keys: Vec<Key>,
        build: impl Fn(&Release<'_>) -> Result<Box<dyn Plant>, PlantError> + Send + Sync + 'static,
    ) -> Self {
        Self { name, summary, keys, changes: Changes::default(), build: Arc::new(build) }
    }

    /// The same model of plants that change during a run.
    #[must_use]
    pub fn with_changes(self, changes: Changes) -> Self {
        Self { changes, ..self }
    }

    /// Name in scenarios, in lower case with hyphens.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// One sentence for documents.
    #[must_use]
    pub fn summary(&self) -> &'static str {
        self.summary
    }

    /// Keys in `[plant]`, in the order of documents and records.
    #[must_use]
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// What a run may change.
    #[must_use]
    pub fn changes(&self) -> &Changes {
        &self.changes
    }

    /// The values of a scenario that gives no key: every default.
    #[must_use]
    pub fn defaults(&self) -> PlantValues {
        let mut values = PlantValues::default();
        for key in &self.keys {
            if let Some(value) = key.default_value() {
                values.insert(key.name, value);
            }
        }
        values
    }

    /// A plant of this model.
    ///
    /// # Errors
    /// A value is outside its range, a required one is missing, or the plant can't be built from them.
    pub fn release(&self, release: &Release<'_>) -> Result<Box<dyn Plant>, PlantError> {
        for key in &self.keys {
            if let Some(value) = release.values.get(key.name) {
                key.check(value)?;
            }
        }
        (self.build)(release)
    }
}

impl fmt::Debug for PlantModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("PlantModel").field(&self.name).finish()
    }
}

impl PartialEq for PlantModel {
    /// Models are equal if they have one name: a registry has each name once.
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
