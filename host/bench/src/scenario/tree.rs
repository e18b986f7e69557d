//! A TOML document as a tree of values, each with its origin.
//!
//! Options of the command line replace values in the tree before the reader reads it, so that every value keeps its origin.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use toml_edit::{Document, Item, TableLike, TomlError};

use super::error::ScenarioError;
use super::origin::Origin;
use super::spelling::{decimal_point, spell_number, spell_text};

/// A value with its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    pub(super) origin: Origin,
    pub(super) value: Value,
}

/// A TOML value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Date(String),
    Array(Vec<Node>),
    Table(Table),
}

/// The keys of a section, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table(Vec<(String, Node)>);

impl Table {
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        self.0.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// The value at a path such as `plant.initial.load_position_rad` or `fault.0.kind`.
    pub(super) fn find(&self, path: &str) -> Option<&Node> {
        let mut steps = path.split('.');
        let mut node = self.get(steps.next()?)?;
        for step in steps {
            node = match &node.value {
                Value::Table(table) => table.get(step)?,
                Value::Array(items) => items.get(step.parse::<usize>().ok()?)?,
                _ => return None,
            };
        }
        Some(node)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, &Node)> {
        self.0.iter().map(|(name, node)| (name.as_str(), node))
    }

    pub(super) fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.0.iter_mut().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// Takes a key out.
    pub(super) fn remove(&mut self, key: &str) -> Option<Node> {
        let index = self.0.iter().position(|(name, _)| name == key)?;
        Some(self.0.remove(index).1)
    }

    /// Replaces the value of `key`, or adds the key.
    pub(super) fn insert(&mut self, key: &str, node: Node) {
        match self.get_mut(key) {
            Some(old) => *old = node,
            None => self.0.push((key.to_owned(), node)),
        }
    }
}

impl Node {
    pub(super) fn text(&self) -> Option<&str> {
        self.value.text()
    }

    pub(super) fn table(&self) -> Option<&Table> {
        if let Value::Table(table) = &self.value { Some(table) } else { None }
    }

    /// The items of a list; of any other value the value alone.
    pub(super) fn items(&self) -> &[Self] {
        self.value.list().unwrap_or(std::slice::from_ref(self))
    }
}

/// Up to here a fraction holds every whole number.
const EXACT: f64 = (1_u64 << 53) as f64;

impl Value {
    pub(super) fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    pub(super) fn list(&self) -> Option<&[Node]> {
        if let Self::Array(items) = self { Some(items) } else { None }
    }

    /// A number, whole or not.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            // Exact up to 2^53, far beyond every range here.
            Self::Integer(number) => Some(*number as f64),
            Self::Float(number) => Some(*number),
            _ => None,
        }
    }

    /// A whole number, which may be written as 1e3; `Some(None)` for one that the reader of the file may have rounded.
    pub(super) fn whole_number(&self) -> Option<Option<i64>> {
        match self {
            Self::Integer(number) => Some(Some(*number)),
            Self::Float(number) if number.fract() == 0.0 => {
                Some((number.abs() <= EXACT).then_some(*number as i64))
            }
            _ => None,
        }
    }

    /// The type in words, to follow "is".
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "text",
            Self::Integer(_) => "a whole number",
            Self::Float(_) => "a fractional number",
            Self::Boolean(_) => "a boolean",
            Self::Date(_) => "a date",
            Self::Array(_) => "a list",
            Self::Table(_) => "a section",
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(&spell_text(text)),
            Self::Integer(number) => write!(f, "{number}"),
            // 3.0 keeps its point, because the point makes it a wrong type for a whole number.
            Self::Float(number) if number.abs() < 1e4 && number.fract() == 0.0 => write!(f, "{number:.1}"),
            Self::Float(number) => f.write_str(&spell_number(*number)),
            Self::Boolean(boolean) => write!(f, "{boolean}"),
            Self::Date(date) => f.write_str(date),
            Self::Array(items) => write!(f, "[{} items]", items.len()),
            Self::Table(table) => write!(f, "{{{} keys}}", table.0.len()),
        }
    }
}

