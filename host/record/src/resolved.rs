//! `scenario.toml`: the scenario with every key, which runs again as it is. A plant in a process runs where it ran before.

use std::io::Write;
use std::path::Path;

use lashloop_bench::atomic_file::{WriteError, write_whole};
use lashloop_bench::process_plant;
use lashloop_bench::scenario::Scenario;
use lashloop_plant::reference::Reference;
use toml_edit::{DocumentMut, TomlError, value};

use crate::file_names::{REFERENCE_FILE, SCENARIO_FILE};

/// The resolved scenario as files of one folder: their names and texts.
///
/// # Errors
/// The scenario can't be written as TOML, or the folder of its plant no longer exists.
pub fn files(scenario: &Scenario) -> Result<Vec<(&'static str, String)>, toml_edit::ser::Error> {
    let custom = |error: String| <toml_edit::ser::Error as serde::ser::Error>::custom(error);
    let text = scenario.to_toml()?;
    let mut document: DocumentMut = text.parse().map_err(|error: TomlError| custom(error.to_string()))?;
    let mut files = Vec::new();
    if let Reference::Table(table) = &scenario.reference {
        document["reference"]["file"] = value(REFERENCE_FILE);
        files.push((REFERENCE_FILE, table.to_csv()));
    }
    let plant = &scenario.plant;
    if process_plant::is_process(plant.model.name()) {
        let folder = process_plant::folder(&plant.values, &plant.folder);
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
        let folder =
            folder.canonicalize().map_err(|error| custom(format!("{}: {error}", folder.display())))?;
        let folder = folder.to_str().ok_or_else(|| custom(format!("{}: is not UTF-8", folder.display())))?;
        document["plant"][process_plant::FOLDER] = value(folder);
    }
    files.insert(0, (SCENARIO_FILE, document.to_string()));
    Ok(files)
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
