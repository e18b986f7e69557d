//! The model `fmu`: an FMU of FMI 2.0 or 3.0 in the process `lashloop-fmu`.
//!
//! The program is another one because an FMU is native code: its crash is an error of the run, and this crate needs no unsafe code.
//! The bench gives it a folder to unpack the FMU into, and removes the folder once the process has ended, however it ended.

use std::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};

use lashloop_plant::{Key, PlantModel, PlantValue, PlantValues, Release};

use super::error::ProcessError;
use super::keys;
use super::plant::{self, Launch, ProcessPlant};
use crate::supervisor::{Program, find_program};

/// Name of the model in scenarios.
pub(super) const NAME: &str = "fmu";
/// The program that loads FMUs.
const LOADER: &str = "lashloop-fmu";
/// Keys that the program receives as they are.
const PASSED_ON: [&str; 8] = [
    "torque_input",
    "motor_output",
    "load_output",
    "signals",
    "start",
    "tolerance",
    "preload",
    "memory_limit_mib",
];

/// The model. `bench` is as that of a plant in a process.
#[must_use]
pub fn model(bench: Option<PathBuf>) -> PlantModel {
    let mut all = vec![
        Key::required_text("file", "The FMU, relative to the folder."),
        Key::required_text("torque_input", "Variable that takes the torque at the motor, in N m."),
        Key::required_text("motor_output", "Variable with the position of the motor, in rad."),
        Key::required_text("load_output", "Variable with the position of the load, in rad."),
        Key::optional_texts("signals", "Variables to record as signals of the plant, with their units."),
        Key::integer(
            "step_us",
            "us",
            0,
            0..=1_000_000,
            "Communication step; 0 for the control period, or for the step that an FMU of one step size prefers.",
        ),
        Key::number(
            "tolerance",
            "",
            0.0,
            0.0..=1.0,
            "Relative tolerance of the FMU's solver; 0 leaves it to the FMU.",
        ),
        Key::optional_texts("preload", "Libraries to load before the FMU, such as libpython3.11.so.1.0."),
        Key::integer(
            "memory_limit_mib",
            "MiB",
            8192,
            16..=1_048_576,
            "Memory that the process of the FMU may take; the program of `command` may ignore it.",
        ),
        Key::optional_texts(
            "command",
            "Program that loads the FMU, and its arguments; lashloop-fmu next to this program or in PATH if absent.",
        ),
    ];
    all.extend(keys::shared());
    all.push(Key::table("start", "Start values: variables of the FMU with their values."));
    let summary = "An FMU of FMI 2.0 or 3.0 for co-simulation, in a process of its own.";
    PlantModel::new(NAME, summary, all, move |release| Ok(Box::new(start(release, bench.clone())?)))
}

fn start(release: &Release<'_>, bench: Option<PathBuf>) -> Result<ProcessPlant, ProcessError> {
    let values = release.values;
    let start = &release.start;
    if start.motor_velocity_rad_s != 0.0 || start.load_velocity_rad_s != 0.0 {
        return Err(ProcessError::InitialVelocity);
    }
    let folder = plant::folder(values, release.folder);
    let program = program(values, &folder)?;
    let scratch = tempfile::Builder::new().prefix("lashloop-fmu-").tempdir()?;
    let text = |path: &Path| PlantValue::Text(path.display().to_string());
    let file = std::path::absolute(folder.join(values.text("file").unwrap_or_default()))?;
    let step_us: i64 = values.integer("step_us").unwrap_or_default();
    let mut settings: BTreeMap<_, _> =
        PASSED_ON.iter().filter_map(|&key| Some((key.to_owned(), values.get(key)?.clone()))).collect();
    settings.insert("file".to_owned(), text(&file));
    settings.insert("unpack_into".to_owned(), text(scratch.path()));
    settings.insert("step_us".to_owned(), PlantValue::Integer(step_us));
    let settings = PlantValue::Table(settings);
    ProcessPlant::start(release, Launch { program, settings: Some(&settings), scratch: Some(scratch) }, bench)
}

/// The program of `plant.command`, else `lashloop-fmu`.
pub(super) fn program(values: &PlantValues, folder: &Path) -> Result<Program, ProcessError> {
    if values.texts("command").is_ok_and(|words| !words.is_empty()) {
        return plant::program(values, folder);
    }
    let program = loader()?.into();
    Ok(Program { name: "the plant", program, arguments: Vec::new(), core: None })
}

/// Path of `lashloop-fmu`: next to this program, else in `PATH`.
///
/// # Errors
/// It is at neither place.
pub fn loader() -> Result<PathBuf, ProcessError> {
    let bench = env::current_exe()?;
    let beside = bench.with_file_name(LOADER);
    if beside.is_file() {
        return Ok(beside);
    }
    find_program(LOADER).map_err(|_| ProcessError::NoLoader { bench })
}
