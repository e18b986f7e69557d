//! A section of the document while it is read.

use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

use super::unknown::Known;
use crate::scenario::error::ScenarioError;
use crate::scenario::key::{Further, Key, KeyKind, Keys};
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
use crate::scenario::spelling::spell_key;
use crate::scenario::tree::{Node, Table, Value};

/// A section that is being read, or described: a described one is absent, and each look-up adds its key.
pub struct Section<'a> {
    path: String,
    /// Where the section begins.
    pub(in crate::scenario) origin: Origin,
    table: Option<&'a Table>,
    /// Names and units of the keys that were read.
    known: Vec<(&'static str, &'static str)>,
    /// Required keys that are absent, and what each must be.
    missing: Vec<(&'static str, String)>,
    accepts_the_rest: bool,
    /// What a described section has; `None` for one that is only read.
    pub(in crate::scenario) keys: Option<Keys>,
    findings: &'a Findings,
}

/// What a document has.
#[derive(Default)]
struct Findings {
    errors: RefCell<Vec<ScenarioError>>,
    numbers: RefCell<Vec<Number>>,
}

/// A number in force, given or by default.
#[derive(Debug, Clone)]
pub struct Number {
    /// The whole path of the key.
    pub(in crate::scenario) path: String,
    pub(in crate::scenario) unit: &'static str,
    pub(in crate::scenario) value: f64,
    /// Where the key is given; for a default, where its section begins.
    pub(in crate::scenario) origin: Origin,
    pub(in crate::scenario) is_given: bool,
}

/// A document that was read.
pub(in crate::scenario) struct Document<T> {
    /// The result; with stand-ins for faulty values if there are errors.
    pub(in crate::scenario) result: T,
    /// The numbers in force.
    pub(in crate::scenario) numbers: Vec<Number>,
    /// Everything that is wrong.
    pub(in crate::scenario) errors: Vec<ScenarioError>,
}