/// Reads a whole file.
pub(super) fn parse_file(file: &Arc<str>, text: &str) -> Result<Table, ScenarioError> {
    let lines = Lines::new(text);
    let document = Document::parse(text).map_err(|error| {
        let span = error.span().unwrap_or_default();
        let (line, column) = lines.place(span.start);
        let value = text.lines().nth(line - 1).and_then(|line| line.split('#').next()?.split_once('='));
        if let Some(written) = value.and_then(|(_, value)| decimal_point(value.trim())) {
            let reason = format!("a number has a decimal point and no comma; write {written}");
            return ScenarioError::Syntax { file: file.clone(), line, column, reason };
        }
        let found = text.get(span).unwrap_or_default();
        let found = if found.is_empty() { String::new() } else { format!(" at {}", spell_text(found)) };
        ScenarioError::Syntax { file: file.clone(), line, column, reason: reason(&error) + &found }
    })?;
    let origin = |span: Option<Range<usize>>| {
        let (line, column) = lines.place(span.map_or(0, |span| span.start));
        Origin::File { file: file.clone(), line, column }
    };
    Ok(from_table(document.as_table(), &origin))
}

/// Reads the value of an option.
pub(super) fn parse_value(text: &str, origin: &Origin) -> Result<Value, String> {
    let value = text.parse::<toml_edit::Value>().map_err(|error| reason(&error))?;
    Ok(from_value(&value, &|_| origin.clone()))
}

/// The parser's reason on one line.
fn reason(error: &TomlError) -> String {
    error.message().lines().collect::<Vec<_>>().join("; ")
}

type FindOrigin<'a> = dyn Fn(Option<Range<usize>>) -> Origin + 'a;

fn from_table(table: &dyn TableLike, origin: &FindOrigin) -> Table {
    let entries = table.iter().filter_map(|(name, item)| {
        let span = table.key(name).and_then(toml_edit::Key::span).or_else(|| item.span());
        Some((name.to_owned(), Node { origin: origin(span), value: from_item(item, origin)? }))
    });
    Table(entries.collect())
}

fn from_item(item: &Item, origin: &FindOrigin) -> Option<Value> {
    match item {
        Item::None => None,
        Item::Value(value) => Some(from_value(value, origin)),
        Item::Table(table) => Some(Value::Table(from_table(table, origin))),
        Item::ArrayOfTables(tables) => {
            let nodes = tables.iter().map(|table| Node {
                origin: origin(table.span()),
                value: Value::Table(from_table(table, origin)),
            });
            Some(Value::Array(nodes.collect()))
        }
    }
}

fn from_value(value: &toml_edit::Value, origin: &FindOrigin) -> Value {
    match value {
        toml_edit::Value::String(text) => Value::Text(text.value().clone()),
        toml_edit::Value::Integer(number) => Value::Integer(*number.value()),
        toml_edit::Value::Float(number) => Value::Float(*number.value()),
        toml_edit::Value::Boolean(boolean) => Value::Boolean(*boolean.value()),
        toml_edit::Value::Datetime(date) => Value::Date(date.value().to_string()),
        toml_edit::Value::Array(items) => {
            let nodes = items
                .iter()
                .map(|item| Node { origin: origin(item.span()), value: from_value(item, origin) });
            Value::Array(nodes.collect())
        }
        toml_edit::Value::InlineTable(table) => Value::Table(from_table(table, origin)),
    }
}

/// Starts of lines, which turn the parser's byte offsets into lines and columns.
struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        let after_breaks = text.match_indices('\n').map(|(at, _)| at + 1);
        Self { text, starts: std::iter::once(0).chain(after_breaks).collect() }
    }

    /// Line and column of a byte offset, both counted from 1; the column in characters.
    fn place(&self, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|&start| start <= offset);
        let before = self.text.get(self.starts[line - 1]..offset).unwrap_or_default();
        (line, before.chars().count() + 1)
    }
}
