//! Values without a fixed shape: lists of texts, and tables that are passed on as they are.

use std::collections::BTreeMap;

use lashloop_plant::PlantValue;

use super::section::Section;
use crate::scenario::tree::{Node, Table, Value};

impl Section<'_> {
    /// A required list of texts, at least one; empty if absent or faulty.
    pub(in crate::scenario) fn texts(&mut self, key: &'static str) -> Vec<String> {
        let allowed = "a list of texts in quotes, at least one".to_owned();
        let Some(node) = self.look_up(key, "", Some(allowed.clone())) else { return Vec::new() };
        let items = if let Value::Array(items) = &node.value { &items[..] } else { &[] };
        let text = |item: &Node| if let Value::Text(text) = &item.value { Some(text.clone()) } else { None };
        let texts: Vec<_> = items.iter().map_while(text).collect();
        if texts.is_empty() || texts.len() < items.len() {
            self.wrong_type(key, items.get(texts.len()).unwrap_or(node), allowed);
            return Vec::new();
        }
        texts
    }

    /// A section whose keys the bench does not know; empty if absent.
    pub(in crate::scenario) fn free_table(&mut self, key: &'static str) -> BTreeMap<String, PlantValue> {
        let Some(node) = self.look_up(key, "", None) else { return BTreeMap::new() };
        if let Value::Table(table) = &node.value {
            return free(table);
        }
        self.wrong_type(key, node, "a section".to_owned());
        BTreeMap::new()
    }
}

fn free(table: &Table) -> BTreeMap<String, PlantValue> {
    table.iter().map(|(name, node)| (name.to_owned(), free_value(&node.value))).collect()
}

fn free_value(value: &Value) -> PlantValue {
    match value {
        Value::Text(text) | Value::Date(text) => PlantValue::Text(text.clone()),
        Value::Integer(number) => PlantValue::Integer(*number),
        Value::Float(number) => PlantValue::Number(*number),
        Value::Boolean(boolean) => PlantValue::Boolean(*boolean),
        Value::Array(items) => PlantValue::List(items.iter().map(|item| free_value(&item.value)).collect()),
        Value::Table(table) => PlantValue::Table(free(table)),
    }
}
