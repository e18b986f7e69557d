//! `scenario.toml`: the scenario with every key, which runs again as it is.

use std::io::Write;
use std::path::Path;

use lashloop_bench::atomic_file::{WriteError, write_whole};
use lashloop_bench::scenario::Scenario;
use lashloop_plant::reference::Reference;
use toml_edit::{DocumentMut, value};

use crate::file_names::{REFERENCE_FILE, SCENARIO_FILE};

/// The resolved scenario as files of one folder: their names and texts.
///
/// # Errors
/// The scenario can't be written as TOML.
pub fn files(scenario: &Scenario) -> Result<Vec<(&'static str, String)>, toml_edit::ser::Error> {
    let text = scenario.to_toml()?;
    let Reference::Table(table) = &scenario.reference else { return Ok(vec![(SCENARIO_FILE, text)]) };
    let mut document: DocumentMut =
        text.parse().map_err(<toml_edit::ser::Error as serde::ser::Error>::custom)?;
    document["reference"]["file"] = value(REFERENCE_FILE);
    Ok(vec![(SCENARIO_FILE, document.to_string()), (REFERENCE_FILE, table.to_csv())])
}

/// Writes the files.
///
/// # Errors
/// A file can't be written.
pub(crate) fn write(folder: &Path, files: &[(&'static str, String)]) -> Result<(), WriteError> {
    for (name, text) in files {
        write_whole(&folder.join(name), ".scenario-", |file| file.write_all(text.as_bytes()))?;
    }
    Ok(())
}
