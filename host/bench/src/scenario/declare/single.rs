//! Single values of TOML: numbers, texts and choices.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use super::field::{Field, Variants, field};
use super::named::Named;
use crate::scenario::key::{Choice, Key, KeyKind, Selector};
use crate::scenario::range::NumberRange;
use crate::scenario::reader::Section;
use crate::scenario::tree::{Node, Value};
use crate::scenario::unit;

/// A key with a single value. A file has to give it unless it has a default.
pub struct Single<T> {
    kind: KeyKind,
    /// Unit of a number whose name doesn't end with it.
    unit: Option<&'static str>,
    default: Option<T>,
    required: bool,
    read: fn(&Value) -> Option<T>,
    write: fn(&T) -> Value,
}

/// A key that may be absent.
pub struct Optional<T>(Single<T>);

impl<T: Clone> Single<T> {
    fn new(kind: KeyKind, read: fn(&Value) -> Option<T>, write: fn(&T) -> Value) -> Self {
        Self { kind, unit: None, default: None, required: true, read, write }
    }

    /// The same key with a default.
    #[must_use]
    pub fn or(self, default: T) -> Self {
        self.with_default(Some(default))
    }

    pub(in crate::scenario) fn with_default(self, default: Option<T>) -> Self {
        Self { required: default.is_none(), default, ..self }
    }

    /// The same key, which may be absent.
    #[must_use]
    pub fn optional(self) -> Optional<T> {
        Optional(Self { required: false, ..self })
    }

    /// The same number in a unit that is not the end of its name.
    #[must_use]
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit: Some(unit), ..self }
    }

    fn unit_of(&self, name: &'static str) -> &'static str {
        let of_name = if self.kind.is_number() { unit::of(name) } else { "" };
        self.unit.unwrap_or(of_name)
    }

    /// The value; `None` if it is absent, or faulty, and has no default.
    pub(in crate::scenario) fn find(
        &self,
        name: &'static str,
        doc: &'static str,
        section: &mut Section<'_>,
    ) -> Option<T> {
        let (unit, required) = (self.unit_of(name), self.required);
        section.describe(|keys| {
            let (kind, default) = (self.kind.clone(), self.default.as_ref().map(self.write));
            keys.keys.push(Key { name, doc, unit, required, default, kind });
        });
        let is_fraction = matches!(self.kind, KeyKind::Number(_));
        let value = match section.look_up(name, unit, || required.then(|| self.kind.allowed(unit))) {
            Some(node) if self.accepts(name, unit, node, section) => (self.read)(&node.value),
            // NaN, so that comparisons between keys don't report the same error again.
            Some(_) if is_fraction => self.stand_in(),
            _ => self.default.clone(),
        };
        if let (true, Some(number)) = (is_fraction, value.as_ref().map(self.write)) {
            section.in_force(name, unit, number.number().unwrap_or(f64::NAN));
        }
        value
    }

    /// Reports what is wrong with a value; whether it can be read all the same.
    fn accepts(&self, name: &str, unit: &str, node: &Node, section: &Section<'_>) -> bool {
        let (items, is_list) = match (&self.kind, &node.value) {
            (KeyKind::Choices(_), _) => (node.items(), true),
            (KeyKind::Texts { by_item: true, .. }, Value::Array(items)) => {
                for (index, item) in items.iter().enumerate().filter(|(_, item)| item.text().is_none()) {
                    section.wrong_type(&format!("{name}.{index}"), item, ANY_TEXT);
                }
                return true;
            }
            _ => (std::slice::from_ref(node), false),
        };
        let mut is_accepted = true;
        for item in items {
            if let Some(problem) = self.kind.problem(&item.value, unit) {
                section.error(name, item, problem);
                is_accepted = is_list;
            }
        }
        is_accepted
    }

    /// The value of a faulty key until the document is rejected.
    fn stand_in(&self) -> Option<T> {
        (self.read)(&self.kind.stand_in())
    }
}

impl<T: Clone> Field for Single<T> {
    type Value = T;

    fn read(&self, name: &'static str, doc: &'static str, section: &mut Section<'_>) -> T {
        self.find(name, doc, section).or_else(|| self.stand_in()).expect("a kind reads its own stand-in")
    }
}

impl<T: Clone> Field for Optional<T> {
    type Value = Option<T>;

    fn read(&self, name: &'static str, doc: &'static str, section: &mut Section<'_>) -> Option<T> {
        self.0.find(name, doc, section)
    }
}

const ANY_TEXT: &str = "a text in quotes";

/// A number.
pub fn number(range: impl Into<NumberRange>) -> Single<f64> {
    Single::new(KeyKind::Number(range.into()), Value::number, |number| Value::Float(*number))
}

