//! Probe documents, and the comparison of the keys that they declare.

use std::sync::Arc;

use crate::scenario::key::{Key, KeyKind, Keys, Selector};
use crate::scenario::origin::Origin;
use crate::scenario::reader::{KnownKey, Section, SectionKeys, read_document};
use crate::scenario::tree::{Node, Table, Value};

/// Unit of a key whose unit depends on a choice.
const DEPENDS: &str = "as chosen";

/// The keys that a reader reads from a document.
pub(in crate::scenario) struct Catalogue<'a> {
    origin: Origin,
    read: Box<dyn Fn(&mut Section<'_>) + 'a>,
}

impl<'a> Catalogue<'a> {
    pub(in crate::scenario) fn new(read: impl Fn(&mut Section<'_>) + 'a) -> Self {
        Self { origin: Origin::Option(Arc::from("")), read: Box::new(read) }
    }

    /// Every key, under any choice: some hundred readings.
    pub(in crate::scenario) fn all(&self) -> Keys {
        self.keys(&Table::default(), &[], &[])
    }

    /// Whether `name` is a key or a section of the whole document: one reading.
    pub(in crate::scenario) fn has_at_its_top(&self, name: &str) -> bool {
        self.declared(&Table::default()).keys.iter().any(|known| known.key.name == name)
    }

    /// The keys of the section at `path` in a document that makes the choices of `probe`. The choices in `made` are not varied.
    fn keys(&self, probe: &Table, path: &[&'static str], made: &[&'static str]) -> Keys {
        let probe = self.complete(probe.clone());
        let declared = self.declared(&probe);
        let mut keys = Keys::default();
        for known in at(&declared, path).into_iter().flat_map(|section| &section.keys) {
            let mut key = known.key.clone();
            let inside = || self.keys(&probe, &[path, &[key.name]].concat(), &[]);
            key.kind = match key.kind {
                KeyKind::Section(_) => KeyKind::Section(inside()),
                KeyKind::Sections(_) => KeyKind::Sections(inside()),
                kind => kind,
            };
            keys.keys.push(key);
        }
        keys.further = at(&declared, path).map(|section| section.further).unwrap_or_default();
        for choice in keys.keys.clone() {
            let KeyKind::Choice { choices, .. } = &choice.kind else { continue };
            if made.contains(&choice.name) || !keys.keys.contains(&choice) {
                continue;
            }
            let probes: Vec<_> = choices
                .iter()
                .map(|word| (word.name, self.choose(&probe, path, choice.name, word.name)))
                .collect();
            // Choices that every variant has are varied here, once, and not in each variant.
            let declared: Vec<_> = probes.iter().map(|(_, probe)| self.declared(probe)).collect();
            let is_common = |name: &str| {
                declared.iter().all(|declared| {
                    at(declared, path)
                        .is_some_and(|section| section.keys.iter().any(|known| known.key.name == name))
                })
            };
            let common: Vec<_> =
                keys.keys.iter().map(|key| key.name).filter(|name| is_common(name)).collect();
            let made = [made, &common].concat();
            let variants = probes.iter().map(|(name, probe)| (*name, self.keys(probe, path, &made)));
            keys.split(choice.name, variants.collect());
        }
        keys
    }

    /// The probe with this choice.
    fn choose(&self, probe: &Table, path: &[&'static str], key: &str, name: &str) -> Table {
        let mut probe = probe.clone();
        self.insert(&mut probe, path, key, Value::Text(name.to_owned()));
        probe
    }

    /// Makes every open choice and gives every list one section, until the reader declares nothing new.
    fn complete(&self, mut probe: Table) -> Table {
        while let Some((path, key, value)) = open_end(&self.declared(&probe), &mut Vec::new()) {
            self.insert(&mut probe, &path, key, value);
        }
        probe
    }

    fn declared(&self, probe: &Table) -> SectionKeys {
        read_document(probe, self.origin.clone(), |root| (self.read)(root)).keys
    }

    fn insert(&self, probe: &mut Table, path: &[&'static str], key: &str, value: Value) {
        let node = |value| Node { origin: self.origin.clone(), value };
        let mut table = probe;
        for name in path {
            if table.get(name).is_none() {
                table.insert(name, node(Value::Table(Table::default())));
            }
            let inside = match table.get_mut(name).map(|node| &mut node.value) {
                Some(Value::Array(items)) => items.first_mut().map(|node| &mut node.value),
                value => value,
            };
            let Some(Value::Table(inside)) = inside else { return };
            table = inside;
        }
        let value = match value {
            Value::Array(_) => Value::Array(vec![node(Value::Table(Table::default()))]),
            value => value,
        };
        table.insert(key, node(value));
    }
}

/// The first choice that is not made or list that is empty: its section, its key and a value.
fn open_end(
    section: &SectionKeys,
    path: &mut Vec<&'static str>,
) -> Option<(Vec<&'static str>, &'static str, Value)> {
    for KnownKey { key, origin, inside, .. } in &section.keys {
        let value = match &key.kind {
            KeyKind::Choice { choices, default } if origin.is_none() => default
                .or_else(|| choices.first().map(|choice| choice.name))
                .map(|name| Value::Text(name.to_owned())),
            KeyKind::Sections(_) if origin.is_none() => Some(Value::Array(Vec::new())),
            _ => None,
        };
        if let Some(value) = value {
            return Some((path.clone(), key.name, value));
        }
        path.push(key.name);
        let found = inside.as_ref().and_then(|inside| open_end(inside, path));
        path.pop();
        if found.is_some() {
            return found;
        }
    }
    None
}

/// The section at `path`; of a list its first section.
fn at<'a>(section: &'a SectionKeys, path: &[&str]) -> Option<&'a SectionKeys> {
    let Some((first, rest)) = path.split_first() else { return Some(section) };
    let known = section.keys.iter().find(|known| known.key.name == *first)?;
    at(known.inside.as_ref()?, rest)
}

impl Keys {
    /// Moves keys that not every variant of a choice has to that choice.
    fn split(&mut self, choice: &'static str, mut variants: Vec<(&'static str, Self)>) {
        self.merge_units(&mut variants);
        let everywhere = |key: &Key| variants.iter().all(|(_, keys)| keys.keys.contains(key));
        let common: Vec<_> = self.keys.iter().filter(|key| everywhere(key)).cloned().collect();
        for (_, keys) in &mut variants {
            keys.keys.retain(|key| !common.contains(key));
        }
        if variants.iter().all(|(_, keys)| keys.keys.is_empty() && keys.selectors.is_empty()) {
            return;
        }
        self.keys = common;
        self.selectors.push(Selector { key: choice, variants });
    }

    /// Makes keys equal that every variant has and that differ in their units only.
    fn merge_units(&mut self, variants: &mut [(&'static str, Self)]) {
        for key in &mut self.keys {
            let but_for_unit = |other: &Key| Key { unit: key.unit, ..other.clone() } == *key;
            let mut others =
                variants.iter().map(|(_, keys)| keys.keys.iter().find(|other| but_for_unit(other)));
            if others.clone().all(|other| other.is_some())
                && others.any(|other| other.is_some_and(|it| it.unit != key.unit))
            {
                let before = key.clone();
                key.unit = DEPENDS;
                for (_, keys) in variants.iter_mut() {
                    for other in keys
                        .keys
                        .iter_mut()
                        .filter(|other| Key { unit: before.unit, ..(*other).clone() } == before)
                    {
                        other.unit = DEPENDS;
                    }
                }
            }
        }
    }
}
