//! Files of settings that aren't scenarios, such as a rig file: the reader of scenarios reads them, so their errors, their
//! page of keys and their JSON Schema are of the same kind.

use std::path::Path;
use std::sync::Arc;

use super::error::ScenarioErrors;
use super::origin::Origin;
use super::reader::{Section, read_document};
use super::{file, tree};

/// The text of a file of settings. `kind` is what the file is in messages, such as `rig file`.
///
/// # Errors
/// The file can't be read, is larger than 1 MiB, or isn't a regular file of text in UTF-8.
pub fn read_text(path: &Path, kind: &str) -> Result<String, ScenarioErrors> {
    Ok(file::read(path, kind)?)
}

/// Reads a text with the keys that `read` looks up; `name` is the file's name in errors.
///
/// # Errors
/// The text isn't TOML, or has keys that are unknown, missing or out of range; all errors at once.
pub fn from_str<T>(
    name: &str,
    text: &str,
    read: impl Fn(&mut Section<'_>) -> T,
) -> Result<T, ScenarioErrors> {
    let file: Arc<str> = name.into();
    let tree = tree::parse_file(&file, file::without_mark(text))?;
    let document = read_document(&tree, Origin::File { file, line: 1, column: 1 }, read);
    if document.errors.is_empty() { Ok(document.result) } else { Err(document.errors.into()) }
}