/// A whole number.
pub fn integer<T>(range: RangeInclusive<T>) -> Single<T>
where
    T: Copy + TryFrom<i64> + Into<i128>,
{
    let [low, high] = [*range.start(), *range.end()].map(Into::into);
    let read = |value: &Value| value.whole_number()?.and_then(|number| T::try_from(number).ok());
    let write = |number: &T| Value::Integer(i64::try_from((*number).into()).unwrap_or(i64::MAX));
    Single::new(KeyKind::WholeNumber { low, high }, read, write)
}

/// A text, and what it must be in words.
pub fn text(allowed: impl Into<Cow<'static, str>>) -> Single<String> {
    let kind = KeyKind::Text { allowed: allowed.into() };
    Single::new(kind, |value| value.text().map(str::to_owned), |text| Value::Text(text.clone()))
}

/// A text, or none.
#[must_use]
pub fn any_text() -> Optional<String> {
    text(ANY_TEXT).optional()
}

/// A list of texts, and what it must be in words.
#[must_use]
pub fn texts(allowed: &'static str) -> Single<Vec<String>> {
    let read = |value: &Value| value.list()?.iter().map(|item| item.text().map(str::to_owned)).collect();
    Single::new(KeyKind::Texts { allowed, by_item: false }, read, |_| Value::Array(Vec::new()))
}

/// A list of texts with their places, each of which has an error of its own.
pub(in crate::scenario) fn placed_texts(allowed: &'static str) -> Single<Vec<Node>> {
    let read =
        |value: &Value| Some(value.list()?.iter().filter(|item| item.text().is_some()).cloned().collect());
    Single::new(KeyKind::Texts { allowed, by_item: true }, read, |items| Value::Array(items.clone()))
}

/// A list of numbers, booleans or texts, at least one, or none.
pub(in crate::scenario) fn values() -> Optional<Vec<Node>> {
    let read = |value: &Value| Some(value.list()?.to_vec());
    Single::new(KeyKind::Values, read, |items| Value::Array(items.clone())).optional()
}

/// A value of a list whose values are of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Scalar {
    /// A number, exact up to 2^53 if it is whole.
    Number(f64),
    /// `true` or `false`.
    Boolean(bool),
    /// A text.
    Text(String),
}

/// A list of numbers, booleans or texts, or none.
pub fn scalars() -> impl Field<Value = Option<Vec<Scalar>>> {
    let scalar = |item: Node| match item.value {
        Value::Boolean(boolean) => Scalar::Boolean(boolean),
        Value::Text(text) => Scalar::Text(text),
        other => Scalar::Number(other.number().unwrap_or(f64::NAN)),
    };
    values().map(move |items, _| Some(items?.into_iter().map(scalar).collect()))
}

/// A name.
#[must_use]
pub fn choice<T: Named>() -> Single<T> {
    let kind = KeyKind::Choice(T::ALL.iter().map(|value| value.choice()).collect());
    Single::new(kind, |value| T::named(value.text()?), |value| Value::Text(value.choice().name.to_owned()))
}

/// A list of names, of which a single one may stand without a list. Absent, it is empty.
#[must_use]
pub fn choices<T: Named>() -> Single<Vec<T>> {
    let kind = KeyKind::Choices(T::ALL.iter().map(|value| value.choice()).collect());
    let read = |value: &Value| match value.list() {
        Some(items) => Some(items.iter().filter_map(|item| T::named(item.text()?)).collect()),
        None => value.text().and_then(T::named).map(|name| vec![name]).or(Some(Vec::new())),
    };
    Single::new(kind, read, |_| Value::Array(Vec::new())).or(Vec::new())
}

/// One of these names.
pub(in crate::scenario) fn name_of(choices: Vec<Choice>) -> Single<String> {
    Single { kind: KeyKind::Choice(choices), ..text("") }
}

/// A choice that decides on further keys of its section. A faulty choice is `None`. If it `names_owner`, the error for a key
/// of another name says whose key it is.
pub fn tagged<V: Variants>(names_owner: bool) -> impl Field<Value = Option<V>> {
    field(move |name, doc, section| {
        let chosen = name_of(V::choices()).find(name, doc, section);
        section.describe(|keys| {
            let read = |name| Section::keys_of(|inside| V::read(name, inside));
            let variants = V::choices().iter().map(|it| (it.name, read(it.name))).collect();
            keys.selectors.push(Selector { key: name, variants, names_owner });
        });
        let variant = chosen.and_then(|chosen| V::read(&chosen, section));
        if variant.is_none() {
            section.accept_the_rest();
        }
        variant
    })
}
