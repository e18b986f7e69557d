//! Keys of a section as values: how each is described, and how it is read.

use crate::scenario::key::{Choice, Key, KeyKind, Keys};
use crate::scenario::reader::Section;

/// A key of a section, or several keys that are one value.
pub trait Field {
    /// What is read.
    type Value;

    /// Adds the key of this name and meaning.
    fn declare(&self, name: &'static str, doc: &'static str, keys: &mut Keys);

    /// Reads the key of this name.
    fn read(&self, name: &'static str, section: &mut Section<'_>) -> Self::Value;

    /// The same key as another value. `convert` may report what is wrong with the value.
    fn map<T, C: Fn(Self::Value, &mut Section<'_>) -> T>(self, convert: C) -> Map<Self, C>
    where
        Self: Sized,
    {
        Map { field: self, convert }
    }
}

/// The keys of a section as a type. [`settings!`](crate::settings) implements it.
pub trait Settings: Sized {
    /// Adds the keys.
    fn declare(keys: &mut Keys);

    /// Reads the keys.
    fn read(section: &mut Section<'_>) -> Self;
}

/// A choice whose names have keys of their own. [`settings!`](crate::settings) implements it.
pub trait Variants: Sized {
    /// The names.
    fn choices() -> Vec<Choice>;

    /// The name of a value, as files spell it.
    fn name(&self) -> &'static str;

    /// Adds the keys of a name; whether the choice has the name.
    fn declare(name: &str, keys: &mut Keys) -> bool;

    /// Reads the keys of a name; `None` if the choice doesn't have it.
    fn read(name: &str, section: &mut Section<'_>) -> Option<Self>;
}

/// See [`Field::map`].
pub struct Map<F, C> {
    field: F,
    convert: C,
}

impl<F: Field, T, C: Fn(F::Value, &mut Section<'_>) -> T> Field for Map<F, C> {
    type Value = T;

    fn declare(&self, name: &'static str, doc: &'static str, keys: &mut Keys) {
        self.field.declare(name, doc, keys);
    }

    fn read(&self, name: &'static str, section: &mut Section<'_>) -> T {
        let value = self.field.read(name, section);
        (self.convert)(value, section)
    }
}

/// A field of two functions.
struct Made<D, R> {
    declare: D,
    read: R,
}

impl<T, D, R> Field for Made<D, R>
where
    D: Fn(&'static str, &'static str, &mut Keys),
    R: Fn(&'static str, &mut Section<'_>) -> T,
{
    type Value = T;

    fn declare(&self, name: &'static str, doc: &'static str, keys: &mut Keys) {
        (self.declare)(name, doc, keys);
    }

    fn read(&self, name: &'static str, section: &mut Section<'_>) -> T {
        (self.read)(name, section)
    }
}

/// A field that `declare` adds to the keys, with name and meaning, and `read` reads.
pub(in crate::scenario) fn field<T>(
    declare: impl Fn(&'static str, &'static str, &mut Keys),
    read: impl Fn(&'static str, &mut Section<'_>) -> T,
) -> impl Field<Value = T> {
    Made { declare, read }
}

impl Keys {
    fn add_sections(&mut self, name: &'static str, doc: &'static str, kind: KeyKind) {
        self.keys.push(Key { name, doc, unit: "", required: false, default: None, kind });
    }
}

/// A section with the keys that `declare` adds and `read` reads. An absent one reads as its defaults.
pub fn section_of<T>(
    declare: impl Fn(&mut Keys) + Clone,
    read: impl Fn(&mut Section<'_>) -> T,
) -> impl Field<Value = T> {
    let add = declare.clone();
    field(
        move |name, doc, keys| keys.add_sections(name, doc, KeyKind::Section(Keys::of(&declare))),
        move |name, section| section.section(name, &add, &read),
    )
}

/// A section. `convert` may report what is wrong with its keys together.
pub fn section<S: Settings, T>(convert: impl Fn(S, &mut Section<'_>) -> T) -> impl Field<Value = T> {
    section_of(S::declare, move |inside| {
        let settings = S::read(inside);
        convert(settings, inside)
    })
}

/// A list of sections. An absent list is empty.
pub fn sections<S: Settings, T>(convert: impl Fn(S, &mut Section<'_>) -> T) -> impl Field<Value = Vec<T>> {
    let read = move |inside: &mut Section<'_>| {
        let settings = S::read(inside);
        convert(settings, inside)
    };
    field(
        |name, doc, keys| keys.add_sections(name, doc, KeyKind::Sections(Keys::of(S::declare))),
        move |name, section| section.sections(name, &S::declare, &read),
    )
}

/// Several keys of one section as one value.
pub fn flat<S: Settings, T>(convert: impl Fn(S, &mut Section<'_>) -> T) -> impl Field<Value = T> {
    field(
        |_, _, keys| S::declare(keys),
        move |_, section| {
            let settings = S::read(section);
            convert(settings, section)
        },
    )
}

/// The keys of a section as they are, for [`section`] and [`sections`].
#[must_use]
pub fn plain<S>(settings: S, _: &mut Section<'_>) -> S {
    settings
}

/// No key: a field that files don't have.
pub fn skipped<T>(make: impl Fn(&Section<'_>) -> T) -> impl Field<Value = T> {
    field(|_, _, _| {}, move |_, section| make(section))
}

/// A key that depends on other keys of its section. Documents have it as in an empty section.
pub fn by<F: Field>(make: impl Fn(&Section<'_>) -> F + Clone) -> impl Field<Value = F::Value> {
    let empty = make.clone();
    field(
        move |name, doc, keys| Section::empty(|section| empty(section).declare(name, doc, keys)),
        move |name, section| make(section).read(name, section),
    )
}
