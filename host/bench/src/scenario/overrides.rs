//! Options of the command line that replace values of a scenario: `--set section.key=value`, `--controller NAME` and
//! `--mode MODE`.
//!
//! They replace values of the tree before the reader validates them, so that an overriding value is checked like any other,
//! and its errors name the option.

use std::fmt;
use std::sync::Arc;

use super::error::ScenarioError;
use super::file::without_mark;
use super::key::Keys;
use super::origin::Origin;
use super::spelling::{nearest, spell_key};
use super::tree::{Node, Table, Value, parse_file, parse_value};

/// Depth of the deepest key, such as `plant.initial.load_position_rad`.
const DEEPEST: usize = 3;

/// One replacement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Override {
    /// `--set section.key=value`. The value is TOML; anything else is a text, so that names need no quotes. A section of a list is named by its index from 0: `expect.0.max=5.5`.
    Set(String),
    /// `--controller NAME`, short for `--set controller.name=NAME`.
    Controller(String),
    /// `--mode MODE`, short for `--set run.mode=MODE`.
    Mode(String),
}

impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Set(assignment) => write!(f, "--set {assignment}"),
            Self::Controller(name) => write!(f, "--controller {name}"),
            Self::Mode(mode) => write!(f, "--mode {mode}"),
        }
    }
}

impl Override {
    /// Replaces or adds the value in `root`. The reader rejects unknown keys. `known` gives those that it reads.
    pub(super) fn apply(&self, root: &mut Table, known: &dyn Fn() -> Keys) -> Result<(), ScenarioError> {
        let option: Arc<str> = self.to_string().into();
        let origin = Origin::Option(option.clone());
        let (path, value) = match self {
            Self::Controller(name) => ("controller.name", Ok(Value::Text(name.clone()))),
            Self::Mode(mode) => ("run.mode", Ok(Value::Text(mode.clone()))),
            Self::Set(assignment) => match assignment.split_once('=') {
                Some((path, text)) => (path.trim(), read_value(text.trim(), &origin)),
                None => ("", Err("it must be section.key=value".to_owned())),
            },
        };
        let placed = value.and_then(|value| {
            let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_';
            if root.get(path).is_none() && !path.is_empty() && path.chars().all(is_bare) {
                needs_no_section(path, &known())?;
            }
            place(root, path, Node { origin, value })
        });
        placed.map_err(|reason| ScenarioError::Option { option, reason })
    }
}

/// Reads a text and applies `overrides` in their order. The second value has the overrides that can't be applied.
pub(super) fn read_tree(
    file: &Arc<str>,
    text: &str,
    overrides: &[Override],
    known: &dyn Fn() -> Keys,
) -> Result<(Table, Vec<ScenarioError>), ScenarioError> {
    let mut tree = parse_file(file, without_mark(text))?;
    let errors = overrides.iter().filter_map(|option| option.apply(&mut tree, known).err()).collect();
    Ok((tree, errors))
}

/// A key without a section must be one of the few keys that have none.
fn needs_no_section(key: &str, known: &Keys) -> Result<(), String> {
    if known.keys.iter().any(|known| known.name == key) {
        return Ok(());
    }
    let paths = known.paths_of(key);
    if paths.is_empty() && nearest(key, known.keys.iter().map(|known| known.name)).is_some() {
        return Ok(());
    }
    let parameter = format!("controller.parameters.{}", spell_key(key));
    let paths: String = paths.iter().map(|path| format!("{path} or ")).collect();
    Err(format!("the key has no section; write {paths}{parameter} (a parameter of the drive)"))
}

/// A TOML value, or a text without quotes.
fn read_value(text: &str, origin: &Origin) -> Result<Value, String> {
    if text.is_empty() {
        return Err("there is no value after the =; an empty text is \"\"".to_owned());
    }
    let meant_as_toml = text.starts_with(['"', '\'', '[', '{']);
    match parse_value(text, origin) {
        Err(_) if !meant_as_toml => Ok(Value::Text(text.to_owned())),
        result => result,
    }
}

/// Puts a value at a path such as `plant.initial.load_position_rad`, of which the sections may be absent.
pub(super) fn place(root: &mut Table, path: &str, node: Node) -> Result<(), String> {
    let steps: Vec<_> = path.split('.').collect();
    if steps.iter().any(|step| step.is_empty()) {
        return Err("the key is incomplete; it must be section.key=value".to_owned());
    }
    let (Some((key, sections)), true) = (steps.split_last(), steps.len() <= DEEPEST) else {
        return Err(format!("no key lies deeper than {DEEPEST} levels; it must be section.key=value"));
    };
    let mut table = root;
    let mut walked = sections.iter();
    while let Some(&name) = walked.next() {
        if table.get(name).is_none() {
            table.insert(name, Node { origin: node.origin.clone(), value: Value::Table(Table::default()) });
        }
        let mut value = table.get_mut(name).map(|node| &mut node.value);
        if let Some(Value::Array(items)) = value {
            let count = items.len();
            let index = walked.next().ok_or_else(|| format!("{name} is a list; write {name}.0.{key}"))?;
            let item = index.parse::<usize>().ok().and_then(|index| items.get_mut(index));
            value = Some(&mut item.ok_or_else(|| no_such_item(name, index, count))?.value);
        }
        let Some(Value::Table(next)) = value else {
            return Err(format!("{name} isn't a section, so it has no key {key}"));
        };
        table = next;
    }
    table.insert(key, node);
    Ok(())
}

fn no_such_item(name: &str, index: &str, count: usize) -> String {
    match count.checked_sub(1) {
        Some(last) => format!("there is no {name}.{index}; the index must be >= 0 and <= {last}"),
        None => format!("there is no {name}.{index}; the list is empty"),
    }
}
