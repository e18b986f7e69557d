//! A section of the document while it is read.

use std::cell::RefCell;

use super::schema::{Elsewhere, KnownKey, Schema, SectionKeys};
use crate::scenario::error::ScenarioError;
use crate::scenario::key::{Choice, Further, Key, KeyKind, Keys};
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
use crate::scenario::spelling::spell_key;
use crate::scenario::tree::{Node, Table, Value};
use crate::scenario::unit;

/// A section that is being read.
pub struct Section<'a> {
    path: String,
    origin: Origin,
    table: Option<&'a Table>,
    schema: Schema,
    next_doc: String,
    next_unit: Option<&'static str>,
    next_choices: Vec<Choice>,
    accepts_the_rest: bool,
    further: Further,
    errors: &'a RefCell<Vec<ScenarioError>>,
}

/// A document that was read.
pub(in crate::scenario) struct Document<T> {
    /// The result; with stand-ins for faulty values if there are errors.
    pub(in crate::scenario) result: T,
    /// The keys that were declared.
    pub(in crate::scenario) keys: SectionKeys,
    /// Everything that is wrong.
    pub(in crate::scenario) errors: Vec<ScenarioError>,
}

/// Reads a document.
pub(in crate::scenario) fn read_document<T>(
    table: &Table,
    start: Origin,
    read: impl FnOnce(&mut Section<'_>) -> T,
) -> Document<T> {
    let errors = RefCell::new(Vec::new());
    let (result, keys) = Section::new(String::new(), start, Some(table), &errors).read(read);
    Document { result, keys, errors: errors.into_inner() }
}

impl<'a> Section<'a> {
    fn new(
        path: String,
        origin: Origin,
        table: Option<&'a Table>,
        errors: &'a RefCell<Vec<ScenarioError>>,
    ) -> Self {
        Self {
            path,
            origin,
            table,
            schema: Schema::default(),
            next_doc: String::new(),
            next_unit: None,
            next_choices: Vec::new(),
            accepts_the_rest: false,
            further: Further::Rejected,
            errors,
        }
    }

    /// Reads this section, then reports missing and unknown keys.
    fn read<T>(mut self, read: impl FnOnce(&mut Self) -> T) -> (T, SectionKeys) {
        let result = read(&mut self);
        (result, self.finish())
    }

    /// Meaning of the key that is declared next: one paragraph of Markdown without unit, range and default, which the
    /// declaration gives.
    pub fn doc(&mut self, doc: &str) -> &mut Self {
        doc.trim().clone_into(&mut self.next_doc);
        self
    }

    /// Unit of the number that is declared next, for a key whose name does not end with a unit of ours.
    pub fn unit(&mut self, unit: &'static str) -> &mut Self {
        self.next_unit = Some(unit);
        self
    }

    /// The unit of a key that is being declared.
    pub(super) fn unit_of(&mut self, key: &str) -> &'static str {
        self.next_unit.take().unwrap_or_else(|| unit::of(key))
    }

    /// Meanings of the names that the choice declared next takes.
    pub fn choice_docs(&mut self, choices: Vec<Choice>) -> &mut Self {
        self.next_choices = choices;
        self
    }

    /// A section inside this one. An absent section reads as its defaults.
    pub fn section<T>(&mut self, key: &'static str, read: impl FnOnce(&mut Section<'_>) -> T) -> T {
        let path = self.path_of(key);
        let (result, keys) = match self.look_up(key, "", KeyKind::Section(Keys::default()), None) {
            None => Section::new(path, self.origin.clone(), None, self.errors).read(read),
            Some(Node { origin, value: Value::Table(table) }) => {
                Section::new(path, origin.clone(), Some(table), self.errors).read(read)
            }
            Some(node) => {
                if matches!(&node.value, Value::Array(items) if items.iter().all(Node::is_table)) {
                    let reason = format!("is a list; there is one section, so write [{path}]");
                    self.reject(key, reason);
                } else {
                    self.wrong_type(key, node, format!("a section [{path}]"));
                }
                let ignored = RefCell::new(Vec::new());
                Section::new(path, node.origin.clone(), None, &ignored).read(read)
            }
        };
        self.schema.entry(key).inside = Some(keys);
        result
    }

    /// The sections of a list `[[key]]`. An absent list is empty.
    pub fn sections<T>(&mut self, key: &'static str, mut read: impl FnMut(&mut Section<'_>) -> T) -> Vec<T> {
        let Some(node) = self.look_up(key, "", KeyKind::Sections(Keys::default()), None) else {
            return Vec::new();
        };
        let Value::Array(items) = &node.value else {
            if node.is_table() {
                self.reject(key, format!("is one section; there can be several, so write [[{key}]]"));
            } else {
                self.wrong_type(key, node, format!("a list of sections [[{key}]]"));
            }
            return Vec::new();
        };
        let mut sections = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let path = format!("{}.{index}", self.path_of(key));
            let Value::Table(table) = &item.value else {
                self.wrong_type(&format!("{key}.{index}"), item, format!("a section [[{key}]]"));
                continue;
            };
            let section = Section::new(path, item.origin.clone(), Some(table), self.errors);
            let (result, keys) = section.read(&mut read);
            self.schema.entry(key).inside.get_or_insert(keys);
            sections.push(result);
        }
        sections
    }

    /// All keys of this section with their values, for a section whose keys are declared elsewhere.
    pub(in crate::scenario) fn all(
        &mut self,
        further: Further,
    ) -> impl Iterator<Item = (&'a str, &'a Node)> + use<'a> {
        self.accepts_the_rest = true;
        self.further = further;
        self.table.into_iter().flat_map(Table::iter)
    }

    /// Accepts unknown keys, because the key that decides on them is faulty itself.
    pub fn accept_the_rest(&mut self) {
        self.accepts_the_rest = true;
    }

    /// Declares the keys that `read` would read if the value of `key` were `owner` and not `chosen`.
    pub fn belongs_to<T>(
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
            Some(origin) => origin.replacement(),
            None => None,
        };
        let chooser = chooser.unwrap_or_else(|| "the scenario".to_owned());
        self.schema.elsewhere.push(Elsewhere {
            owner: format!("{key} = \"{owner}\""),
            chosen: format!("{chooser} chooses {key} = \"{chosen}\""),
            keys: section.schema.known.iter().map(|known| known.key.name).collect(),
        });
    }

    /// Declares symbols of the paper, each with its key.
    pub fn symbols(&mut self, symbols: &'static [(&'static str, &'static str)]) {
        self.schema.symbols = symbols;
    }

    /// Attributes missing keys to the option that set `key`, if an option did: it is the option that chose a profile that has
    /// to be completed, not the section of the file.
    pub fn attribute_to_option(&mut self, key: &str) {
        if let Some(node) = self.node(key).filter(|node| node.origin.replacement().is_some()) {
            self.origin = node.origin.clone();
        }
    }

    /// Whether an option set this key. Of two keys that contradict each other, that one is to be corrected.
    pub fn is_option(&self, key: &str) -> bool {
        self.node(key).is_some_and(|node| node.origin.replacement().is_some())
    }

    /// Reports a value that contradicts others. `reason` continues the sentence after the value.
    pub fn reject(&self, key: &str, reason: String) {
        if let Some(node) = self.node(key) {
            self.error(key, node, KeyError::Rejected { found: node.value.to_string(), reason });
        }
    }

    /// Reports a section whose keys contradict each other.
    pub fn reject_section(&self, reason: &str) {
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

    /// Whether the scenario has the section.
    pub(in crate::scenario) fn is_given(&self) -> bool {
        self.table.is_some()
    }

    /// Where the section begins.
    pub(in crate::scenario) fn origin(&self) -> Origin {
        self.origin.clone()
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
        name: &'static str,
        unit: &'static str,
        kind: KeyKind,
        required: Option<String>,
    ) -> Option<&'a Node> {
        let node = self.node(name);
        let doc = std::mem::take(&mut self.next_doc);
        self.next_unit = None;
        self.schema.known.push(KnownKey {
            key: Key { name, doc, unit, required: required.is_some(), kind },
            missing: required.filter(|_| node.is_none()),
            origin: node.map(|node| node.origin.clone()),
            number: None,
            inside: None,
        });
        node
    }

    /// The names of a choice with their meanings, as far as the choice has any.
    pub(super) fn documented<'b>(&mut self, names: impl Iterator<Item = &'static str> + 'b) -> Vec<Choice> {
        let docs = std::mem::take(&mut self.next_choices);
        let of = |name| docs.iter().find(|choice| choice.name == name).map_or("", |choice| choice.doc);
        names.map(|name| Choice { name, doc: of(name) }).collect()
    }

    /// Records the number in force, and returns it.
    pub(super) fn in_force(&mut self, key: &'static str, number: f64) -> f64 {
        self.schema.entry(key).number = Some(number);
        number
    }

    fn finish(mut self) -> SectionKeys {
        for (name, node) in self.table.into_iter().flat_map(Table::iter) {
            if self.accepts_the_rest || self.schema.knows(name) {
                continue;
            }
            let (error, meant) = self.schema.explain_unknown(name, &node.value);
            self.error(&spell_key(name), node, error);
            // A key under a wrong name is reported once, and not also as missing; so is a section with all its keys.
            if let Some(meant) = meant {
                self.schema.known.retain(|known| known.key.name != meant);
                let inside = format!("{}.", self.path_of(meant));
                self.errors.borrow_mut().retain(|error| !error.is_missing_inside(&inside));
            }
        }
        for KnownKey { key, missing, .. } in &self.schema.known {
            if let Some(allowed) = missing.clone() {
                self.push(self.path_of(key.name), self.origin.clone(), KeyError::Missing { allowed });
            }
        }
        SectionKeys { keys: self.schema.known, further: self.further, origin: self.origin }
    }

    fn push(&self, key: String, origin: Origin, error: KeyError) {
        self.errors.borrow_mut().push(ScenarioError::Key { origin, key, error: Box::new(error) });
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }
}
