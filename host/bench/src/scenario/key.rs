//! The keys of scenarios as data: what the reader accepts, and what the page and the JSON Schema print.

use super::range::NumberRange;

/// A key, as the reader declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Name, with the unit at its end.
    pub name: &'static str,
    /// Meaning, in one paragraph of Markdown.
    pub doc: String,
    /// Unit; empty for a pure number, a text and a section.
    pub unit: &'static str,
    /// Whether a scenario has to give it.
    pub required: bool,
    /// Values that it takes.
    pub kind: KeyKind,
}

/// Values that a key takes.
#[derive(Debug, Clone, PartialEq)]
pub enum KeyKind {
    /// A number.
    Number {
        /// Allowed values.
        range: NumberRange,
        /// Value of an absent key; `None` for a required and for an optional key.
        default: Option<f64>,
    },
    /// A whole number.
    WholeNumber {
        /// Smallest allowed value.
        low: i128,
        /// Largest allowed value.
        high: i128,
        /// Value of an absent key.
        default: Option<i128>,
    },
    /// Any text.
    Text,
    /// A list of any texts.
    Texts,
    /// A list of numbers, booleans or texts.
    Values,
    /// One of several names.
    Choice {
        /// The names.
        choices: Vec<Choice>,
        /// Name in force if the key is absent.
        default: Option<&'static str>,
    },
    /// A list of names; one name may stand without a list.
    Choices(Vec<Choice>),
    /// A section `[key]`.
    Section(Keys),
    /// A list of sections `[[key]]`.
    Sections(Keys),
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
