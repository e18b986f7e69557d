//! The keys of files of settings as data: what a reader accepts, and what pages and JSON Schemas print.

use std::borrow::Cow;

use super::key_error::KeyError;
use super::range::NumberRange;
use super::spelling::{decimal_point, either, nearest, with_unit};
use super::tree::{Node, Value};

/// A key, as a section declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Name, with the unit at its end.
    pub name: &'static str,
    /// Meaning, in one paragraph of Markdown.
    pub doc: &'static str,
    /// Unit; empty for a pure number, a text and a section.
    pub unit: &'static str,
    /// Whether a scenario has to give it.
    pub required: bool,
    /// Value of an absent key; `None` for a required and for an optional key.
    pub default: Option<Value>,
    /// Values that it takes.
    pub kind: KeyKind,
}

/// Values that a key takes.
#[derive(Debug, Clone, PartialEq)]
pub enum KeyKind {
    /// A number.
    Number(NumberRange),
    /// A whole number.
    WholeNumber {
        /// Smallest allowed value.
        low: i128,
        /// Largest allowed value.
        high: i128,
    },
    /// A text.
    Text {
        /// What it must be, in words.
        allowed: Cow<'static, str>,
    },
    /// A list of texts.
    Texts {
        /// What it must be, in words.
        allowed: &'static str,
        /// Whether each item has an error of its own.
        by_item: bool,
    },
    /// A list of numbers, booleans or texts.
    Values,
    /// One of several names.
    Choice(Vec<Choice>),
    /// A list of names; one name may stand without a list.
    Choices(Vec<Choice>),
    /// A section `[key]`.
    Section(Keys),
    /// A list of sections `[[key]]`.
    Sections(Keys),
}

impl KeyKind {
    pub(super) fn is_number(&self) -> bool {
        matches!(self, Self::Number(_) | Self::WholeNumber { .. })
    }

    /// What a value must be, in words.
    pub(super) fn allowed(&self, unit: &str) -> String {
        match self {
            Self::Number(_) => format!("a number {}", self.range(unit)),
            Self::WholeNumber { .. } => format!("a whole number {}", self.range(unit)),
            Self::Text { allowed } => allowed.clone().into_owned(),
            Self::Texts { allowed, .. } => (*allowed).to_owned(),
            Self::Choice(choices) | Self::Choices(choices) => either(choices.iter().map(|it| it.name)),
            Self::Values | Self::Section(_) | Self::Sections(_) => {
                "a list of numbers, booleans or texts, at least one".to_owned()
            }
        }
    }

    /// `>= 1 and <= 64 ms`.
    pub(super) fn range(&self, unit: &str) -> String {
        match self {
            Self::Number(range) => range.describe(unit),
            Self::WholeNumber { low, high } => with_unit(format!(">= {low} and <= {high}"), unit),
            _ => String::new(),
        }
    }

    /// What is wrong with a value, or with an item of several choices.
    pub(super) fn problem(&self, value: &Value, unit: &str) -> Option<KeyError> {
        let list = |is_good: &dyn Fn(&Node) -> bool| value.list().filter(|items| items.iter().all(is_good));
        let is_scalar =
            |item: &Node| !matches!(item.value, Value::Date(_) | Value::Array(_) | Value::Table(_));
        // Whether the value is allowed; `None` if it is of another type.
        let is_allowed = match self {
            Self::Number(range) => value.number().map(|number| range.contains(number)),
            Self::WholeNumber { low, high } => {
                let is_within = |number: i64| (*low..=*high).contains(&number.into());
                value.whole_number().map(|number| number.is_some_and(is_within))
            }
            Self::Text { .. } => value.text().map(|_| true),
            Self::Texts { .. } => list(&|item| item.text().is_some()).map(|_| true),
            Self::Values => list(&is_scalar).filter(|items| !items.is_empty()).map(|_| true),
            Self::Choice(choices) | Self::Choices(choices) => {
                value.text().map(|text| choices.iter().any(|choice| choice.name == text))
            }
            Self::Section(_) | Self::Sections(_) => Some(true),
        };
        if is_allowed == Some(true) {
            return None;
        }
        let found = value.to_string();
        let comma = value.text().filter(|_| self.is_number()).and_then(decimal_point);
        Some(match (self, comma) {
            (_, Some(written)) => KeyError::rejected(found, format!("has a decimal comma; write {written}")),
            _ if is_allowed.is_none() => {
                KeyError::WrongType { found, kind: value.kind(), allowed: self.allowed(unit) }
            }
            (Self::Choice(choices) | Self::Choices(choices), _) => {
                let meant = value.text().and_then(|text| nearest(text, choices.iter().map(|it| it.name)));
                let meant = meant.map_or_else(String::new, |name| format!(" (did you mean \"{name}\"?)"));
                KeyError::NotAChoice { found, allowed: self.allowed(unit) + &meant }
            }
            _ => KeyError::OutOfRange { found, allowed: self.range(unit) },
        })
    }

