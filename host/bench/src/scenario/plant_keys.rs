//! The keys that a plant model declares.

use lashloop_plant::{Key, KeyKind, PlantValue, PlantValues};

use super::declare::{Field, any_text, integer, name_of, number, section_of, texts};
use super::key::{Choice, Further, Keys, Selector};
use super::reader::Section;
use super::spelling::with_unit;
use super::tree::{Node, Value};

/// Adds the keys of a model.
pub(super) fn declare(model: &[Key], keys: &mut Keys) {
    let declare =
        |key: &Key, keys: &mut Keys| with_field(key, |field| field.declare(key.name, key.meaning, keys));
    for key in model.iter().filter(|key| key.only_with.is_none()) {
        declare(key, keys);
        let KeyKind::Choice(names) = key.kind else { continue };
        let added = |name| model.iter().filter(move |other| other.only_with == Some((key.name, name)));
        if names.iter().any(|name| added(*name).next().is_some()) {
            let variant = |name: &&'static str| {
                (*name, Keys::of(|keys| added(*name).for_each(|other| declare(other, keys))))
            };
            let variants = names.iter().map(variant).collect();
            keys.selectors.push(Selector { key: key.name, variants, names_owner: true });
        }
    }
}

/// Reads the values of `keys`, each with its default if it is absent.
pub(super) fn read(plant: &mut Section<'_>, keys: &[Key]) -> PlantValues {
    let mut values = PlantValues::default();
    for key in keys {
        let is_other = |(choice, owner)| values.text(choice).is_ok_and(|chosen| chosen != owner);
        if !key.only_with.is_some_and(is_other) {
            values.insert(key.name, with_field(key, |field| field.read(key.name, plant)));
        }
    }
    for key in keys {
        if let Some(least) = key.at_least {
            check_order(plant, key, least, &values);
        }
    }
    values
}

/// Calls `use_it` with the key as a field.
fn with_field<T>(key: &Key, use_it: impl FnOnce(&dyn Field<Value = PlantValue>) -> T) -> T {
    match &key.kind {
        KeyKind::Number { default, range } => {
            let number = number(range.clone()).in_unit(key.unit).with_default(*default);
            use_it(&number.map(|number, _| PlantValue::Number(number)))
        }
        KeyKind::Integer { default, range } => {
            let number = integer(range.clone()).in_unit(key.unit).with_default(*default);
            use_it(&number.map(|number, _| PlantValue::Integer(number.into())))
        }
        KeyKind::Choice(names) => {
            let choices = names.iter().map(|name| Choice { name, doc: "" }).collect();
            let default = names.first().map(|name| (*name).to_owned());
            use_it(&name_of(choices).with_default(default).map(|name, _| PlantValue::Text(name)))
        }
        KeyKind::Text => use_it(&any_text().map(|text, _| PlantValue::Text(text.unwrap_or_default()))),
        KeyKind::Texts => use_it(&texts("a list of texts in quotes, at least one").map(|texts, plant| {
            if texts.is_empty() {
                plant.reject(key.name, "is empty; it must have at least one text");
            }
            PlantValue::List(texts.into_iter().map(PlantValue::Text).collect())
        })),
        // It is passed on as it is.
        KeyKind::Table => {
            use_it(&section_of(|keys| keys.further = Further::Anything, |table| free(table.all())))
        }
    }
}

fn free<'a>(entries: impl Iterator<Item = (&'a str, &'a Node)>) -> PlantValue {
    PlantValue::Table(entries.map(|(name, node)| (name.to_owned(), free_value(&node.value))).collect())
}

fn free_value(value: &Value) -> PlantValue {
    match value {
        Value::Text(text) | Value::Date(text) => PlantValue::Text(text.clone()),
        Value::Integer(number) => PlantValue::Integer(*number),
        Value::Float(number) => PlantValue::Number(*number),
        Value::Boolean(boolean) => PlantValue::Boolean(*boolean),
        Value::Array(items) => PlantValue::List(items.iter().map(|item| free_value(&item.value)).collect()),
        Value::Table(table) => free(table.iter()),
    }
}

/// Checks that a number is not below another one. The error names the key that the scenario gives: the other may be a
/// default.
fn check_order(plant: &Section<'_>, key: &Key, least: &'static str, values: &PlantValues) {
    let (Ok(more), Ok(less)) = (values.number(key.name), values.number(least)) else { return };
    let bound = |number: f64| with_unit(number.to_string(), key.unit);
    if more < less && plant.has(key.name) {
        plant.reject(key.name, format!("is less than {least}; it must be >= {}", bound(less)));
    } else if more < less {
        plant.reject(least, format!("is more than {}; it must be <= {}", key.name, bound(more)));
    }
}
