//! Reads the keys that a plant model declares.

use lashloop_plant::{Key, KeyKind, PlantValue, PlantValues};

use super::range::NumberRange;
use super::reader::Section;
use super::spelling::with_unit;

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
    match &key.kind {
        KeyKind::Number { default, range } => {
            PlantValue::Number(plant.number(key.name, *default, NumberRange::from(range.clone())))
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
        KeyKind::Texts => PlantValue::List(plant.texts(key.name).into_iter().map(PlantValue::Text).collect()),
        KeyKind::Table => PlantValue::Table(plant.free_table(key.name)),
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
