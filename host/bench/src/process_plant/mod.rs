//! `plant.model = "process"`: a plant in another process, by lines of JSON over its standard input and output. With
//! `plant.model = "fmu"` the process is `lashloop-fmu`, which loads an FMU.
//!
//! | module | is |
//! |---|---|
//! | `messages` | the lines of the protocol |
//! | `lines` | lines over pipes, with deadlines |
//! | `plant` | the process as a [`lashloop_plant::Plant`] |
//! | `keys` | the keys of both models |
//! | `fmu` | the model `fmu`: its keys, and the settings of `lashloop-fmu` |
//! | `error` | what a process can do wrong |
//!
//! The bench writes one line and waits for one line, so the plant runs in lockstep and repeats bit for bit if the process does.
//! Both sides write floating-point numbers with all their digits. `docs/extend/plant.md` has the protocol.

mod error;
mod fmu;
mod keys;
mod lines;
mod messages;
mod plant;

use std::path::{Path, PathBuf};

use lashloop_plant::{Key, PlantModel, PlantValues};

pub use error::ProcessError;
pub use fmu::{loader, model as fmu};
pub use keys::FOLDER;
use plant::Launch;
pub use plant::folder;

/// Name of the model in scenarios.
pub const NAME: &str = "process";

/// Whether the plant of this model is a process.
#[must_use]
pub fn is_process(model: &str) -> bool {
    model == NAME || model == fmu::NAME
}

/// The files that run as a plant of this model, for a scenario in the folder `of_scenario`: the program, what it is given,
/// and the files of `plant.files`.
#[must_use]
pub fn files(model: &str, values: &PlantValues, of_scenario: &Path) -> Vec<PathBuf> {
    let folder = folder(values, of_scenario);
    let program =
        if model == fmu::NAME { fmu::program(values, &folder) } else { plant::program(values, &folder) };
    let mut files: Vec<_> =
        program.map(|program| plant::files_of(program, &folder).collect()).unwrap_or_default();
    files.extend(values.text("file").map(|fmu| folder.join(fmu)));
    files.extend(plant::named_files(values, &folder));
    files
}

/// The model. `bench` is the `lashloop` program, which ends the process however the bench ends; without it, a killed bench
/// leaves the process to end by itself at the end of its standard input.
#[must_use]
pub fn model(bench: Option<PathBuf>) -> PlantModel {
    let mut all = vec![Key::texts("command", "Program and its arguments, without a shell.")];
    all.extend(keys::shared());
    all.push(Key::table("settings", "Passed on to the process as it is."));
    let summary = "A plant in another process, by lines of JSON over its standard input and output.";
    PlantModel::new(NAME, summary, all, move |release| {
        let launch = || {
            let program = plant::program(release.values, &folder(release.values, release.folder))?;
            let settings = release.values.get("settings");
            plant::ProcessPlant::start(release, Launch { program, settings, scratch: None }, bench.clone())
        };
        Ok(Box::new(launch()?))
    })
}

#[cfg(test)]
mod tests;
