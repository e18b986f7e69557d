//! The keys as a page in Markdown.

use std::fmt::Write;

use crate::scenario::key::{Choice, Further, Key, KeyKind, Keys};
use crate::scenario::spelling::{either, spell_number};
use crate::scenario::tree::Value;

const BEGINNING: &str = "\
# Scenarios

A scenario is a TOML file: what to run, and what to expect. This page lists every key. It is generated from the declarations
that the reader of scenarios uses, by `cargo run -p lashloop-bench --example scenario_documents`; changes belong there. `lashloop
show --keys` prints it, with the plants of your own program too.

- Each key has its unit in its name. The reader rejects an unknown key, a value out of range and a key of another choice, each with
  file, line, allowed values and remedy. It reports all errors at once.
- `--set SECTION.KEY=VALUE` replaces or adds a value for one run, and `lashloop show FILE` prints a scenario with every default.
- A whole number may also be written as `1e3`.
- [scenario.schema.json](scenario.schema.json) has the same keys as a JSON Schema. With `#:schema` and its path in the first line of a
  scenario, editors with Taplo, such as VS Code with Even Better TOML, complete and check keys.
- \"Needed\" in the column of defaults marks a key that a scenario has to give; a dash marks one that may be absent.
";

impl Keys {
    /// The page `docs/scenarios.md`.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        self.to_page(BEGINNING)
    }

    /// A page that begins with this text.
    #[must_use]
    pub fn to_page(&self, beginning: &str) -> String {
        let mut page = beginning.to_owned();
        page.push_str("\n## Without a section\n");
        section(&mut page, self, "", &[]);
        page
    }
}

/// A key with the choices on which it depends, each as `key = \"name\"`.
struct Row<'a> {
    key: &'a Key,
    /// Alternatives; empty for a key that the section always has.
    conditions: Vec<Condition>,
}

/// A choice and its name, after those that the choice itself depends on.
type Condition = Vec<(&'static str, &'static str)>;

/// Alternatives in words; those that differ in the last name only are one.
fn spell(conditions: &[Condition]) -> String {
    let mut spelled: Vec<String> = Vec::new();
    let mut last: Option<(&[(&str, &str)], &str)> = None;
    for condition in conditions {
        let Some(((key, name), before)) = condition.split_last() else { continue };
        match spelled.last_mut() {
            Some(text) if last == Some((before, key)) => text.push_str(&format!(", `\"{name}\"`")),
            _ => {
                let before: String =
                    before.iter().map(|(key, name)| format!("`{key} = \"{name}\"` and ")).collect();
                spelled.push(format!("{before}`{key} = \"{name}\"`"));
            }
        }
        last = Some((before, key));
    }
    spelled.join("; ")
}

fn section(page: &mut String, keys: &Keys, path: &str, outer: &[Condition]) {
    let mut rows = Vec::new();
    collect(keys, &[], &mut rows);
    let is_value = |row: &&Row<'_>| !matches!(row.key.kind, KeyKind::Section(_) | KeyKind::Sections(_));
    let (always, depending): (Vec<_>, Vec<_>) =
        rows.iter().filter(is_value).partition(|row| row.conditions.is_empty());
    if !always.is_empty() {
        page.push_str("\n| key | value | unit | default | meaning |\n|---|---|---|---|---|\n");
        for row in always {
            line(page, row.key, None);
        }
    }
    match keys.further {
        Further::Rejected => {}
        Further::Values => {
            page.push_str("\nAny key with a number, a boolean or a text; the drive checks it.\n");
        }
        Further::Anything => page.push_str("\nAny key with any value.\n"),
    }
    if !depending.is_empty() {
        page.push_str(
            "\n| only with | key | value | unit | default | meaning |\n|---|---|---|---|---|---|\n",
        );
        for row in depending {
            line(page, row.key, Some(&row.conditions));
        }
    }
    for row in rows.iter().filter(|row| row.conditions.is_empty()) {
        if let KeyKind::Choice(choices) | KeyKind::Choices(choices) = &row.key.kind {
            names(page, row.key.name, choices);
        }
    }
    for Row { key, conditions } in &rows {
        let (inside, brackets) = match &key.kind {
            KeyKind::Section(inside) => (inside, ["[", "]"]),
            KeyKind::Sections(inside) => (inside, ["[[", "]]"]),
            _ => continue,
        };
        let path = if path.is_empty() { key.name.to_owned() } else { format!("{path}.{}", key.name) };
        let [open, close] = brackets;
        page.push_str(&format!("\n## `{open}{path}{close}`\n"));
        if !key.doc.is_empty() {
            page.push_str(&format!("\n{}\n", key.doc));
        }
        let conditions = if conditions.is_empty() { outer } else { conditions };
        if !conditions.is_empty() {
            page.push_str(&format!("\nOnly with {}.\n", spell(conditions)));
        }
        section(page, inside, &path, conditions);
    }
}

/// All keys, equal ones of several variants as one row.
fn collect<'a>(keys: &'a Keys, condition: &[(&'static str, &'static str)], rows: &mut Vec<Row<'a>>) {
    for key in &keys.keys {
        match rows.iter_mut().find(|row| row.key == key && !row.conditions.is_empty()) {
            Some(row) => row.conditions.push(condition.to_vec()),
            None => rows.push(Row {
                key,
                conditions: if condition.is_empty() { Vec::new() } else { vec![condition.to_vec()] },
            }),
        }
    }
    for selector in &keys.selectors {
        for (name, variant) in &selector.variants {
            collect(variant, &[condition, &[(selector.key, *name)]].concat(), rows);
        }
    }
}

fn line(page: &mut String, key: &Key, conditions: Option<&[Condition]>) {
    let first = conditions.map_or(String::new(), |conditions| format!("| {} ", spell(conditions)));
    let Key { name, doc, unit, .. } = key;
    // Writing to a String can't fail.
    let _ = writeln!(page, "{first}| `{name}` | {} | {unit} | {} | {doc} |", value(key), default(key));
}

/// Values that a key takes, in words.
fn value(key: &Key) -> String {
    match &key.kind {
        KeyKind::Number(range) => format!("number {}", range.describe("")),
        KeyKind::WholeNumber { low, high } if *high == i64::MAX.into() => format!("whole number >= {low}"),
        KeyKind::WholeNumber { low, high } => format!("whole number >= {low} and <= {high}"),
        KeyKind::Text { .. } => "text".to_owned(),
        KeyKind::Texts { .. } => "list of texts".to_owned(),
        KeyKind::Values => "list of numbers, booleans or texts".to_owned(),
        KeyKind::Choice(choices) => either(choices.iter().map(|choice| choice.name)),
        KeyKind::Choices(choices) => format!("list of {}", either(choices.iter().map(|choice| choice.name))),
        KeyKind::Section(_) => "section".to_owned(),
        KeyKind::Sections(_) => "list of sections".to_owned(),
    }
}

fn default(key: &Key) -> String {
    match &key.default {
        Some(Value::Float(number)) => spell_number(*number),
        Some(Value::Integer(number)) => number.to_string(),
        Some(Value::Text(name)) => format!("`\"{name}\"`"),
        _ if key.required => "needed".to_owned(),
        _ => "-".to_owned(),
    }
}

/// The names that a choice takes, if they have meanings.
fn names(page: &mut String, key: &str, choices: &[Choice]) {
    if choices.iter().all(|choice| choice.doc.is_empty()) {
        return;
    }
    let _ = writeln!(page, "\n| `{key}` | meaning |\n|---|---|");
    for Choice { name, doc } in choices {
        let _ = writeln!(page, "| `\"{name}\"` | {doc} |");
    }
}
