//! `plant.model = "process"`: a plant in another process, by lines of JSON over its standard input and output.
//!
//! | module | is |
//! |---|---|
//! | `messages` | the lines of the protocol |
//! | `lines` | lines over pipes, with deadlines |
//! | `plant` | the process as a [`lashloop_plant::Plant`] |
//! | `error` | what a process can do wrong |
//!
//! The bench writes one line and waits for one line, so the plant runs in lockstep and repeats bit for bit if the process does.
//! Both sides write floating-point numbers with all their digits. `docs/extend/plant.md` has the protocol.

mod error;
mod lines;
mod messages;
mod plant;

use std::path::PathBuf;

use lashloop_plant::{Key, PlantError, PlantModel};

pub use error::ProcessError;
pub use plant::{FOLDER, files, folder};

/// Name of the model in scenarios.
pub const NAME: &str = "process";

/// The model. `bench` is the `lashloop` program, which ends the process however the bench ends; without it, a killed bench
/// leaves the process to end by itself at the end of its standard input.
#[must_use]
pub fn model(bench: Option<PathBuf>) -> PlantModel {
    let keys = vec![
        Key::texts("command", "Program and its arguments, without a shell."),
        Key::text(
            FOLDER,
            "Folder in which the program runs, relative to that of the scenario; that of the scenario if absent.",
        ),
        Key::integer(
            "start_timeout_ms",
            "ms",
            10_000,
            1..=600_000,
            "Time from the start of the process to its first line.",
        ),
        Key::integer(
            "step_timeout_ms",
            "ms",
            1000,
            1..=600_000,
            "Time that the process may take for a step.",
        ),
        Key::table("settings", "Passed on to the process as it is."),
    ];
    let summary = "A plant in another process, by lines of JSON over its standard input and output.";
    PlantModel::new(NAME, summary, keys, move |release| {
        let plant = plant::ProcessPlant::start(release, bench.clone());
        Ok(Box::new(plant.map_err(|error| PlantError::Failed(error.to_string()))?))
    })
}

#[cfg(test)]
mod tests;
