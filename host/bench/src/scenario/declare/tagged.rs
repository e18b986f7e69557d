//! A choice whose names have keys of their own, next to it in its section.

use super::field::{Field, Variants, field};
use super::single::name_of;
use crate::scenario::key::{Choice, Keys, Selector};

/// A choice that decides on further keys of its section. A faulty choice is `None`. If it `names_owner`, the error for a key
/// of another name says whose key it is.
pub fn tagged<V: Variants>(names_owner: bool) -> impl Field<Value = Option<V>> {
    let declare = move |name, doc, keys: &mut Keys| {
        name_of(V::choices()).declare(name, doc, keys);
        let variant = |Choice { name, .. }: Choice| {
            let mut keys = Keys::default();
            V::declare(name, &mut keys);
            (name, keys)
        };
        let variants = V::choices().into_iter().map(variant).collect();
        keys.selectors.push(Selector { key: name, variants, names_owner });
    };
    field(declare, |name, section| {
        let chosen = name_of(V::choices()).find(name, section);
        let variant = chosen.and_then(|chosen| V::read(&chosen, section));
        if variant.is_none() {
            section.accept_the_rest();
        }
        variant
    })
}