/// Reads a document with the keys that `read` looks up.
pub(in crate::scenario) fn read_document<T>(
    table: &Table,
    start: Origin,
    read: impl Fn(&mut Section<'_>) -> T,
) -> Document<T> {
    let findings = Findings::default();
    let result = Section::new(String::new(), start, Some(table), &findings).read(&read);
    let Findings { errors, numbers } = findings;
    Document { result, numbers: numbers.into_inner(), errors: errors.into_inner() }
}

impl<'a> Section<'a> {
    fn new(path: String, origin: Origin, table: Option<&'a Table>, findings: &'a Findings) -> Self {
        let (known, missing) = (Vec::new(), Vec::new());
        Self { path, origin, table, known, missing, accepts_the_rest: false, keys: None, findings }
    }

    /// The keys that `read` looks up.
    pub fn keys_of<T>(read: impl FnOnce(&mut Section<'_>) -> T) -> Keys {
        let findings = Findings::default();
        let mut section = Section::new(String::new(), Origin::Option(Arc::from("")), None, &findings);
        section.keys = Some(Keys::default());
        read(&mut section);
        section.keys.unwrap_or_default()
    }

    /// Adds to the keys of a section that is being described.
    pub(in crate::scenario) fn describe(&mut self, add: impl FnOnce(&mut Keys)) {
        if let Some(keys) = &mut self.keys {
            add(keys);
        }
    }

    fn describe_section(&mut self, name: &'static str, doc: &'static str, kind: impl FnOnce() -> KeyKind) {
        self.describe(|keys| {
            keys.keys.push(Key { name, doc, unit: "", required: false, default: None, kind: kind() });
        });
    }

    /// Reads this section, then reports missing and unknown keys.
    fn read<T>(mut self, read: &impl Fn(&mut Section<'_>) -> T) -> T {
        let result = read(&mut self);
        self.finish(read);
        result
    }

    /// A section inside this one, with the keys that `read` looks up. An absent section reads as its defaults.
    pub(in crate::scenario) fn section<T>(
        &mut self,
        key: &'static str,
        doc: &'static str,
        read: &impl Fn(&mut Section<'_>) -> T,
    ) -> T {
        self.describe_section(key, doc, || KeyKind::Section(Self::keys_of(read)));
        let path = self.path_of(key);
        let Some(node) = self.look_up(key, "", || None) else {
            return Section::new(path, self.origin.clone(), None, self.findings).read(read);
        };
        if let Some(table) = node.table() {
            return Section::new(path, node.origin.clone(), Some(table), self.findings).read(read);
        }
        if matches!(&node.value, Value::Array(items) if items.iter().all(|item| item.table().is_some())) {
            self.reject(key, format!("is a list; there is one section, so write [{path}]"));
        } else {
            self.wrong_type(key, node, format!("a section [{path}]"));
        }
        let ignored = Findings::default();
        Section::new(path, node.origin.clone(), None, &ignored).read(read)
    }

    /// The sections of a list `[[key]]`. An absent list is empty.
    pub(in crate::scenario) fn sections<T>(
        &mut self,
        key: &'static str,
        doc: &'static str,
        read: &impl Fn(&mut Section<'_>) -> T,
    ) -> Vec<T> {
        self.describe_section(key, doc, || KeyKind::Sections(Self::keys_of(read)));
        let Some(node) = self.look_up(key, "", || None) else {
            return Vec::new();
        };
        let Value::Array(items) = &node.value else {
            if node.table().is_some() {
                self.reject(
                    key,
                    format!("is one section; there can be several, so write [[{}]]", self.list(key)),
                );
            } else {
                self.wrong_type(key, node, format!("a list of sections [[{}]]", self.list(key)));
            }
            return Vec::new();
        };
        let mut sections = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let name = format!("{key}.{index}");
            let Some(table) = item.table() else {
                self.wrong_type(&name, item, format!("a section [[{}]]", self.list(key)));
                continue;
            };
            let section = Section::new(self.path_of(&name), item.origin.clone(), Some(table), self.findings);
            sections.push(section.read(read));
        }
        sections
    }

    /// The sections of a list that was read, to be checked once more.
    pub(in crate::scenario) fn each_inside(&self, key: &str) -> impl Iterator<Item = Section<'a>> {
        let items = self.node(key).map_or(&[][..], Node::items).iter().enumerate();
        items.filter_map(move |(index, item)| {
            let path = self.path_of(&format!("{key}.{index}"));
            Some(Section::new(path, item.origin.clone(), Some(item.table()?), self.findings))
        })
    }

    /// All keys of this section with their values, for a section whose keys are declared elsewhere.
    pub(in crate::scenario) fn all(&self) -> impl Iterator<Item = (&'a str, &'a Node)> + use<'a> {
        self.table.into_iter().flat_map(Table::iter)
    }

    /// Accepts unknown keys, because the key that decides on them is faulty itself.
    pub(in crate::scenario) fn accept_the_rest(&mut self) {
        self.accepts_the_rest = true;
    }

    /// Attributes missing keys to the option that set `key`, if an option did: it is the option that chose a profile that has
    /// to be completed, not the section of the file.
    pub(in crate::scenario) fn attribute_to_option(&mut self, key: &str) {
        if let Some(node) = self.node(key).filter(|node| node.origin.replacement().is_some()) {
            self.origin = node.origin.clone();
        }
    }

    /// Whether an option set this key. Of two keys that contradict each other, that one is to be corrected.
    #[must_use]
    pub fn is_option(&self, key: &str) -> bool {
        self.node(key).is_some_and(|node| node.origin.replacement().is_some())
    }

    /// Reports a value that contradicts others. `reason` continues the sentence after the value.
    pub fn reject(&self, key: &str, reason: impl Into<String>) {
        if let Some(node) = self.node(key) {
            self.error(key, node, KeyError::rejected(&node.value, reason));
        }
    }

    /// Reports a section whose keys contradict each other.
    pub fn reject_section(&self, reason: impl Into<String>) {
        self.reject_all("this section".to_owned(), reason);
    }

    /// Reports the section. `reason` continues the sentence after `found`.
    pub(in crate::scenario) fn reject_all(&self, found: String, reason: impl Into<String>) {
        self.push(self.path.clone(), self.origin.clone(), KeyError::rejected(found, reason));
    }

    /// Reports an error of the value of `key`.
    pub(in crate::scenario) fn error(&self, key: &str, node: &Node, error: KeyError) {
        self.push(self.path_of(key), node.origin.clone(), error);
    }

    /// The value at a key or a path, if the file gives one.
    pub(in crate::scenario) fn node(&self, path: &str) -> Option<&'a Node> {
        self.table.and_then(|table| table.find(path))
    }

    /// The text of a key, if the file gives one.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<&'a str> {
        self.node(key).and_then(Node::text)
    }

    /// Whether the file gives a key.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.node(key).is_some()
    }

    /// Whether the scenario has the section.
    pub(in crate::scenario) fn is_given(&self) -> bool {
        self.table.is_some()
    }

    /// Where a key is written; for an absent one, where the section begins.
    pub(in crate::scenario) fn origin_of(&self, key: &str) -> Origin {
        self.node(key).map_or(&self.origin, |node| &node.origin).clone()
    }

    pub(in crate::scenario) fn wrong_type(&self, key: &str, node: &Node, allowed: impl Into<String>) {
        let (found, kind) = (node.value.to_string(), node.value.kind());
        self.error(key, node, KeyError::WrongType { found, kind, allowed: allowed.into() });
    }

    /// The value of a key, from now on a known one. `allowed` is what a required key must be.
    pub(in crate::scenario) fn look_up(
        &mut self,
        name: &'static str,
        unit: &'static str,
        allowed: impl FnOnce() -> Option<String>,
    ) -> Option<&'a Node> {
        self.known.push((name, unit));
        let node = self.node(name);
        if node.is_none() {
            self.missing.extend(allowed().map(|allowed| (name, allowed)));
        }
        node
    }

    /// Records the number in force.
    pub(in crate::scenario) fn in_force(&self, name: &'static str, unit: &'static str, value: f64) {
        let (path, origin) = (self.path_of(name), self.origin_of(name));
        self.findings.numbers.borrow_mut().push(Number {
            path,
            unit,
            value,
            origin,
            is_given: self.has(name),
        });
    }

    fn finish<T>(mut self, read: &impl Fn(&mut Section<'_>) -> T) {
        let declared = OnceCell::new();
        for (name, node) in self.table.into_iter().flat_map(Table::iter) {
            if self.accepts_the_rest || self.known.iter().any(|(known, _)| *known == name) {
                continue;
            }
            let declared = declared.get_or_init(|| Self::keys_of(read));
            let (keys, given) = (&self.known, |key: &str| self.node(key));
            if declared.further != Further::Rejected {
                break;
            }
            let known = Known { keys, declared, given: &given };
            let (error, meant) = known.explain(name, &node.value);
            self.error(&spell_key(name), node, error);
            // A key under a wrong name is reported once, and not also as missing; so is a section with all its keys.
            if let Some(meant) = meant {
                self.known.retain(|(known, _)| *known != meant);
                self.missing.retain(|(name, _)| *name != meant);
                let inside = format!("{}.", self.path_of(meant));
                self.findings.errors.borrow_mut().retain(|error| !error.is_missing_inside(&inside));
            }
        }
        for (name, allowed) in std::mem::take(&mut self.missing) {
            self.push(self.path_of(name), self.origin.clone(), KeyError::Missing { allowed });
        }
    }

    fn push(&self, key: String, origin: Origin, error: KeyError) {
        self.findings.errors.borrow_mut().push(ScenarioError::Key { origin, key, error: Box::new(error) });
    }

    /// The head of a list's sections, as a file has it.
    fn list(&self, key: &str) -> String {
        let path = self.path_of(key);
        let names: Vec<_> = path.split('.').filter(|name| name.parse::<usize>().is_err()).collect();
        names.join(".")
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }
}
