//! Reads the keys that a plant model declares.

use lashloop_plant::{Key, KeyKind, PlantValue, PlantValues};

use super::key::Further;
use super::reader::Section;
use super::spelling::with_unit;
use super::tree::{Node, Value};

/// Reads the values of `keys`, each with its default if it is absent.
pub(super) fn read(plant: &mut Section<'_>, keys: &[Key]) -> PlantValues {
    let mut values = PlantValues::default();
    for key in keys {
        match key.only_with {
            Some((choice, owner)) => match values.text(choice) {
                Ok(chosen) if chosen != owner => {
                    let chosen = chosen.to_owned();
                    plant.belongs_to(choice, owner, &chosen, |section| read_value(section, key));
                }
                _ => values.insert(key.name, read_value(plant, key)),
            },
            None => values.insert(key.name, read_value(plant, key)),
        }
    }
    for key in keys {
        if let Some(least) = key.at_least {
            check_order(plant, key, least, &values);
        }
    }
    values
}

fn read_value(plant: &mut Section<'_>, key: &Key) -> PlantValue {
    plant.doc(key.meaning).unit(key.unit);
    match &key.kind {
        KeyKind::Number { default, range } => {
            PlantValue::Number(plant.number(key.name, *default, range.clone()))
        }
        KeyKind::Integer { default, range } => {
            PlantValue::Integer(plant.integer(key.name, *default, range.clone()).into())
        }
        KeyKind::Choice(names) => {
            let default = names.first().copied();
            let choices: Vec<_> = names.iter().map(|name| (*name, *name)).collect();
            let chosen = plant.choice(key.name, default, &choices).or(default);
            PlantValue::Text(chosen.unwrap_or_default().to_owned())
        }
        KeyKind::Text => PlantValue::Text(plant.text(key.name, None).map(str::to_owned).unwrap_or_default()),
        KeyKind::Texts => {
            let texts = plant.texts(key.name, Some("a list of texts in quotes, at least one"));
            if texts.as_ref().is_some_and(Vec::is_empty) {
                plant.reject(key.name, "is empty; it must have at least one text".to_owned());
            }
            let texts = texts.unwrap_or_default();
            PlantValue::List(texts.into_iter().map(|text| PlantValue::Text(text.to_owned())).collect())
        }
        KeyKind::Table => plant.section(key.name, |section| free(section.all(Further::Anything))),
    }
}

/// A table that is passed on as it is.
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
    if more < less && plant.node(key.name).is_some() {
        plant.reject(key.name, format!("is less than {least}; it must be >= {}", bound(less)));
    } else if more < less {
        plant.reject(least, format!("is more than {}; it must be <= {}", key.name, bound(more)));
    }
}