    /// The value of a faulty key until the document is rejected.
    pub(super) fn stand_in(&self) -> Value {
        match self {
            Self::Number(_) => Value::Float(f64::NAN),
            Self::WholeNumber { low, .. } => Value::Integer(i64::try_from(*low).unwrap_or_default()),
            Self::Text { .. } => Value::Text(String::new()),
            Self::Choice(choices) => Value::Text(choices.first().map_or("", |choice| choice.name).to_owned()),
            _ => Value::Array(Vec::new()),
        }
    }
}

/// A name that a key takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// As scenarios spell it.
    pub name: &'static str,
    /// Meaning; empty where the name is enough.
    pub doc: &'static str,
}

/// The keys of a section.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Keys {
    /// Keys that the section always has, in the order of their declaration.
    pub keys: Vec<Key>,
    /// Keys that are declared elsewhere.
    pub further: Further,
    /// Keys that depend on a choice.
    pub selectors: Vec<Selector>,
    /// Symbols of the paper, each with its key.
    pub symbols: &'static [(&'static str, &'static str)],
}

/// Keys of a section that the reader doesn't declare.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Further {
    /// None: an unknown key is an error.
    #[default]
    Rejected,
    /// Any key with a number, a boolean or a text, which the drive checks.
    Values,
    /// Any key with any value, which is passed on.
    Anything,
}

/// A choice that decides on further keys.
#[derive(Debug, Clone, PartialEq)]
pub struct Selector {
    /// The key of the choice.
    pub key: &'static str,
    /// Each name of the choice with the keys that it adds.
    pub variants: Vec<(&'static str, Keys)>,
    /// Whether the error for a key of another name says whose key it is.
    pub names_owner: bool,
}

impl Keys {
    /// Whether a scenario must have this section: one of its keys is required.
    #[must_use]
    pub fn is_required(&self) -> bool {
        self.keys
            .iter()
            .any(|key| key.required || matches!(&key.kind, KeyKind::Section(keys) if keys.is_required()))
    }

    /// Every key with these keys, those of each choice included.
    pub fn all(&self) -> impl Iterator<Item = &Key> {
        let mut all: Vec<_> = self.keys.iter().collect();
        for (_, keys) in self.selectors.iter().flat_map(|selector| &selector.variants) {
            all.extend(keys.all());
        }
        all.into_iter()
    }

    /// Paths such as `plant.initial.load_position_rad` of every key with this name; lists of sections are omitted, because
    /// their paths need an index.
    #[must_use]
    pub fn paths_of(&self, name: &str) -> Vec<String> {
        let mut paths = Vec::new();
        for key in self.all() {
            if key.name == name {
                paths.push(name.to_owned());
            }
            if let KeyKind::Section(keys) = &key.kind {
                paths.extend(keys.paths_of(name).into_iter().map(|path| format!("{}.{path}", key.name)));
            }
        }
        paths.sort_unstable();
        paths.dedup();
        paths
    }
}
