//! Keys of a section as values: how each is read, and with it described.

use crate::scenario::key::Choice;
use crate::scenario::reader::Section;

/// A key of a section, or several keys that are one value.
pub trait Field {
    /// What is read.
    type Value;

    /// Reads the key of this name and meaning.
    fn read(&self, name: &'static str, doc: &'static str, section: &mut Section<'_>) -> Self::Value;

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
    /// Reads the keys.
    fn read(section: &mut Section<'_>) -> Self;
}

/// A choice whose names have keys of their own. [`settings!`](crate::settings) implements it.
pub trait Variants: Sized {
    /// The names.
    fn choices() -> Vec<Choice>;

    /// The name of a value, as files spell it.
    fn name(&self) -> &'static str;

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

    fn read(&self, name: &'static str, doc: &'static str, section: &mut Section<'_>) -> T {
        let value = self.field.read(name, doc, section);
        (self.convert)(value, section)
    }
}

/// A field of a function.
struct Made<R>(R);

impl<T, R: Fn(&'static str, &'static str, &mut Section<'_>) -> T> Field for Made<R> {
    type Value = T;

    fn read(&self, name: &'static str, doc: &'static str, section: &mut Section<'_>) -> T {
        self.0(name, doc, section)
    }
}

/// A field that `read` reads, with its name and meaning.
pub(in crate::scenario) fn field<T>(
    read: impl Fn(&'static str, &'static str, &mut Section<'_>) -> T,
) -> impl Field<Value = T> {
    Made(read)
}

/// A section with the keys that `read` looks up. An absent one reads as its defaults.
pub fn section_of<T>(read: impl Fn(&mut Section<'_>) -> T) -> impl Field<Value = T> {
    field(move |name, doc, section| section.section(name, doc, &read))
}

fn converted<S: Settings, T>(convert: impl Fn(S, &mut Section<'_>) -> T) -> impl Fn(&mut Section<'_>) -> T {
    move |section| {
        let settings = S::read(section);
        convert(settings, section)
    }
}

/// A section. `convert` may report what is wrong with its keys together.
pub fn section<S: Settings, T>(convert: impl Fn(S, &mut Section<'_>) -> T) -> impl Field<Value = T> {
    section_of(converted(convert))
}

/// A list of sections. An absent list is empty.
pub fn sections<S: Settings, T>(convert: impl Fn(S, &mut Section<'_>) -> T) -> impl Field<Value = Vec<T>> {
    let read = converted(convert);
    field(move |name, doc, section| section.sections(name, doc, &read))
}

/// Several keys of one section as one value.
pub fn flat<S: Settings, T>(convert: impl Fn(S, &mut Section<'_>) -> T) -> impl Field<Value = T> {
    let read = converted(convert);
    field(move |_, _, section| read(section))
}

/// The keys of a section as they are, for [`section`] and [`sections`].
#[must_use]
pub fn plain<S>(settings: S, _: &mut Section<'_>) -> S {
    settings
}

/// No key: a field that files don't have.
pub fn skipped<T>(make: impl Fn(&Section<'_>) -> T) -> impl Field<Value = T> {
    field(move |_, _, section| make(section))
}

/// A key that depends on other keys of its section. Documents have it as in an empty section.
pub fn by<F: Field>(make: impl Fn(&Section<'_>) -> F) -> impl Field<Value = F::Value> {
    field(move |name, doc, section| make(section).read(name, doc, section))
}
