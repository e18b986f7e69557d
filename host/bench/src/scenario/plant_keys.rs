//! The keys that a plant model declares.

use lashloop_plant::{Key, KeyKind, PlantValue, PlantValues};

use super::declare::{Field as _, any_text, integer, name_of, number, text, texts};
use super::key::{Choice, Further, Selector};
use super::reader::Section;
use super::spelling::with_unit;
use super::tree::{Node, Value};

/// Adds the keys of a model to a section that is being described.
pub(super) fn describe(plant: &mut Section<'_>, model: &[Key]) {
    for key in model.iter().filter(|key| key.only_with.is_none()) {
        read_key(plant, key);
        let KeyKind::Choice(names) = key.kind else { continue };
        let added = |name| model.iter().filter(move |other| other.only_with == Some((key.name, name)));
        if names.iter().any(|name| added(*name).next().is_some()) {
            let read = |plant: &mut Section<'_>, name| added(name).for_each(|key| drop(read_key(plant, key)));
            let variant = |name: &&'static str| (*name, Section::keys_of(|plant| read(plant, *name)));
            let variants = names.iter().map(variant).collect();
            plant.describe(|keys| {
                keys.selectors.push(Selector { key: key.name, variants, names_owner: true });
            });
        }
    }
}

/// Reads the values of `keys`, each with its default if it is absent.
pub(super) fn read(plant: &mut Section<'_>, keys: &[Key]) -> PlantValues {
    let mut values = PlantValues::default();
    for key in keys {
        let is_other = |(choice, owner)| values.text(choice).is_ok_and(|chosen| chosen != owner);
        if !key.only_with.is_some_and(is_other) {
            values.insert(key.name, read_key(plant, key));
        }
    }
    for key in keys {
        if let Some(least) = key.at_least {
            check_order(plant, key, least, &values);
        }
    }
    values
}

fn read_key(plant: &mut Section<'_>, key: &Key) -> PlantValue {
    let (name, doc) = (key.name, key.meaning);
    match &key.kind {
        KeyKind::Number { default, range } => {
            let number = number(range.clone()).in_unit(key.unit).with_default(*default);
            PlantValue::Number(number.read(name, doc, plant))
        }
        KeyKind::Integer { default, range } => {
            let number = integer(range.clone()).in_unit(key.unit).with_default(*default);
            PlantValue::Integer(number.read(name, doc, plant).into())
        }
        KeyKind::Choice(names) => {
            let choices = names.iter().map(|name| Choice { name, doc: "" }).collect();
            let default = names.first().map(|name| (*name).to_owned());
            PlantValue::Text(name_of(choices).with_default(default).read(name, doc, plant))
        }
        KeyKind::Text { is_required: true } => {
            PlantValue::Text(text("a text in quotes").read(name, doc, plant))
        }
        KeyKind::Text { .. } => PlantValue::Text(any_text().read(name, doc, plant).unwrap_or_default()),
        KeyKind::Texts { is_required: false } => {
            let texts = texts("a list of texts in quotes").optional().read(name, doc, plant);
            PlantValue::List(texts.unwrap_or_default().into_iter().map(PlantValue::Text).collect())
        }
        KeyKind::Texts { .. } => {
            let texts = texts("a list of texts in quotes, at least one").read(name, doc, plant);
            if texts.is_empty() {
                plant.reject(name, "is empty; it must have at least one text");
            }
            PlantValue::List(texts.into_iter().map(PlantValue::Text).collect())
        }
        // It is passed on as it is.
        KeyKind::Table => plant.section(name, doc, &|table: &mut Section<'_>| {
            table.describe(|keys| keys.further = Further::Anything);
            free(table.all())
        }),
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
