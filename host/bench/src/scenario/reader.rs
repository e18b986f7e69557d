//! Reading one section: each key is stated once, with its unit, default and allowed range.
//!
//! A call such as `plant.number("dead_zone_rad", RADIAN, 0.16, positive(3.2))` is at once the schema and the
//! reading. Faults are collected, not thrown: a faulty key yields a stand-in value, reading goes on, and the
//! scenario is refused at the end with all of its faults. Stand-ins are NaN for numbers, so that comparisons
//! between keys don't report a second fault for the first one's sake.

use std::cell::RefCell;
use std::fmt::Display;
use std::ops::RangeInclusive;

use super::error::{Fault, Origin, ScenarioError, spell_key};
use super::range::{NumberRange, with_unit};
use super::schema::{Elsewhere, KnownKey, Schema};
use super::tree::{Node, Table, Value};
use super::unit;

/// A section that is being read.
pub(super) struct Section<'a> {
    path: String,
    origin: Origin,
    table: Option<&'a Table>,
    schema: Schema,
    accepts_the_rest: bool,
    errors: &'a RefCell<Vec<ScenarioError>>,
}

/// Reads a whole document and returns what was read or everything that is wrong.
pub(super) fn read_document<T>(
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

    /// Runs `read` on this section, then reports missing and unknown keys.
    fn read<T>(mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let result = read(&mut self);
        self.finish();
        result
    }

    /// A number; required if there is no default.
    pub(super) fn number(
        &mut self,
        key: &'static str,
        unit: &'static str,
        default: impl Into<Option<f64>>,
        range: NumberRange,
    ) -> f64 {
        let default = default.into();
        let allowed = range.describe(unit);
        let Some(node) = self.look_up(key, unit, default.is_none().then(|| format!("a number {allowed}")))
        else {
            return default.unwrap_or(f64::NAN);
        };
        self.check_number(key, node, range, &allowed)
    }

    /// A number that may be left out and has no default.
    pub(super) fn optional_number(
        &mut self,
        key: &'static str,
        unit: &'static str,
        range: NumberRange,
    ) -> Option<f64> {
        let node = self.look_up(key, unit, None)?;
        Some(self.check_number(key, node, range, &range.describe(unit)))
    }

    fn check_number(&self, key: &str, node: &Node, range: NumberRange, allowed: &str) -> f64 {
        let number = match node.value {
            // Exact up to 2^53, far beyond every range here.
            Value::Integer(number) => number as f64,
            Value::Float(number) => number,
            _ => {
                self.wrong_type(key, node, format!("a number {allowed}"));
                return f64::NAN;
            }
        };
        if range.contains(number) {
            return number;
        }
        self.fault(
            key,
            node,
            Fault::OutOfRange { found: node.value.to_string(), allowed: allowed.to_owned() },
        );
        f64::NAN
    }

    /// A whole number; required if there is no default.
    pub(super) fn integer<T>(
        &mut self,
        key: &'static str,
        unit: &'static str,
        default: impl Into<Option<T>>,
        range: RangeInclusive<T>,
    ) -> T
    where
        T: Copy + Display + PartialOrd + TryFrom<i64>,
    {
        let default = default.into();
        let allowed = with_unit(format!(">= {} and <= {}", range.start(), range.end()), unit);
        let required = default.is_none().then(|| format!("a whole number {allowed}"));
        let stand_in = default.unwrap_or(*range.start());
        let Some(node) = self.look_up(key, unit, required) else {
            return stand_in;
        };
        self.check_integer(key, node, &range, allowed).unwrap_or(stand_in)
    }

    /// A whole number that may be left out and has no default.
    pub(super) fn optional_integer<T>(
        &mut self,
        key: &'static str,
        unit: &'static str,
        range: RangeInclusive<T>,
    ) -> Option<T>
    where
        T: Copy + Display + PartialOrd + TryFrom<i64>,
    {
        let node = self.look_up(key, unit, None)?;
        let allowed = with_unit(format!(">= {} and <= {}", range.start(), range.end()), unit);
        self.check_integer(key, node, &range, allowed)
    }

    fn check_integer<T>(
        &self,
        key: &str,
        node: &Node,
        range: &RangeInclusive<T>,
        allowed: String,
    ) -> Option<T>
    where
        T: PartialOrd + TryFrom<i64>,
    {
        let Value::Integer(found) = node.value else {
            self.wrong_type(key, node, format!("a whole number {allowed}"));
            return None;
        };
        let number = T::try_from(found).ok().filter(|number| range.contains(number));
        if number.is_none() {
            self.fault(key, node, Fault::OutOfRange { found: found.to_string(), allowed });
        }
        number
    }

    /// A text; `None` if absent or faulty. `purpose` says what it is if it is required.
    pub(super) fn text(&mut self, key: &'static str, purpose: Option<&str>) -> Option<&'a str> {
        let node = self.look_up(key, unit::NONE, purpose.map(str::to_owned))?;
        if let Value::Text(text) = &node.value {
            return Some(text);
        }
        self.wrong_type(key, node, purpose.unwrap_or("a text in quotes").to_owned());
        None
    }

    /// One of a few words; required if there is no default. `None` if absent or faulty.
    pub(super) fn choice<T: Copy>(
        &mut self,
        key: &'static str,
        default: impl Into<Option<T>>,
        choices: &[(&'static str, T)],
    ) -> Option<T> {
        let default = default.into();
        let allowed = either(choices.iter().map(|(word, _)| *word));
        let Some(node) = self.look_up(key, unit::NONE, default.is_none().then(|| allowed.clone())) else {
            return default;
        };
        let Value::Text(found) = &node.value else {
            self.wrong_type(key, node, allowed);
            return None;
        };
        let choice = choices.iter().find(|(word, _)| word == found).map(|(_, choice)| *choice);
        if choice.is_none() {
            self.fault(key, node, Fault::NotAChoice { found: node.value.to_string(), allowed });
        }
        choice
    }

    /// A section inside this one; if it is absent, its defaults are read.
    pub(super) fn section<T>(&mut self, key: &'static str, read: impl FnOnce(&mut Section<'_>) -> T) -> T {
        let path = self.path_of(key);
        match self.look_up(key, unit::NONE, None) {
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

    /// The sections of a list `[[key]]`, none if it is absent.
    pub(super) fn sections<T>(
        &mut self,
        key: &'static str,
        mut read: impl FnMut(&mut Section<'_>) -> T,
    ) -> Vec<T> {
        let Some(node) = self.look_up(key, unit::NONE, None) else {
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

    /// Every key of this section with its value: the section's keys aren't ours to know.
    pub(super) fn all(&mut self) -> impl Iterator<Item = (&'a str, &'a Node)> + use<'a> {
        self.accepts_the_rest = true;
        self.table.into_iter().flat_map(Table::iter)
    }

    /// Takes unknown keys for granted, because the key that decides what they mean is itself faulty.
    pub(super) fn accept_the_rest(&mut self) {
        self.accepts_the_rest = true;
    }

    /// Declares the keys `read` would have read, had `owner` been the value of `key` instead of `chosen`.
    pub(super) fn belongs_to<T>(
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

    /// Declares symbols of the paper and the key each stands for.
    pub(super) fn symbols(&mut self, symbols: &'static [(&'static str, &'static str)]) {
        self.schema.symbols = symbols;
    }

    /// Blames `key` for what is missing from here on, if the command line set it: the option that chose a
    /// profile is what has to be completed, not the section of the file.
    pub(super) fn blame_option(&mut self, key: &str) {
        if let Some(origin @ Origin::Option(_)) = self.node(key).map(|node| &node.origin) {
            self.origin = origin.clone();
        }
    }

    /// Whether the command line set this key: of two keys that don't go together, that one is to blame.
    pub(super) fn is_option(&self, key: &str) -> bool {
        matches!(self.node(key), Some(Node { origin: Origin::Option(_), .. }))
    }

    /// Reports a value that is fine alone but not together with others. `reason` continues the sentence after
    /// the value.
    pub(super) fn reject(&self, key: &str, reason: String) {
        if let Some(node) = self.node(key) {
            self.fault(key, node, Fault::Rejected { found: node.value.to_string(), reason });
        }
    }

    /// Reports a section whose keys are fine one by one.
    pub(super) fn reject_section(&self, reason: &str) {
        let fault = Fault::Rejected { found: "this section".to_owned(), reason: reason.to_owned() };
        self.push(self.path.clone(), self.origin.clone(), fault);
    }

    /// Reports any other fault of the value of `key`.
    pub(super) fn fault(&self, key: &str, node: &Node, fault: Fault) {
        self.push(self.path_of(key), node.origin.clone(), fault);
    }

    /// The value of a key that has been read.
    pub(super) fn node(&self, key: &str) -> Option<&'a Node> {
        self.table.and_then(|table| table.get(key))
    }

    fn wrong_type(&self, key: &str, node: &Node, allowed: String) {
        let (found, kind) = (node.value.to_string(), node.value.kind());
        self.fault(key, node, Fault::WrongType { found, kind, allowed });
    }

    fn look_up(
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
            let (fault, meant) = self.schema.explain_unknown(name, &node.value);
            self.fault(&spell_key(name), node, fault);
            // One sentence is enough for a key, or a section with all its keys, that is there under another name.
            if let Some(meant) = meant {
                self.schema.known.retain(|key| key.name != meant);
                let inside = format!("{}.", self.path_of(meant));
                self.errors.borrow_mut().retain(|error| !error.is_missing_inside(&inside));
            }
        }
        for KnownKey { name, missing, .. } in &self.schema.known {
            if let Some(allowed) = missing.clone() {
                self.push(self.path_of(name), self.origin.clone(), Fault::Missing { allowed });
            }
        }
    }

    fn push(&self, key: String, origin: Origin, fault: Fault) {
        self.errors.borrow_mut().push(ScenarioError::Key { origin, key, fault: Box::new(fault) });
    }

    fn path_of(&self, key: &str) -> String {
        join(&self.path, key)
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// `"a", "b" or "c"`.
fn either<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let mut quoted: Vec<_> = words.into_iter().map(|word| format!("\"{word}\"")).collect();
    match quoted.pop() {
        Some(last) if quoted.is_empty() => last,
        Some(last) => format!("{} or {last}", quoted.join(", ")),
        None => String::new(),
    }
}
