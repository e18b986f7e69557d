//! The keys as a JSON Schema for editors.
//!
//! Each section lists every key that it can have, so that editors complete them; `allOf` narrows the keys to those of the choices
//! made. The schema has types, ranges, names, required and unknown keys. Rules between keys, such as a fault after the end of the
//! run, are the reader's alone. We use no keyword that changed its meaning between draft 7 and draft 2020-12, because editors
//! differ in the drafts that they support.

use serde_json::{Map, Value as Json, json};

use crate::scenario::key::{Further, Key, KeyKind, Keys, Selector};
use crate::scenario::spelling::with_unit;
use crate::scenario::tree::Value;

impl Keys {
    /// The schema `docs/scenario.schema.json`.
    #[must_use]
    pub fn to_json_schema(&self) -> Json {
        self.to_json_schema_of("Lashloop scenario")
    }

    /// The schema of files of this kind.
    #[must_use]
    pub fn to_json_schema_of(&self, title: &str) -> Json {
        let mut schema = section(self);
        schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
        schema["title"] = json!(title);
        schema
    }
}

fn section(keys: &Keys) -> Json {
    let mut properties: Map<String, Json> = Map::new();
    let mut names: Vec<_> = keys.all().map(|key| key.name).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let mut variants: Vec<Json> = Vec::new();
        for key in keys.all().filter(|key| key.name == name) {
            let variant = property(key);
            if !variants.contains(&variant) {
                variants.push(variant);
            }
        }
        let property = if variants.len() == 1 { variants.remove(0) } else { json!({ "anyOf": variants }) };
        properties.insert(name.to_owned(), property);
    }
    let further = match keys.further {
        Further::Rejected => json!(false),
        Further::Values => json!({ "type": ["number", "boolean", "string"] }),
        Further::Anything => json!(true),
    };
    let mut schema = json!({ "type": "object", "properties": properties, "additionalProperties": further });
    constrain(&mut schema, keys);
    schema
}

/// Adds what these keys require, and what each of their choices requires and excludes.
fn constrain(schema: &mut Json, keys: &Keys) {
    let is_required =
        |key: &&Key| key.required || matches!(&key.kind, KeyKind::Section(inside) if inside.is_required());
    let required: Vec<_> = keys.keys.iter().filter(is_required).map(|key| key.name).collect();
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    let conditions: Vec<_> = keys.selectors.iter().flat_map(|selector| conditions(keys, selector)).collect();
    if !conditions.is_empty() {
        schema["allOf"] = json!(conditions);
    }
}

/// One condition for each name of a choice.
fn conditions(keys: &Keys, selector: &Selector) -> Vec<Json> {
    let chooser = keys.keys.iter().find(|key| key.name == selector.key);
    let default = chooser.and_then(|key| key.default.as_ref()?.text());
    let condition = |(name, variant): &(&'static str, Keys)| {
        let mut then = json!({ "properties": {} });
        for key in selector.variants.iter().flat_map(|(_, keys)| keys.all()) {
            then["properties"][key.name] = json!(false);
        }
        for key in variant.all() {
            then["properties"][key.name] = property(key);
        }
        constrain(&mut then, variant);
        let mut applies = json!({ "properties": { selector.key: { "const": name } } });
        if default != Some(*name) {
            applies["required"] = json!([selector.key]);
        }
        json!({ "if": applies, "then": then })
    };
    selector.variants.iter().map(condition).collect()
}

fn property(key: &Key) -> Json {
    let mut schema = match &key.kind {
        KeyKind::Number(range) => {
            let least = if range.low_is_allowed { "minimum" } else { "exclusiveMinimum" };
            json!({ "type": "number", least: range.low, "maximum": range.high })
        }
        KeyKind::WholeNumber { low, high } => {
            let [low, high] = [low, high].map(|end| i64::try_from(*end).unwrap_or(i64::MAX));
            json!({ "type": "integer", "minimum": low, "maximum": high })
        }
        KeyKind::Text { .. } => json!({ "type": "string" }),
        KeyKind::Texts { .. } => json!({ "type": "array", "items": { "type": "string" } }),
        KeyKind::Values => json!({ "type": "array", "items": { "type": ["number", "boolean", "string"] } }),
        KeyKind::Choice(choices) => {
            let names: Vec<_> = choices.iter().map(|choice| choice.name).collect();
            json!({ "enum": names })
        }
        KeyKind::Choices(choices) => {
            let names: Vec<_> = choices.iter().map(|choice| choice.name).collect();
            let name = json!({ "enum": names });
            json!({ "anyOf": [name.clone(), { "type": "array", "items": name, "uniqueItems": true }] })
        }
        KeyKind::Section(inside) => section(inside),
        KeyKind::Sections(inside) => json!({ "type": "array", "items": section(inside) }),
    };
    let unit =
        if key.unit.is_empty() { String::new() } else { with_unit(" Unit:".to_owned(), key.unit) + "." };
    match &key.default {
        Some(Value::Float(number)) => schema["default"] = json!(number),
        Some(Value::Integer(number)) => schema["default"] = json!(number),
        Some(Value::Text(name)) => schema["default"] = json!(name),
        _ => {}
    }
    schema["description"] = json!(format!("{}{unit}", key.doc));
    schema
}
