//! A section of the document while it is read.

use std::cell::RefCell;

use super::schema::{Elsewhere, KnownKey, Schema};
use crate::scenario::error::ScenarioError;
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
use crate::scenario::spelling::spell_key;
use crate::scenario::tree::{Node, Table, Value};

/// A section that is being read.
pub(in crate::scenario) struct Section<'a> {
    path: String,
    origin: Origin,
    table: Option<&'a Table>,
    schema: Schema,
    accepts_the_rest: bool,
    errors: &'a RefCell<Vec<ScenarioError>>,
}

/// Reads a document, and returns what was read or all of its errors.
pub(in crate::scenario) fn read_document<T>(
    table: &Table,
    start: Origin,
    read: impl FnOnce(&mut Section<'_>) -> T,
) -> Result<T, Vec<ScenarioError>> {
    let errors = RefCell::new(Vec::new());
    let result = Section::new(String::new(), start, Some(table), &errors).read(read);
    let errors = errors.into_inner();
    if errors.is_empty() { Ok(result) } else { Err(errors) }
}

impl<'a> Section<'a> {
    fn new(
        path: String,
        origin: Origin,
        table: Option<&'a Table>,
        errors: &'a RefCell<Vec<ScenarioError>>,
    ) -> Self {
        Self { path, origin, table, schema: Schema::default(), accepts_the_rest: false, errors }
    }

    /// Reads this section, then reports missing and unknown keys.
    fn read<T>(mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let result = read(&mut self);
        self.finish();
        result
    }

    /// A section inside this one. An absent section reads as its defaults.
    pub(in crate::scenario) fn section<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut Section<'_>) -> T,
    ) -> T {
        let path = self.path_of(key);
        match self.look_up(key, "", None) {
            None => Section::new(path, self.origin.clone(), None, self.errors).read(read),
            Some(Node { origin, value: Value::Table(table) }) => {
                Section::new(path, origin.clone(), Some(table), self.errors).read(read)
            }
            Some(node) => {
                self.wrong_type(key, node, format!("a section [{path}]"));
                let ignored = RefCell::new(Vec::new());
                Section::new(path, node.origin.clone(), None, &ignored).read(read)
            }
        }
    }

    /// The sections of a list `[[key]]`. An absent list is empty.
    pub(in crate::scenario) fn sections<T>(
        &mut self,
        key: &'static str,
        mut read: impl FnMut(&mut Section<'_>) -> T,
    ) -> Vec<T> {
        let Some(node) = self.look_up(key, "", None) else {
            return Vec::new();
        };
        let Value::Array(items) = &node.value else {
            self.wrong_type(key, node, format!("a list of sections [[{key}]]"));
            return Vec::new();
        };
        let mut sections = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let path = format!("{}.{index}", self.path_of(key));
            let Value::Table(table) = &item.value else {
                self.wrong_type(&format!("{key}.{index}"), item, format!("a section [[{key}]]"));
                continue;
            };
            sections.push(Section::new(path, item.origin.clone(), Some(table), self.errors).read(&mut read));
        }
        sections
    }

    /// All keys of this section with their values, for a section whose keys are declared elsewhere.
    pub(in crate::scenario) fn all(&mut self) -> impl Iterator<Item = (&'a str, &'a Node)> + use<'a> {
        self.accepts_the_rest = true;
        self.table.into_iter().flat_map(Table::iter)
    }

    /// Accepts unknown keys, because the key that decides on them is faulty itself.
    pub(in crate::scenario) fn accept_the_rest(&mut self) {
        self.accepts_the_rest = true;
    }

    /// Declares the keys that `read` would read if the value of `key` were `owner` and not `chosen`.
    pub(in crate::scenario) fn belongs_to<T>(
        &mut self,
        key: &str,
        owner: &str,
        chosen: &str,
        read: impl FnOnce(&mut Section<'_>) -> T,
    ) {
        let ignored = RefCell::new(Vec::new());
        let mut section = Section::new(String::new(), self.origin.clone(), None, &ignored);
        read(&mut section);
        let chooser = match self.node(key).map(|node| &node.origin) {
            Some(Origin::Option(option)) => option.to_string(),
            _ => "the scenario".to_owned(),
        };
        self.schema.elsewhere.push(Elsewhere {
            owner: format!("{key} = \"{owner}\""),
            chosen: format!("{chooser} chooses {key} = \"{chosen}\""),
            keys: section.schema.known,
        });
    }

    /// Declares symbols of the paper, each with its key.
    pub(in crate::scenario) fn symbols(&mut self, symbols: &'static [(&'static str, &'static str)]) {
        self.schema.symbols = symbols;
    }

    /// Attributes missing keys to the option that set `key`, if an option did: it is the option that chose a profile that has
    /// to be completed, not the section of the file.
    pub(in crate::scenario) fn attribute_to_option(&mut self, key: &str) {
        if let Some(origin @ Origin::Option(_)) = self.node(key).map(|node| &node.origin) {
            self.origin = origin.clone();
        }
    }

    /// Whether an option set this key. Of two keys that contradict each other, that one is to be corrected.
    pub(in crate::scenario) fn is_option(&self, key: &str) -> bool {
        matches!(self.node(key), Some(Node { origin: Origin::Option(_), .. }))
    }

    /// Reports a value that contradicts others. `reason` continues the sentence after the value.
    pub(in crate::scenario) fn reject(&self, key: &str, reason: String) {
        if let Some(node) = self.node(key) {
            self.error(key, node, KeyError::Rejected { found: node.value.to_string(), reason });
        }
    }

    /// Reports a section whose keys contradict each other.
    pub(in crate::scenario) fn reject_section(&self, reason: &str) {
        let error = KeyError::Rejected { found: "this section".to_owned(), reason: reason.to_owned() };
        self.push(self.path.clone(), self.origin.clone(), error);
    }

    /// Reports an error of the value of `key`.
    pub(in crate::scenario) fn error(&self, key: &str, node: &Node, error: KeyError) {
        self.push(self.path_of(key), node.origin.clone(), error);
    }

    /// The value of a key, if the scenario gives one.
    pub(in crate::scenario) fn node(&self, key: &str) -> Option<&'a Node> {
        self.table.and_then(|table| table.get(key))
    }

    /// Where a key is written; for an absent one, where the section begins.
    pub(in crate::scenario) fn origin_of(&self, key: &str) -> Origin {
        self.node(key).map_or(&self.origin, |node| &node.origin).clone()
    }

    pub(super) fn wrong_type(&self, key: &str, node: &Node, allowed: String) {
        let (found, kind) = (node.value.to_string(), node.value.kind());
        self.error(key, node, KeyError::WrongType { found, kind, allowed });
    }

    /// Declares a key and returns its value. `required` is what the key must be, if the scenario has to give it.
    pub(super) fn look_up(
        &mut self,
        key: &'static str,
        unit: &'static str,
        required: Option<String>,
    ) -> Option<&'a Node> {
        let node = self.node(key);
        self.schema.known.push(KnownKey { name: key, unit, missing: required.filter(|_| node.is_none()) });
        node
    }

    fn finish(mut self) {
        for (name, node) in self.table.into_iter().flat_map(Table::iter) {
            if self.accepts_the_rest || self.schema.knows(name) {
                continue;
            }
            let (error, meant) = self.schema.explain_unknown(name, &node.value);
            self.error(&spell_key(name), node, error);
            // A key under a wrong name is reported once, and not also as missing; so is a section with all its keys.
            if let Some(meant) = meant {
                self.schema.known.retain(|key| key.name != meant);
                let inside = format!("{}.", self.path_of(meant));
                self.errors.borrow_mut().retain(|error| !error.is_missing_inside(&inside));
            }
        }
        for KnownKey { name, missing, .. } in &self.schema.known {
            if let Some(allowed) = missing.clone() {
                self.push(self.path_of(name), self.origin.clone(), KeyError::Missing { allowed });
            }
        }
    }

    fn push(&self, key: String, origin: Origin, error: KeyError) {
        self.errors.borrow_mut().push(ScenarioError::Key { origin, key, error: Box::new(error) });
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }
}
